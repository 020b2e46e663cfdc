// What turns of the head do to a template: the surface in its window bends away from the tangent plane, and its light changes.
#include <doctest/doctest.h>

#include <cmath>

#include "open_model.hpp"
#include "template_rig.hpp"
#include "track/key_frames.hpp"
#include "track/template_tuning.hpp"

namespace template_bend_test {

using namespace pliant;
using template_rig::film;
using template_rig::Rig;

namespace {

/// Key frame 0 of a rig, in which the head was turned about the vertical axis, and key frame 1, as it is now.
struct KeyView {
  InArena<KeyFrames> keys;
  KeyDepths depths;

  KeyView(Rig& rig, float turn) : keys(rig.limits), depths{&keys.object, &rig.estimator->view()} {
    keys->clear();
    Pose pose = film().poses[0];
    pose.q = exp_rotation({0, turn, 0});
    keys->keep(0, view_of(pose, film().camera), 0, 0);
    keys->keep(1, rig.estimator->view(), 0, 0);
  }
};

}  // namespace

TEST_CASE("a window's depth is the mean of its bend over what the warp stretches it over, but not in front") {
  Rig rig;
  rig.place(0, 40);
  InArena<KeyFrames> keys(rig.limits);
  keys->clear();
  Pose turned = film().poses[0];
  turned.q = exp_rotation({0, 0.4f, 0});
  keys->keep(0, view_of(turned, film().camera), 0, 0);
  const KeyDepths depths{&keys.object, &rig.estimator->view()};
  const Vec2 of_mm = depths.of(0);
  REQUIRE(length(of_mm) > 0.3f);
  const struct {
    Mat2 to_template;
    int bend[3];  // mm / kBendUnits
    float mm;
  } kCases[] = {
      {{}, {16, 0, 16}, 1},
      {{}, {32, 100, 0}, 1},
      {{}, {-32, 0, -32}, 0},
      {{1.2f, 0, 0, 1}, {32, 0, 0}, 1.44f},
      {{1.2f, 0, 0, 1}, {0, 0, 32}, 1},
      {{1, 0.3f, 0, 1}, {64, 0, 0}, 2.18f},
      {{1, 0.3f, 0, 1}, {0, 64, 0}, 1.2f},
      {{1, -0.3f, 0, 1}, {0, 64, 0}, 0},
  };
  PatchOptions options;
  options.min_correlation = 0.5f;
  for (const auto& c : kCases) {
    CAPTURE(c.mm);
    int count = 0;
    float along = 0;  // px
    for (std::size_t k = 0; k < 40; ++k) {
      Template& t = rig.templates.object[k];
      const Prediction p = rig.estimator->predict(t.id);
      PatchResult r[2];  // as if the surface were flat, and bent
      for (int i = 0; i < 2; ++i) {
        for (int b = 0; b < 3; ++b) t.bend[b] = static_cast<std::int8_t>(i * c.bend[b]);
        r[i] = rig.templates->match(k, rig.region.object, p.x, inverse(c.to_template) * t.reference, depths,
                                    options);
      }
      if (r[0].status != PatchStatus::ok || r[1].status != PatchStatus::ok) continue;
      const float off = dot(r[0].x - r[1].x, of_mm) / length(of_mm);
      if (magnitude(off - c.mm * length(of_mm)) > 1) continue;  // one of them has found something else
      ++count;
      along += off;
    }
    REQUIRE(count > 10);
    CHECK(magnitude(along / static_cast<float>(count) - c.mm * length(of_mm)) < 0.03f);
  }
}

TEST_CASE("what the bend of the surface moves a window by is taken off the place of its point") {
  const FaceFilm turned(320, 240, 2, [](float s, Pose& pose, auto&) {
    pose.q = exp_rotation({0, 0.5f * s, 0});
  });
  Rig rig;
  rig.place(0, 40);
  InArena<KeyFrames> keys(rig.limits);
  keys->clear();
  keys->keep(0, rig.estimator->view(), 0, 0);
  std::vector<Vec2> uv;
  for (std::size_t k = 0; k < 40; ++k) uv.push_back(rig.estimator->point_uv(rig.templates.object[k].id));
  REQUIRE(rig.region->build(turned.view(1), {}) == Status::ok);
  REQUIRE(rig.estimator->start(turned.camera, 320, 240, turned.poses[1], turned.parameters[1].data(), nullptr,
                               {}) == Status::ok);
  PatchOptions options;
  options.min_correlation = 0.8f;
  options.start_sd_px = 1;
  const KeyDepths depths{&keys.object, &rig.estimator->view()};
  float along[2] = {};
  std::size_t found = 0;
  for (std::size_t k = 0; k < 40; ++k) {
    std::uint16_t id;
    REQUIRE(rig.estimator->add_point(uv[k], &id) == Status::ok);
    const Prediction p = rig.estimator->predict(id);
    float error[2];  // px, along the motion: as if the surface were flat, and with its bend
    Template& t = rig.templates.object[k];
    const Template bent = t;
    for (int i = 0; i < 2; ++i) {
      for (int b = 0; b < 3; ++b) t.bend[b] = i == 0 ? std::int8_t{0} : bent.bend[b];
      const PatchResult r = rig.templates->match(k, rig.region.object, p.x, p.jacobian, depths, options);
      error[i] = p.visible && r.status == PatchStatus::ok ? (r.x + rig.region->origin() - p.x).x : 1e3f;
    }
    if (magnitude(error[0]) > 2 || magnitude(error[1]) > 2) continue;  // not found, or something else
    ++found;
    for (int i = 0; i < 2; ++i) along[i] += error[i];
  }
  REQUIRE(found > 12);
  MESSAGE(found << " found; off by " << along[0] / static_cast<float>(found) << " px, "
                << along[1] / static_cast<float>(found) << " px with the bend");
  CHECK(along[0] > 0.2f * static_cast<float>(found));              // measured: 0.31 px
  CHECK(magnitude(along[1]) < 0.15f * static_cast<float>(found));  // 0.07 px
}

TEST_CASE("a template's bend is that of the surface in its window, in the axes of the image, up to 4 mm") {
  const struct {
    float xx, xy, yy;  // 1/mm: depth behind the middle is xx x^2 + 2 xy x y + yy y^2
  } kCases[] = {{0.1f, 0.06f, -0.05f}, {-0.04f, -0.1f, 0.12f}, {1, 0, -1}};
  for (const auto& c : kCases) {
    CAPTURE(c.xx);
    ModelBuilder b;
    b.record(Operation::constant, {}, {}, b.field(3, 129, 129, [&](float u, float v) {
      const float x = 100 * (u - 0.5f), y = 100 * (v - 0.5f);  // right and down
      const float near_x = clamp(x, -12, 12), near_y = clamp(y, -12, 12);
      return Vec3{x, -y, -(c.xx * near_x * near_x + 2 * c.xy * near_x * near_y + c.yy * near_y * near_y)};
    }));
    b.parameter("p", Group::expression, -1, 1, 1);
    b.grid_mesh(8);
    b.landmark("p", 0.5f, 0.5f);
    const OpenModel built(b);
    const TrackerLimits limits = Rig::limits_of(8);
    InArena<Estimator> estimator(built.model, Rig::estimator_limits(limits));
    InArena<FrameRegion> region(limits);
    InArena<TemplateStore> templates(limits);
    templates->clear();
    const float q = 0, half_mm = 0.5f * static_cast<float>(limits.patch_window);  // one px is one mm
    REQUIRE(estimator->start(centred_camera(320, 240, 600), 320, 240, {{}, {0, 0, 600}}, &q, nullptr, {}) ==
            Status::ok);
    REQUIRE(region->build(film().view(0), {160, 120}) == Status::ok);
    REQUIRE(templates->capture(0, estimator.object, region.object, {159.5f, 119.5f}, {0.5f, 0.5f}));
    const float each = kBendUnits * half_mm * half_mm / 3;
    const float expected[] = {each * c.xx, each * c.xy, each * c.yy};
    for (int i = 0; i < 3; ++i)
      CHECK(magnitude(templates.object[0].bend[i] - clamp(expected[i], -127, 127)) < 1.5f);
  }
}

TEST_CASE("a search begins where the bend of the surface puts the window") {
  Rig rig;
  rig.place(0, 40);
  const KeyView turned(rig, 0.4f);
  const Vec2 shift = 2 * turned.depths.of(0);
  REQUIRE(length(shift) > 0.6f);
  PatchOptions near;
  near.first_level = 0;
  near.max_move_px = 0.3f;
  for (std::size_t k = 0; k < 40; ++k) {
    Template& t = rig.templates.object[k];
    t.bend[0] = t.bend[2] = static_cast<std::int8_t>(kBendUnits);
    t.bend[1] = 0;
    const PatchResult r =
        rig.templates->match(k, rig.region.object, t.found_at - shift, t.reference, turned.depths, near);
    CHECK(r.status == PatchStatus::ok);
    CHECK(length(r.x - (t.found_at - shift)) < 0.1f);
  }
}

TEST_CASE(
    "light may have changed over a window by as much as the head has turned since the template's key frame") {
  Rig rig;
  rig.place(0, 40);
  const float mm_per_px = 1 / rig.estimator->view().s;
  for (const float turn : {0.05f, 0.4f}) {
    const KeyView turned(rig, turn);
    PatchOptions as_known;
    as_known.ramp_sd = turn < 0.1f ? 0 : kTemplateStoreTuning.ramp_grey_per_mm * mm_per_px * std::sin(turn);
    InArena<PatchTracker> patches{
        PatchLimits{1, rig.limits.patch_window, rig.limits.pyramid_levels, rig.limits.patch_margin}};
    for (std::size_t k = 0; k < 40; ++k) {
      Template& t = rig.templates.object[k];
      for (std::int8_t& bend : t.bend) bend = 0;
      const PatchResult r =
          rig.templates->match(k, rig.region.object, t.found_at, t.reference, turned.depths, {});
      REQUIRE(patches->capture(0, rig.region->pyramid(), t.found_at) == PatchStatus::ok);
      const PatchResult expected = patches->track(0, rig.region->pyramid(), t.found_at, {}, as_known);
      CHECK(r.status == expected.status);
      CHECK(r.information.xx == doctest::Approx(double(expected.information.xx)).epsilon(0.002));
    }
  }
}

TEST_CASE("the depth under a second template is that of its own key frame") {
  Rig rig;
  rig.place(0, 40);
  for (std::size_t k = 0; k < 8; ++k) rig.templates.object[k].correlation = 0.7f;
  REQUIRE(rig.templates->capture_second(8, 40, 48, rig.estimator.object, rig.region.object) == 48);
  const KeyView turned(rig, 0.4f);
  for (std::size_t k = 0; k < 8; ++k) {
    Template& first = rig.templates.object[k];
    Template& second = rig.templates.object[first.second];
    const Mat2 seen = second.reference;
    first.reference = seen * Mat2{2, 0, 0, 2};
    second.bend[0] = second.bend[2] = static_cast<std::int8_t>(kBendUnits);
    const PatchResult r = rig.templates->match(k, rig.region.object, first.found_at, seen, turned.depths, {});
    CHECK(length(r.x - first.found_at) < 0.1f);  // the second one's was seen from where the head is now
  }
}

TEST_CASE("a window's depth is that of what is stored, however far it is stretched") {
  TrackerLimits limits = Rig::limits_of(40);
  limits.patch_margin = 0;
  Rig rig(limits);
  rig.place(0, 40);
  const KeyView turned(rig, 0.4f);
  const Vec2 of_mm = turned.depths.of(0);
  const struct {
    Mat2 to_template;
    std::int8_t xx, xy;
    float mm;
  } kCases[] = {
      {{1.2f, 0, 0, 1}, 32, 0, 1},
      // Twice the mixed part of 2 mm, by how much of the window's sheared row lies along the other axis.
      {{1.2f, 0.3f, 0, 1}, 0, 64, 2 * 2 * 0.3f / length(Vec2{1.2f, 0.3f})}};
  for (const auto& c : kCases) {
    CAPTURE(c.mm);
    int count = 0;
    for (std::size_t k = 0; k < rig.used(0, 40); ++k) {
      Template& t = rig.templates.object[k];
      const auto place = [&](std::int8_t xx, std::int8_t xy) {
        t.bend[0] = xx;
        t.bend[1] = xy;
        t.bend[2] = 0;
        PatchOptions options;
        options.min_correlation = 0.5f;
        return rig.templates->match(k, rig.region.object, t.found_at, inverse(c.to_template) * t.reference,
                                    turned.depths, options);
      };
      const PatchResult flat = place(0, 0), bent = place(c.xx, c.xy);
      if (flat.status != PatchStatus::ok || bent.status != PatchStatus::ok) continue;
      count += length(flat.x - bent.x - c.mm * of_mm) < 0.05f;
    }
    CHECK(count > 10);
  }
}

}  // namespace template_bend_test
