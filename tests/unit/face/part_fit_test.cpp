// The fit of the eyes' parameters to what the learnt readers see, in rendered pictures.
#include "face/part_fit.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "face_film.hpp"
#include "host/io/files.hpp"
#include "model_builder.hpp"

namespace part_fit_test {

using namespace pliant;

namespace {

const Model& model() {
  static const host::ModelFile* file = new host::ModelFile(PLIANT_DETECTING_FACE);
  return file->model();
}

/// Three pictures of one pose: lids open, shut, open.
const FaceFilm& film() {
  static const FaceFilm* film = new FaceFilm(320, 240, 3, [](float s, Pose&, auto& q) {
    const float closed = 1 - 2 * magnitude(s - 0.5f);
    FaceFilm::set(q, "eyeBlinkLeft", closed);
    FaceFilm::set(q, "eyeBlinkRight", closed);
  });
  return *film;
}

struct Rig {
  InArena<PartFit> fit{model()};
  PartPoints points;
  View view = view_of(film().poses[0], film().camera);
  Lens lens;

  Rig() {
    REQUIRE(points.open(model()) == Status::ok);
    REQUIRE(Lens::make(film().camera, film().width, film().height, &lens) == Status::ok);
  }
  void read(const FrameView& frame, float centring = 0) {
    fit->read(frame, lens, view, film().parameters[0].data(), centring, &points);
  }
  float value(const char* name) const {
    for (std::size_t k = 0; k < points.parameter_count; ++k)
      if (points.parameter[k] == model().find_parameter(name)) return points.last[k];
    FAIL(name);
    return 0;
  }
  float blink() const { return 0.5f * (value("eyeBlinkLeft") + value("eyeBlinkRight")); }
};

}  // namespace

TEST_CASE("lids that close and open again move their parameters there and back") {
  Rig rig;
  rig.read(film().view(0));
  rig.fit->calibrate(&rig.points);
  CHECK(rig.points.is_calibrated);
  CHECK(rig.blink() == 0);
  rig.fit->fit(1 / 30.0f, &rig.points);
  CHECK(rig.blink() < 0.15f);
  for (int k = 0; k < 2; ++k) {
    rig.read(film().view(1));
    rig.fit->fit(1 / 30.0f, &rig.points);
  }
  CHECK(rig.blink() > 0.6f);
  for (int k = 0; k < 2; ++k) {
    rig.read(film().view(2));
    rig.fit->fit(1 / 30.0f, &rig.points);
  }
  CHECK(rig.blink() < 0.15f);
  for (std::size_t k = 0; k < rig.points.parameter_count; ++k) {
    const Parameter& p = model().parameters()[rig.points.parameter[k]];
    CHECK(rig.points.sd[k] > 0);
    CHECK(rig.points.sd[k] < p.sd);
    CHECK(rig.points.last[k] >= p.minimum);
    CHECK(rig.points.last[k] <= p.maximum);
  }
}

TEST_CASE("a wink shuts one eye and leaves the other one open") {
  const FaceFilm wink(320, 240, 2, [](float s, Pose&, auto& q) { FaceFilm::set(q, "eyeBlinkLeft", s); });
  Rig rig;
  rig.read(wink.view(0));
  rig.fit->calibrate(&rig.points);
  for (int k = 0; k < 4; ++k) {
    rig.read(wink.view(1));
    rig.fit->fit(1 / 30.0f, &rig.points);
  }
  CHECK(rig.value("eyeBlinkLeft") > 0.6f);
  CHECK(rig.value("eyeBlinkRight") < 0.15f);
}

TEST_CASE("eyes of which one is read too far open, by less than a lid, are taken to be alike") {
  Rig rig;
  rig.read(film().view(0));
  rig.fit->calibrate(&rig.points);
  const auto gaps_differ_by = [&rig] {
    float mm = 0;
    for (std::size_t n = 0; n < rig.points.parameter_count; ++n)
      mm += rig.points.opens_mm[n] * (rig.points.last[n] - rig.points.start[n]);
    return magnitude(mm);
  };
  // The right eye is read 2 mm more shut from now on: its lids' offsets say so.
  for (std::size_t s = 0; s < rig.points.side_count; ++s)
    for (std::size_t k = 0; k < rig.points.side[s].count && !rig.points.side[s].is_left; ++k) {
      const int number = rig.points.table[rig.points.side[s].part].number[k];
      if (number == 37 || number == 38) rig.points.offset_mm[rig.points.side[s].first + k].y -= 2;
    }
  for (int k = 0; k < 10; ++k) {
    rig.read(film().view(0));
    rig.fit->fit(1 / 30.0f, &rig.points);
  }
  PartPoints alone = rig.points;
  const float together = gaps_differ_by();
  for (float& mm : alone.opens_mm) mm = 0;
  for (int k = 0; k < 10; ++k) rig.fit->fit(1 / 30.0f, &alone);
  float apart = 0;
  for (std::size_t n = 0; n < alone.parameter_count; ++n)
    apart += rig.points.opens_mm[n] * (alone.last[n] - alone.start[n]);
  MESSAGE("gaps differ by " << together << " mm, " << magnitude(apart) << " without symmetry");
  CHECK(magnitude(apart) > 0.8f);
  CHECK(together < 0.7f * magnitude(apart));
}

TEST_CASE("a start with shut eyes that is told to be open waits until the lids are open") {
  Rig rig;
  rig.read(film().view(1));
  rig.fit->calibrate(&rig.points);
  CHECK_FALSE(rig.points.is_calibrated);
  CHECK(rig.blink() > 0.6f);
  rig.fit->fit(1 / 30.0f, &rig.points);
  CHECK_FALSE(rig.points.is_calibrated);
  for (int k = 0; k < 3; ++k) {
    rig.read(film().view(2));
    rig.fit->fit(1 / 30.0f, &rig.points);
  }
  CHECK(rig.points.is_calibrated);
  CHECK(rig.blink() < 0.15f);
  for (int k = 0; k < 2; ++k) {
    rig.read(film().view(1));
    rig.fit->fit(1 / 30.0f, &rig.points);
  }
  CHECK(rig.blink() > 0.6f);
}

TEST_CASE("a start does not depend on the eyes of the track before") {
  const auto blink_of_shut_start = [](bool had_open_eyes) {
    Rig rig;
    if (had_open_eyes) {
      rig.read(film().view(0));
      rig.fit->calibrate(&rig.points);
      REQUIRE(rig.points.is_calibrated);
    }
    rig.read(film().view(1));
    rig.fit->calibrate(&rig.points);
    REQUIRE_FALSE(rig.points.is_calibrated);
    for (Vec2& offset : rig.points.offset_mm) offset = {};
    for (std::size_t k = 0; k < rig.points.count; ++k)
      if (rig.points.in_gap(k) > 0) rig.points.offset_mm[k].y = 1;  // as after a change of the person
    rig.fit->fit(1 / 30.0f, &rig.points);
    return rig.blink();
  };
  CHECK(blink_of_shut_start(true) == blink_of_shut_start(false));
}

TEST_CASE("lids that meet are shut, also of a person whose open eyes are read too narrow") {
  const auto blink_of_shut_eyes = [](bool offset_fades) {
    Rig rig;
    rig.read(film().view(0));
    rig.fit->calibrate(&rig.points);
    for (std::size_t s = 0; s < rig.points.side_count; ++s) {
      PartSide& side = rig.points.side[s];
      CHECK(side.open_mm > 4);
      if (!offset_fades) side.open_mm = 0;
      for (std::size_t k = side.first; k < side.first + side.count; ++k)
        if (rig.points.in_gap(k) > 0) rig.points.offset_mm[k].y += 2;  // the upper lid was read 2 mm too low
    }
    for (int k = 0; k < 3; ++k) {
      rig.read(film().view(1));
      rig.fit->fit(1 / 30.0f, &rig.points);
    }
    return rig.blink();
  };
  const float faded = blink_of_shut_eyes(true), kept = blink_of_shut_eyes(false);
  MESSAGE("shut eyes: eyeBlink " << faded << ", with all of the open lids' offset " << kept);
  CHECK(faded > kept + 0.1f);
}

TEST_CASE("where the estimate of the person moves the model's lids, the lids are read as before") {
  std::vector<float> other = film().parameters[0];
  FaceFilm::set(other, "eyeOpening", 2);
  InArena<Cascade> cascade(model());
  std::vector<Vec3> moved;  // what keeps landmarks where they are
  for (const Landmark& l : model().landmarks())
    moved.push_back(cascade->surface_point(l.uv(), film().parameters[0].data()) -
                    cascade->surface_point(l.uv(), other.data()));
  const auto blink_as_other = [&](bool moves) {
    Rig rig;
    rig.read(film().view(0));
    rig.fit->calibrate(&rig.points);
    if (moves) rig.points.move(rig.view, moved.data());
    for (int k = 0; k < 3; ++k) {
      rig.fit->read(film().view(0), rig.lens, rig.view, other.data(), 0, &rig.points);
      rig.fit->fit(1 / 30.0f, &rig.points);
    }
    return rig.blink();
  };
  const float kept = blink_as_other(true), not_kept = blink_as_other(false);
  MESSAGE("open eyes are shut by " << kept << ", " << not_kept << " if the readings do not move");
  CHECK(kept < 0.1f);
  CHECK(not_kept > kept + 0.1f);
}

TEST_CASE("crops follow the eyes where the pose is off") {
  Rig rig;
  Pose off = film().poses[0];
  off.t = off.t + Vec3{3, -2, 0};
  rig.view = view_of(off, film().camera);
  for (int k = 0; k < kPartFitTuning.start_centrings; ++k) rig.read(film().view(0), 1);
  for (std::size_t s = 0; s < rig.points.side_count; ++s) {
    const Vec2 centre = rig.points.side[s].centre_mm;
    CHECK(length(centre - Vec2{-3, 2}) < 1.5f);
  }
  const Vec2 before = rig.points.side[0].centre_mm;
  rig.read(film().view(0), 0);
  CHECK(length(rig.points.side[0].centre_mm - before) == 0);
}

TEST_CASE("the gaze hardly depends on where the pose has the eyes") {
  const auto gaze_at = [](Vec3 off) {
    Rig rig;
    Pose pose = film().poses[0];
    pose.t = pose.t + off;
    rig.view = view_of(pose, film().camera);
    for (int k = 0; k < kPartFitTuning.start_centrings; ++k) rig.read(film().view(0), 1);
    rig.read(film().view(0), 0);
    return rig.fit->gaze(rig.points);
  };
  const Vec3 gaze = gaze_at({});
  CHECK(length(gaze) == doctest::Approx(1));
  // With the model's place for the corners 3 mm would be 0.29 up or down.
  for (const Vec3 off : {Vec3{0, 3, 0}, Vec3{0, -3, 0}}) CHECK(magnitude(gaze_at(off).y - gaze.y) < 0.15f);
  for (const Vec3 off : {Vec3{3, 0, 0}, Vec3{-3, 0, 0}}) CHECK(magnitude(gaze_at(off).x - gaze.x) < 0.15f);
}

TEST_CASE("crops do not leave the eyes' surroundings, whatever is seen") {
  Rig rig;
  std::vector<std::uint8_t> stripes(320 * 240);
  for (std::size_t k = 0; k < stripes.size(); ++k)
    stripes[k] = (k / 320 + k) % 16 < 8 ? std::uint8_t{20} : std::uint8_t{230};
  for (int k = 0; k < 200; ++k) rig.read(view_of_pixels(stripes, 320, 240, 0), 1);
  for (std::size_t s = 0; s < rig.points.side_count; ++s)
    CHECK(length(rig.points.side[s].centre_mm) <= kPartFitTuning.most_off_centre_mm * 1.001f);
}

TEST_CASE(
    "blank pictures, and poses beyond the frame or not numbers, leave every value finite and in range") {
  Rig rig;
  rig.read(film().view(0));
  rig.fit->calibrate(&rig.points);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const Vec3 places[] = {{}, {1e6f, 0, 0}, {0, -1e6f, 0}, {0, 0, -2 * film().poses[0].t.z}, {nan, 0, 0}};
  for (const int grey : {0, 128, 255}) {
    const std::vector<std::uint8_t> blank(320 * 240, static_cast<std::uint8_t>(grey));
    for (const Vec3 place : places) {
      Pose pose = film().poses[0];
      pose.t = pose.t + place;
      rig.view = view_of(pose, film().camera);
      rig.read(view_of_pixels(blank, 320, 240, 0), 1);
      rig.fit->fit(1 / 30.0f, &rig.points);
      for (std::size_t k = 0; k < rig.points.parameter_count; ++k) {
        const Parameter& p = model().parameters()[rig.points.parameter[k]];
        CHECK(rig.points.last[k] >= p.minimum);
        CHECK(rig.points.last[k] <= p.maximum);
        CHECK(is_finite(rig.points.sd[k]));
      }
      for (std::size_t s = 0; s < rig.points.side_count; ++s) CHECK(is_finite(rig.points.side[s].centre_mm));
    }
  }
}

TEST_CASE("a model without learnt readers, or without their landmarks, has no points") {
  PartPoints points;
  CHECK(points.open(baked_face().model) == Status::not_found);
  CHECK(points.side_count == 0);
}

}  // namespace part_fit_test
