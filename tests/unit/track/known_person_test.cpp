// Whether an aligned face is that of the person who is known.
#include "track/known_person.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "baked_face.hpp"
#include "fake_faces.hpp"
#include "model_builder.hpp"

namespace known_person_test {

using namespace pliant;

namespace {

AlignedFace turned_by(float rad) {
  AlignedFace face;
  face.camera = centred_camera(320, 240, 450);
  face.pose = {exp_rotation({0, rad, 0}), {0, 0, 500}};
  return face;
}

/// Parameters of a person; those of a group are off by so many standard deviations, by turns up and down.
std::vector<float> person(Group group = Group::identity, float off_sd = 0) {
  const Span<const Parameter> all = baked_face().model.parameters();
  std::vector<float> q(all.count, 0.1f);
  for (std::size_t k = 0; k < all.count; ++k)
    if (all[k].group == group) q[k] += (k % 2 == 0 ? off_sd : -off_sd) * all[k].sd;
  return q;
}

constexpr float kMost = kKnownPersonTuning.most_identity_distance;
const float kTurned = std::acos(kKnownPersonTuning.least_frontal) + 0.01f;

}  // namespace

TEST_CASE(
    "another person's identity differs by more than a distance, in the mean over its parameters; expressions "
    "do not count") {
  const Model& model = baked_face().model;
  InArena<IdentityReference> known(model);
  const AlignedFace frontal = turned_by(0.3f);
  known->set(frontal, person().data());
  CHECK(known->tells());
  CHECK(known->may_be(frontal, person().data()));
  CHECK(known->may_be(frontal, person(Group::identity, 0.99f * kMost).data()));
  CHECK_FALSE(known->may_be(frontal, person(Group::identity, 1.01f * kMost).data()));
  CHECK(known->may_be(frontal, person(Group::expression, 3).data()));
  float count = 0;
  std::size_t last = 0;
  for (std::size_t k = 0; k < model.parameters().count; ++k) {
    if (model.parameters()[k].group == Group::expression) continue;
    ++count;
    last = k;
  }
  for (const float factor : {0.99f, 1.01f}) {
    std::vector<float> q = person();
    q[last] += factor * kMost * std::sqrt(count) * model.parameters()[last].sd;
    CHECK(known->may_be(frontal, q.data()) == (factor < 1));
  }
  known->set(frontal, person(Group::identity, 1).data());
  CHECK_FALSE(known->may_be(frontal, person().data()));
}

TEST_CASE("faces that are turned away do not tell who it is, neither the first one nor the one that comes") {
  InArena<IdentityReference> known(baked_face().model);
  const AlignedFace frontal = turned_by(0), turned = turned_by(kTurned);
  CHECK_FALSE(known->tells());
  known->set(frontal, person().data());
  CHECK(known->may_be(turned, person(Group::identity, 3).data()));
  CHECK_FALSE(known->may_be(turned_by(kTurned - 0.02f), person(Group::identity, 3).data()));
  known->set(turned, person().data());
  CHECK_FALSE(known->tells());
  known->set(frontal, person().data());
  known->forget();
  CHECK_FALSE(known->tells());
}

TEST_CASE("a face that is aligned surely as the known person alone is theirs") {
  constexpr std::size_t kDark = 20, kLight = 30, kFrames = 40;
  const FaceFilm film = drifting_face(kFrames);
  const std::vector<std::uint8_t> black(film.frames[0].size(), 0);
  for (const bool is_known : {true, false}) {
    CAPTURE(is_known);
    FakeFaces fake(film);
    InArena<Tracker> tracker(baked_face().model, limits_with_fake());
    for (std::size_t k = 0; k < kFrames; ++k) {
      if (k == kDark) fake.free_score = 0.9f * kFaceSearchTuning.least_start;
      fake.has_ghost = k >= kDark;  // a candidate that is better, and no face
      if (k == kLight && !is_known) REQUIRE(tracker->start_by_detection() == Status::ok);
      FrameView view = film.view(k);
      if (k >= kDark && k < kLight) view.data = black.data();
      FrameResult result;
      REQUIRE(tracker->update(view, &result) == Status::ok);
      if (k + 1 == kLight) CHECK_FALSE(tracker->is_started());
    }
    CHECK(tracker->is_started() == is_known);
    CHECK(tracker->person_number() == 1);
  }
}

}  // namespace known_person_test
