// Templates of surface points: captured on the visible surface, matched where the model predicts them, released.
#include "track/template_store.hpp"

#include <doctest/doctest.h>

#include "template_rig.hpp"
#include "track/template_matcher.hpp"
#include "track/template_tuning.hpp"

namespace template_store_test {

using namespace pliant;
using template_rig::film;
using template_rig::Rig;

TEST_CASE("templates are placed at corners of the visible surface, apart from each other") {
  Rig rig;
  rig.place(0, 40);
  REQUIRE(rig.used(0, 40) == 40);
  CHECK(rig.used(40, rig.templates->count()) == 0);
  for (std::size_t k = 0; k < 40; ++k) {
    const Template& t = rig.templates.object[k];
    CHECK(rig.templates->is_first(k));
    CHECK(t.was_found);
    CHECK(rig.estimator->has_point(t.id));
    const Prediction p = rig.estimator->predict(t.id);
    CHECK(p.visible);
    CHECK(length(p.x - t.found_at) < 0.1f);
    for (std::size_t other = 0; other < k; ++other)
      CHECK(length(t.found_at - rig.templates.object[other].found_at) >= 2);
  }
}

TEST_CASE("through a lens, too, templates are placed where the surface is seen at their corners") {
  for (const float k1 : {0.5f, 1.5f}) {
    Rig rig;
    Camera camera =
        film().camera;  // of half the focal length, so near that the lens bends the sides of the face
    camera.k1 = k1;
    camera.f = 0.5f * film().camera.f;
    Pose near = film().poses[0];
    near.t.z *= 0.5f;
    REQUIRE(rig.estimator->start(camera, 320, 240, near, film().parameters[0].data(), nullptr, {}) ==
            Status::ok);
    const Vec2 middle{camera.cx, camera.cy}, side = middle + Vec2{60 * camera.f / near.t.z, 0};
    REQUIRE(length(rig.estimator->lens().distort(side) - side) > 1);
    rig.place(0, 40);
    CHECK(rig.used(0, 40) > 10);
    for (std::size_t k = 0; k < 40; ++k) {
      const Template& t = rig.templates.object[k];
      if (t.is_used) CHECK(length(rig.estimator->predict(t.id).x - t.found_at) < 0.1f);
    }
  }
}

TEST_CASE("slots are those of frame 0, then those of one key frame after the other") {
  TrackerLimits limits = Rig::limits_of(40);
  limits.key_frames = 3;
  limits.key_patches = 24;
  InArena<TemplateStore> templates(limits);
  std::size_t slot = 0;
  for (std::size_t key = 0; key <= 3; ++key)
    for (const std::size_t end = slot + (key == 0 ? 40 : 8); slot < end; ++slot) {
      CHECK(templates->key_of(slot) == key);
      CHECK((slot >= first_slot(limits, key) && slot < first_slot(limits, key + 1)));
    }
  CHECK(slot == templates->count());
}

TEST_CASE("where limits name more templates, they lie closer together") {
  Rig few(100), many(400);
  few.place(0, 100);
  many.place(0, 400);
  CHECK(few.used(0, 100) > 95);
  CHECK(many.used(0, 400) > 2.5f * static_cast<float>(few.used(0, 100)));
}

TEST_CASE(
    "templates that were found keep their cell to themselves, those that were lost keep no others away") {
  for (const bool are_found : {true, false}) {
    CAPTURE(are_found);
    Rig rig(300, 160);
    rig.place(0, 60);
    REQUIRE(rig.used(0, 60) == 60);
    for (std::size_t k = 0; k < 60; ++k) {
      rig.templates.object[k].was_found = are_found;
      if (are_found) rig.templates.object[k].found_at.x += 2.2f;  // no longer at the cell's corner
    }
    rig.place(60, 300);
    REQUIRE(rig.used(60, 300) > 60);
    const auto cell = [&](const Template& t) {
      const Vec2 x = t.found_at - rig.region->origin();
      const int side = cell_px_of(rig.limits);
      return std::pair(static_cast<int>(x.x) / side, static_cast<int>(x.y) / side);
    };
    int shared = 0;
    for (std::size_t k = 60; k < 60 + rig.used(60, 300); ++k)
      for (std::size_t old = 0; old < 60; ++old)
        shared += cell(rig.templates.object[k]) == cell(rig.templates.object[old]);
    CHECK((shared > 0) == !are_found);
  }
}

TEST_CASE("a template that was found outside of the region is in no cell of it") {
  Rig rig(40, 160);
  rig.place(0, 8);
  for (std::size_t k = 0; k < 8; ++k) rig.templates.object[k].found_at = {3e7f, 3e7f};
  rig.place(8, 40);
  CHECK(rig.used(0, 40) == 40);
}

TEST_CASE("templates are tried at so many corners at most, and at none of them twice") {
  Rig rig;
  CHECK(rig.place(0, 40, 5) == 5);
  CHECK(rig.used(0, 40) <= 5);
  static std::vector<Vec2> asked;
  asked.clear();
  Rig other;
  other.templates->set_check({nullptr, [](void*, const FrameRegion&, Vec2, const Prediction& seen) {
                                asked.push_back(seen.x);
                                return false;
                              }});
  CHECK(other.place(0, 40) >= asked.size());
  REQUIRE(asked.size() > 50);
  for (std::size_t k = 0; k < asked.size(); ++k)
    for (std::size_t before = 0; before < k; ++before)
      if (length(asked[k] - asked[before]) < 0.5f) FAIL_CHECK("twice at one corner");
}

TEST_CASE("a marker behind the camera keeps no template away") {
  Rig rig;
  const Vec2 far{1500, 120};
  REQUIRE(rig.markers->place(rig.estimator.object, {&far, 1}, 25) == Status::ok);
  CHECK(rig.markers->count() == 1);
  MarkerPlace place;
  REQUIRE(rig.markers->save(rig.estimator.object, &place) == 1);
  Pose turned = film().poses[0];
  turned.q = exp_rotation({0, 0.6f, 0});
  REQUIRE(rig.estimator->start(film().camera, 320, 240, turned, film().parameters[0].data(), nullptr, {}) ==
          Status::ok);
  rig.markers->restore(rig.estimator.object, &place, 1);
  Vec2 at;
  REQUIRE_FALSE(rig.markers->position(0, rig.estimator.object, &at));
  rig.place(0, 40);
  CHECK(rig.used(0, 40) > 10);
}

TEST_CASE("no template is placed near a marker") {
  Rig rig;
  const Vec2 nose = film().truth("ibug30", 0);
  REQUIRE(rig.markers->place(rig.estimator.object, {&nose, 1}, 25) == Status::ok);
  rig.place(0, 40);
  CHECK(rig.used(0, 40) > 20);
  for (std::size_t k = 0; k < 40; ++k)
    if (rig.templates.object[k].is_used) CHECK(length(rig.templates.object[k].found_at - nose) >= 25);
}

TEST_CASE("a place where the surface turns away takes no slot and no point") {
  Rig rig;
  const Vec2 side{0.02f, 0.5f};
  Vec2 x;
  REQUIRE(rig.estimator->project(side, &x));
  CHECK_FALSE(rig.templates->capture(0, rig.estimator.object, rig.region.object, x, side));
  CHECK_FALSE(rig.templates.object[0].is_used);
  std::uint16_t id;
  REQUIRE(rig.estimator->add_point({0.5f, 0.5f}, &id) == Status::ok);
  CHECK(id == 0);  // no id was lost
}

TEST_CASE(
    "a template is found in the next frame, on average within a quarter of a pixel of its surface point") {
  Rig rig;
  rig.place(0, 40);
  std::vector<Vec2> uv;
  for (std::size_t k = 0; k < 40; ++k) uv.push_back(rig.estimator->point_uv(rig.templates.object[k].id));
  rig.see(1);
  InArena<Cascade> cascade(baked_face().model);
  const Projector truth(view_of(film().poses[1], film().camera), true);
  std::size_t found = 0;
  float error = 0;
  for (std::size_t k = 0; k < 40; ++k) {
    const Prediction p = rig.estimator->predict(rig.templates.object[k].id);
    const PatchResult r = rig.templates->match(k, rig.region.object, p.x, p.jacobian, {}, {});
    Vec2 x;
    REQUIRE(truth.project(cascade->surface_point(uv[k], film().parameters[1].data()), &x));
    if (r.status != PatchStatus::ok) continue;
    ++found;
    error += length(r.x + rig.region->origin() - x);
  }
  CHECK(found > 30);
  CHECK(error / static_cast<float>(found) < 0.25f);  // measured: 0.17
}

TEST_CASE("in a region that moves over the frame, places are the frame's") {
  Rig rig(40, 160);
  rig.place(0, 40);
  REQUIRE(rig.used(0, 40) > 20);
  REQUIRE(length(rig.region->origin()) > 50);
  rig.see(0, {180, 140});
  REQUIRE(length(rig.region->origin() - rig.region->previous_origin()) > 20);
  int found = 0, found_from_previous = 0;
  for (std::size_t k = 0; k < 40; ++k) {
    const Template& t = rig.templates.object[k];
    if (!t.is_used) continue;
    const Prediction p = rig.estimator->predict(t.id);
    const auto is_there = [&](const PatchResult& r) {
      return r.status == PatchStatus::ok && length(r.x + rig.region->origin() - t.found_at) < 0.1f;
    };
    found += is_there(rig.templates->match(k, rig.region.object, p.x, p.jacobian, {}, {}));
    found_from_previous +=
        is_there(rig.templates->match_from_previous(t.found_at, rig.region.object, p.x, {}));
  }
  CHECK(found > 15);
  CHECK(found_from_previous > 15);
}

TEST_CASE("of two templates of a point that one is matched that has to be warped less") {
  Rig rig;
  rig.place(0, 40);
  for (std::size_t k = 0; k < 8; ++k) rig.templates.object[k].correlation = 0.7f;
  REQUIRE(rig.templates->capture_second(8, 40, 48, rig.estimator.object, rig.region.object) == 48);
  for (const bool first_is_off : {true, false})
    for (std::size_t k = 0; k < 8; ++k) {
      Template& first = rig.templates.object[k];
      Template& off = first_is_off ? first : rig.templates.object[first.second];
      const Mat2 reference = off.reference;
      off.reference = reference * Mat2{2, 0, 0, 2};  // as if it had been seen twice as large
      const Prediction p = rig.estimator->predict(first.id);
      const PatchResult r = rig.templates->match(k, rig.region.object, p.x, p.jacobian, {}, {});
      CHECK(r.status == PatchStatus::ok);
      CHECK(r.correlation > 0.99f);
      off.reference = reference;
    }
}

TEST_CASE(
    "no template is captured off the surface, where it turns away or is hidden, or where the check says no") {
  Rig rig;
  Pose turned = film().poses[0];
  turned.q = exp_rotation({0, 0.6f, 0});
  REQUIRE(rig.estimator->start(film().camera, 320, 240, turned, film().parameters[0].data(), nullptr, {}) ==
          Status::ok);
  int refused[3] = {}, captured = 0;  // off the surface, turned away, hidden
  const auto try_at = [&](Vec2 uv, Vec2 x) {
    const bool is_captured = rig.templates->capture(0, rig.estimator.object, rig.region.object, x, uv);
    if (is_captured) rig.templates->release(0, rig.estimator.object);
    return is_captured;
  };
  for (int i = 1; i < 40; ++i)
    for (int j = 1; j < 40; ++j) {
      const Vec2 uv{static_cast<float>(i) / 40, static_cast<float>(j) / 40};
      std::uint16_t id;
      REQUIRE(rig.estimator->add_point(uv, &id) == Status::ok);
      const Prediction p = rig.estimator->predict(id);
      rig.estimator->remove_point(id);
      const bool is_on = rig.estimator->model().is_on_surface(uv);
      const bool is_facing = p.facing > kTemplateStoreTuning.least_facing;
      if (is_on && is_facing && p.visible) {
        captured += try_at(uv, p.x);
        continue;
      }
      CHECK_FALSE(try_at(uv, p.x));
      refused[0] += !is_on && is_facing && p.visible;
      refused[1] += is_on && !is_facing && p.visible;
      refused[2] += is_on && is_facing && !p.visible;
    }
  for (const int count : refused) CHECK(count > 5);
  CHECK(captured > 100);
  rig.templates->set_check(
      {nullptr, [](void*, const FrameRegion&, Vec2, const Prediction&) { return false; }});
  rig.place(0, 40);
  CHECK(rig.used(0, 40) == 0);
}

TEST_CASE("the memory of templates is that of the limits: levels, margin, and warped ones if they are kept") {
  const auto bytes = [](auto change) {
    TrackerLimits limits = Rig::limits_of(40);
    change(limits);
    return static_cast<double>(measured_bytes<TemplateStore>(limits)) /
           static_cast<double>(all_slots(limits));
  };
  const TrackerLimits usual = Rig::limits_of(40);
  const auto of_slot = [](const TrackerLimits& l, int margin, int levels) {
    PatchLimits p;
    p.window = l.patch_window;
    p.margin = static_cast<decltype(p.margin)>(margin);
    p.levels = levels;
    return patch_slot_bytes(p);
  };
  const double all = bytes([](TrackerLimits&) {});
  const int slot = of_slot(usual, usual.patch_margin, usual.pyramid_levels);
  CHECK(all - bytes([](TrackerLimits& l) { l.patch_margin = 0; }) ==
        doctest::Approx(slot - of_slot(usual, 0, usual.pyramid_levels)).epsilon(0.02));
  CHECK(all - bytes([](TrackerLimits& l) { l.pyramid_levels = 1; }) ==
        doctest::Approx(slot - of_slot(usual, usual.patch_margin, 1)).epsilon(0.02));
  CHECK(bytes([](TrackerLimits& l) { l.keeps_templates = !l.keeps_templates; }) !=
        doctest::Approx(all).epsilon(0.2));
}

TEST_CASE("second templates are of points with another appearance, and go with their first one") {
  Rig rig;
  rig.place(0, 40);
  rig.templates.object[3].correlation = 0.8f;
  rig.templates.object[5].correlation = 0.7f;
  rig.templates.object[7].correlation = 0.7f;
  rig.templates.object[7].was_found = false;
  const std::size_t free = rig.templates->capture_second(40, 40, 48, rig.estimator.object, rig.region.object);
  REQUIRE(free == 42);
  CHECK(rig.templates.object[3].second == 40);
  CHECK(rig.templates.object[5].second == 41);
  CHECK_FALSE(rig.templates->is_first(40));
  CHECK(rig.templates.object[41].id == rig.templates.object[5].id);

  const std::uint16_t id = rig.templates.object[5].id;
  rig.templates->release(40, rig.estimator.object);  // a second one: the point stays
  CHECK(rig.templates.object[3].second == kNoSlot);
  CHECK(rig.estimator->has_point(rig.templates.object[3].id));
  rig.templates->release(5, rig.estimator.object);  // a first one: all of the point goes
  CHECK_FALSE(rig.templates.object[41].is_used);
  CHECK_FALSE(rig.estimator->has_point(id));
}

TEST_CASE("no second template is taken of a point that has one, is lost for a while, or lies outside") {
  Rig rig;
  rig.place(0, 40);
  for (std::size_t k = 1; k <= 3; ++k) rig.templates.object[k].correlation = 0.7f;
  rig.templates.object[1].frames_apart = 1;
  rig.templates.object[2].found_at = {-50, 500};
  const auto capture = [&](std::size_t first) {
    return rig.templates->capture_second(40, first, 48, rig.estimator.object, rig.region.object);
  };
  REQUIRE(capture(40) == 41);
  CHECK(rig.templates.object[3].second == 40);
  CHECK(capture(41) == 41);
  rig.templates->release(3, rig.estimator.object);  // the slots of both are free again
  const Template& other = rig.templates.object[4];
  const Vec2 x = other.found_at, uv = rig.estimator->point_uv(other.id);
  rig.templates->release(4, rig.estimator.object);
  for (const std::size_t slot : {std::size_t{3}, std::size_t{40}})
    CHECK(rig.templates->capture(slot, rig.estimator.object, rig.region.object, x, uv));
}

TEST_CASE("no second template is taken of a point that is hidden now") {
  Rig rig;
  rig.place(0, 40);
  for (std::size_t k = 0; k < 40; ++k) rig.templates.object[k].correlation = 0.7f;
  State turned;
  turned.pose = film().poses[0];
  turned.pose.q = exp_rotation({0, 1.2f, 0});
  std::vector<float> q = film().parameters[0];
  turned.q = q.data();
  REQUIRE(rig.estimator->restore(turned) == Status::ok);
  std::size_t seen = 0;
  for (std::size_t k = 0; k < 8; ++k) seen += rig.estimator->predict(rig.templates.object[k].id).visible;
  REQUIRE(seen < 8);
  CHECK(rig.templates->capture_second(8, 40, 48, rig.estimator.object, rig.region.object) == 40 + seen);
}

TEST_CASE("a frame of matching: all points are searched for once, found, and noted") {
  Rig rig;
  rig.place(0, 40);
  InArena<TemplateMatcher> matcher(rig.limits);
  matcher->start(true);
  std::vector<Observation> observations(rig.templates->count());
  std::vector<std::uint16_t> index(1000);
  const MatchFrame frame{rig.templates.object, rig.region.object, {observations.data(), observations.size()}};
  rig.see(1);
  rig.estimator->begin(33'333'333);
  matcher->begin_frame(1, true, kUnknownPx);
  matcher->limit_steps(100000);
  CHECK_FALSE(matcher->run_first_pass(frame, rig.estimator.object));  // 40 points are too few for one
  const PredictionTable predictions{rig.estimator->predict(), index.data()};
  for (std::size_t i = 0; i < predictions.all.count; ++i)
    index[predictions.all[i].id] = static_cast<std::uint16_t>(i);
  CHECK(matcher->match(frame, predictions, 0) == 40);
  CHECK(matcher->observation_count() == 40);
  rig.estimator->solve({observations.data(), 40});
  CHECK(rig.estimator->end().state == TrackState::tracking);
  matcher->end_frame(frame, true);
  std::size_t found = 0;
  for (std::size_t k = 0; k < 40; ++k) found += rig.templates.object[k].was_found;
  CHECK(found > 30);
  CHECK(film().turn_error(pose_of(rig.estimator->view()), 1) < 0.5f);

  const FrameWork all = matcher->work();
  CHECK(all.searches == 40);
  CHECK(all.search_steps >= 40 * (kTemplateMatchTuning.preparation_steps + 1));

  matcher->end_frame(frame, false);  // a bad frame found nothing
  for (std::size_t k = 0; k < 40; ++k) CHECK_FALSE(rig.templates.object[k].was_found);
}

TEST_CASE("a frame's searches end after the steps that it may take, those of a first pass too") {
  Rig rig(200);
  rig.place(0, rig.limits.patches);
  REQUIRE(rig.used(0, rig.limits.patches) >=
          kTemplateMatchTuning.first_pass_least_ratio * kTemplateMatchTuning.first_pass_points);
  InArena<TemplateMatcher> matcher(rig.limits);
  std::vector<Observation> observations(rig.templates->count());
  const MatchFrame frame{rig.templates.object, rig.region.object, {observations.data(), observations.size()}};
  for (std::size_t k = 0; k < rig.templates->count(); ++k)
    if (rig.templates->is_first(k)) rig.templates.object[k].was_found = true;
  rig.see(1);
  std::uint32_t longest = 0;
  for (const std::uint32_t most : {0u, 20u, 100000u}) {
    CAPTURE(most);
    rig.estimator->begin(33'333'333);
    matcher->start(true);
    matcher->begin_frame(1, true, kUnknownPx);
    matcher->limit_steps(most);
    const bool has_moved = matcher->run_first_pass(frame, rig.estimator.object);
    if (most == 0) CHECK_FALSE(has_moved);
    if (most == 0) CHECK(matcher->work().searches == 0);
    if (most == 20) CHECK(matcher->work().search_steps >= most);
    if (most == 20) CHECK(matcher->work().search_steps < most + 40);  // one search more at most
    longest = matcher->work().search_steps;
  }
  CHECK(longest > 100);
}

}  // namespace template_store_test
