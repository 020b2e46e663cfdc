// Offsets of landmarks from the model's positions: a person's own are kept and tracked, noise is not.
#include "track/offset_landmarks.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "baked_face.hpp"
#include "model_builder.hpp"
#include "random.hpp"
#include "track/landmark_fit.hpp"
#include "track/landmark_offsets.hpp"
#include "track/markers.hpp"
#include "track/surface_offset.hpp"

namespace offset_landmarks_test {

using namespace pliant;

namespace {

constexpr int kWidth = 640, kHeight = 480;

/// A person: the built-in face with another identity and landmarks away from the model's positions, in frontal view.
struct Person {
  BakedModel& face = baked_face();
  const Model& model = face.model;
  std::vector<float> q = face.rest();
  std::vector<std::string> names;  // of the landmarks that are given
  std::vector<Vec3> beside;        // mm, a name
  Camera camera = centred_camera(kWidth, kHeight, 900);
  Pose pose{exp_rotation({0.05f, 0.1f, -0.03f}), {5, -10, 500}};

  Person(Random& random, float elsewhere_mm) {
    for (std::size_t k = 0; k < q.size(); ++k) {
      const Parameter& p = model.parameters()[k];
      if (p.group == Group::identity) q[k] = clamp(0.7f * random.normal(), p.minimum, p.maximum);
    }
    for (int k = 17; k < 60; ++k) {  // neither silhouette nor inner lips
      names.push_back("ibug" + std::to_string(k));
      beside.push_back(elsewhere_mm * Vec3{random.normal(), random.normal(), random.normal()});
    }
  }
  /// True image position of landmark k, with the head turned by `turn` and the expression `now`.
  Vec2 truth(std::size_t k, const Quat& turn, const std::vector<float>& now) const {
    Vec2 x;
    const Pose turned{turn * pose.q, pose.t};
    REQUIRE(Projector(view_of(turned, camera), true).project(face.at(names[k], now) + beside[k], &x));
    return x;
  }
};

/// The model fitted to points of a person, and an estimator that starts there.
struct Start {
  std::vector<Correspondence> points;
  std::vector<float> q;
  FitReport report;
  InArena<Estimator> estimator;
  InArena<LandmarkOffsets> offsets;

  Start(const Person& person, const std::vector<Vec2>& given)
      : q(person.q.size()), estimator(person.model, EstimatorLimits{}), offsets(person.model) {
    for (std::size_t k = 0; k < given.size(); ++k)
      points.push_back({person.face.uv(person.names[k]), given[k]});
    REQUIRE(fit(person) == Status::ok);
    REQUIRE(estimator->start(camera_of(report.view), kWidth, kHeight, pose_of(report.view), q.data(), nullptr,
                             {}) == Status::ok);
    offsets->place_pending(estimator.object);
  }
  Status fit(const Person& person) {
    InArena<LandmarkFit> fit(person.model, points.size());
    FitOptions options;
    options.width = kWidth;
    options.height = kHeight;
    options.focal_px = person.camera.f;
    q.assign(q.size(), 0.0f);
    const Status status = fit->fit({points.data(), points.size()}, options, q.data());
    if (status != Status::ok) return status;
    report = fit->report();
    std::vector<Correspondence> own = points;
    offsets->set_pending(fit->offset_landmarks({own.data(), own.size()}), person.model);
    return status;
  }
  Vec2 landmark(const std::string& name, bool is_personal) {
    const auto k = baked_face().model.find_landmark(name.c_str());
    const Landmark& l = baked_face().model.landmarks()[k];
    Vec2 x;
    REQUIRE(project_beside(estimator.object, l.uv(), is_personal ? offsets->values()[k] : Vec3{}, &x));
    return x;
  }
  /// Mean error of the landmarks given, px.
  float error(const Person& person, const Quat& turn, const std::vector<float>& now, bool is_personal) {
    float sum = 0;
    for (std::size_t k = 0; k < person.names.size(); ++k)
      sum += length(landmark(person.names[k], is_personal) - person.truth(k, turn, now)) /
             static_cast<float>(person.names.size());
    return sum;
  }
};

std::vector<Vec2> given_by(const Person& person, Random& random, float noise_px) {
  std::vector<Vec2> given;
  for (std::size_t k = 0; k < person.names.size(); ++k)
    given.push_back(person.truth(k, {}, person.q) + noise_px * Vec2{random.normal(), random.normal()});
  return given;
}

}  // namespace

TEST_CASE(
    "an offset projects to the position it was computed from, and a zero offset to the surface, with and "
    "without a lens") {
  const BakedModel& face = baked_face();
  Camera camera = centred_camera(kWidth, kHeight, 700);
  for (const float k1 : {0.0f, -0.15f}) {
    camera.k1 = k1;
    InArena<Estimator> e(face.model, EstimatorLimits{});
    const auto rest = face.rest();
    REQUIRE(e->start(camera, kWidth, kHeight, {exp_rotation({0.2f, -0.4f, 0.3f}), {60, 30, 500}}, rest.data(),
                     nullptr, {}) == Status::ok);
    Random random(3);
    for (int i = 0; i < 100; ++i) {
      const Vec2 uv{random.uniform(0.1f, 0.9f), random.uniform(0.1f, 0.9f)};
      Vec2 own, again;
      REQUIRE(e->project(uv, &own));
      REQUIRE(project_beside(e.object, uv, {}, &again));
      CHECK(length(own - again) == 0);
      const Vec2 x = own + Vec2{random.uniform(-20, 20), random.uniform(-20, 20)};
      Vec3 offset;
      REQUIRE(find_offset(e->view(), e->lens(), e->surface_point(uv), x, &offset));
      REQUIRE(project_beside(e.object, uv, offset, &again));
      CHECK(length(again - x) < 0.02f);
    }
    Vec3 offset{1, 2, 3};
    CHECK_FALSE(find_offset(e->view(), e->lens(), {}, {std::numeric_limits<float>::quiet_NaN(), 3}, &offset));
    CHECK(offset.z == 3);
  }
}

TEST_CASE("an offset turns and grows with the head, and goes with the surface below it") {
  const BakedModel& face = baked_face();
  const Camera camera = centred_camera(kWidth, kHeight, 700);
  InArena<Estimator> e(face.model, EstimatorLimits{});
  auto q = face.rest();
  REQUIRE(e->start(camera, kWidth, kHeight, {{}, {0, 0, 500}}, q.data(), nullptr, {}) == Status::ok);
  const Vec2 uv = face.uv("ibug57");
  const Vec3 beside{2, -3, 0};  // seen from the front
  Vec2 x;
  REQUIRE(Projector(e->view(), true).project(baked_face().at(uv, q) + beside, &x));
  Vec3 offset;
  REQUIRE(find_offset(e->view(), e->lens(), e->surface_point(uv), x, &offset));
  CHECK(length(offset - beside) < 1e-3f);
  q = face.posed("jawOpen");
  State state;
  state.pose = {exp_rotation({0.3f, 0.5f, -0.6f}), {40, -20, 400}};
  state.q = q.data();
  REQUIRE(e->restore(state) == Status::ok);
  Vec2 followed;
  REQUIRE(project_beside(e.object, uv, offset, &followed));
  REQUIRE(Projector(e->view(), true).project(baked_face().at(uv, q) + beside, &x));
  CHECK(length(followed - x) < 0.01f);
}

TEST_CASE("the person's fraction of the residuals is the part that noise does not explain") {
  const float noise = 30 + std::sqrt(60.0f);  // 30 degrees of freedom: sum of squares and its deviation
  CHECK(person_fraction(0, 50, 20, 1) == 0);
  CHECK(person_fraction(noise, 50, 20, 1) == 0);
  CHECK(person_fraction(4 * noise, 50, 20, 1) == doctest::Approx(0.75));
  CHECK(person_fraction(16 * noise, 50, 20, 2) == doctest::Approx(0.75));
  CHECK(person_fraction(1e9f, 10, 10, 1) == 0);  // no degrees of freedom remain
  CHECK(person_fraction(1e9f, 10, 11, 1) == 0);
  CHECK(person_fraction(std::numeric_limits<float>::quiet_NaN(), 10, 6, 1) == 0);
}

TEST_CASE(
    "a fit uses one degree of freedom for each unknown of the pose and each parameter that it determines") {
  const Model& model = baked_face().model;
  std::vector<float> sd(model.parameters().count, 0.0f);
  CHECK(coordinates_taken(model, sd.data()) == kPoseUnknowns);  // all frozen
  for (std::size_t k = 0; k < sd.size(); ++k) sd[k] = model.parameters()[k].sd;
  CHECK(coordinates_taken(model, sd.data()) == kPoseUnknowns);  // the prior is unchanged
  sd[0] *= 0.001f;
  sd[1] *= 0.5f;
  CHECK(coordinates_taken(model, sd.data()) == doctest::Approx(kPoseUnknowns + 1.75));
}

TEST_CASE("landmarks with an offset stay where they are seen when the person below them is another one") {
  Random random(5);
  const Person person(random, 3);
  Start start(person, given_by(person, random, 0));
  Estimator& e = start.estimator.object;
  const std::size_t count = person.model.landmarks().count;
  std::vector<Vec2> seen(count);
  std::vector<Vec3> moved(count);
  start.offsets->project_all(e.view(), e, seen.data());
  float largest = 0;
  for (std::size_t k = 0; k < count; ++k) {
    Vec2 x;
    REQUIRE(start.offsets->project(k, e, &x));
    CHECK(length(seen[k] - x) < 0.01f);
    largest = max(largest, length(start.offsets->values()[k]));
  }
  REQUIRE(largest > 1);
  std::vector<float> other = start.q;
  for (std::size_t k = 0; k < other.size(); ++k)
    if (person.model.parameters()[k].group == Group::identity) other[k] = -other[k];
  const std::vector<Vec3> before(start.offsets->values().begin(), start.offsets->values().end());
  REQUIRE(e.revise(other.data(), {}) == Status::ok);
  start.offsets->keep_all(e.view(), e, seen.data(), moved.data());
  float farthest = 0;
  for (std::size_t k = 0; k < count; ++k) {
    Vec2 x;
    REQUIRE(start.offsets->project(k, e, &x));
    CHECK(length(seen[k] - x) < 0.05f);
    CHECK(length(before[k] + moved[k] - start.offsets->values()[k]) < 1e-3f);
    farthest = max(farthest, length(moved[k]));
  }
  CHECK(farthest > 1);
}

TEST_CASE("markers, too, stay where they are seen when the person below them is another one") {
  Random random(5);
  const Person person(random, 3);
  Start start(person, given_by(person, random, 0));
  Estimator& e = start.estimator.object;
  std::vector<Vec2> given, seen(3);
  for (const char* name : {"ibug30", "ibug48", "ibug19"})
    given.push_back(start.landmark(name, false) + Vec2{3, 5});
  InArena<Markers> markers(given.size());
  REQUIRE(markers->place(e, {given.data(), given.size()}, 1) == Status::ok);
  markers->project_all(e.view(), e, seen.data());
  const auto error = [&](std::size_t k) {
    Vec2 x;
    REQUIRE(markers->position(k, e, &x));
    return length(x - given[k]);
  };
  std::vector<float> other = start.q;
  for (std::size_t k = 0; k < other.size(); ++k)
    if (person.model.parameters()[k].group == Group::identity) other[k] = -other[k];
  REQUIRE(e.revise(other.data(), {}) == Status::ok);
  float moved = 0;
  for (std::size_t k = 0; k < given.size(); ++k) {
    CHECK(length(seen[k] - given[k]) < 0.05f);
    moved = max(moved, error(k));
  }
  CHECK(moved > 1);
  seen[1] = kNowhere;  // behind the camera: its offset stays
  const float unseen = error(1);
  markers->keep_all(e.view(), e, seen.data());
  for (std::size_t k = 0; k < given.size(); ++k) CHECK(magnitude(error(k) - (k == 1 ? unseen : 0)) < 0.05f);
}

TEST_CASE(
    "landmarks and markers that are placed in one view stay there when they are kept where another one shows "
    "them") {
  Random random(5);
  const Person person(random, 3);
  Start start(person, given_by(person, random, 0));
  Estimator& e = start.estimator.object;
  const Vec2 given = start.landmark("ibug30", true) + Vec2{6, 2};
  const std::uint16_t nose = person.model.find_landmark("ibug30");
  start.offsets->place(person.model.landmarks()[nose].uv(), given, e);
  const Vec2 beside =
      start.landmark("ibug00", true) - Vec2{12, 0};  // of the face: a marker on it has no offset
  InArena<Markers> markers(std::size_t{1});
  REQUIRE(markers->place(e, {&beside, 1}, 1) == Status::ok);
  View turned = e.view();
  turned.q = exp_rotation({0, 0.7f, 0}) * turned.q;
  std::vector<Vec2> seen(person.model.landmarks().count);
  std::vector<Vec3> moved(seen.size());
  Vec2 marker;
  start.offsets->project_all(turned, e, seen.data());
  start.offsets->keep_all(turned, e, seen.data(), moved.data());
  markers->project_all(turned, e, &marker);
  markers->keep_all(turned, e, &marker);
  Vec2 x;
  REQUIRE(start.offsets->project(nose, e, &x));
  CHECK(length(x - given) < 0.02f);
  REQUIRE(markers->position(0, e, &x));
  CHECK(length(x - beside) < 0.02f);
}

TEST_CASE("exact points of a person with the model's landmarks give no offset") {
  Random random(11);
  for (int trial = 0; trial < 4; ++trial) {
    const Person person(random, 0);
    Start start(person, given_by(person, random, 0));
    for (const Vec3& offset : start.offsets->values()) CHECK(length(offset) == 0);
  }
}

TEST_CASE("a person's landmark offsets are kept as head and mouth move") {
  Random random(21);
  float own = 0, model = 0, own_later = 0, model_later = 0;
  constexpr int kTrials = 6;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Person person(random, 2.5f);
    const auto given = given_by(person, random, 0);
    Start start(person, given);
    own += start.error(person, {}, person.q, true);
    model += start.error(person, {}, person.q, false);
    const Quat turn = exp_rotation({0.15f, 0.3f, 0.1f});
    std::vector<float> now = person.q, fitted = start.q;
    const auto jaw = person.model.find_parameter("jawOpen");
    now[jaw] += 0.25f;
    fitted[jaw] = min(fitted[jaw] + 0.25f, person.model.parameters()[jaw].maximum);
    State state;
    state.pose = pose_of(start.report.view);
    state.pose.q = turn * state.pose.q;
    state.q = fitted.data();
    REQUIRE(start.estimator->restore(state) == Status::ok);
    own_later += start.error(person, turn, now, true);
    model_later += start.error(person, turn, now, false);
  }
  MESSAGE("px, where it started: " << own / kTrials << " (the model's " << model / kTrials
                                   << "); turned and talking: " << own_later / kTrials << " ("
                                   << model_later / kTrials << ")");
  CHECK(own < 0.3f * model);
  CHECK(own_later < 0.6f * model_later);
}

TEST_CASE("landmarks that a person has elsewhere push no identity parameter to its limit") {
  Random random(25);
  int at_limit = 0;
  for (int trial = 0; trial < 12; ++trial) {
    const Person person(random, 3);
    Start start(person, given_by(person, random, 0));
    for (std::size_t k = 0; k < start.q.size(); ++k) {
      const Parameter& p = person.model.parameters()[k];
      at_limit += p.group == Group::identity && (start.q[k] >= p.maximum || start.q[k] <= p.minimum);
    }
  }
  CHECK(at_limit == 0);
}

TEST_CASE("with noisy points of an exact model, the result is no worse than the model's own landmarks") {
  Random random(31);
  float own = 0, model = 0;
  for (int trial = 0; trial < 16; ++trial) {
    const Person person(random, 0);
    auto given = given_by(person, random, 0);
    Vec2 low = given[0], high = given[0];
    for (const Vec2 x : given) {
      low = min(low, x);
      high = max(high, x);
    }
    const float sd = kLandmarkFitTuning.annotation_sd_fraction * length(high - low);
    for (Vec2& x : given) x = x + sd * Vec2{random.normal(), random.normal()};
    Start start(person, given);
    own += start.error(person, {}, person.q, true);
    model += start.error(person, {}, person.q, false);
  }
  MESSAGE("mean error, px: " << own / 16 << ", the model's " << model / 16);
  CHECK(own < 1.02f * model);
}

TEST_CASE(
    "rejected points, points moved along the silhouette and points that are no landmarks give no offset") {
  const Model& model = baked_face().model;
  const Vec2 uv[] = {
      baked_face().uv("ibug30"), baked_face().uv("ibug08"), baked_face().uv("ibug51"), {0.31f, 0.37f}};
  std::vector<Correspondence> points;
  for (const Vec2 at : uv) points.push_back({at, {100, 100}, 1});
  const std::vector<Vec2> residuals(4, Vec2{6, -8});
  const std::vector<float> sd(model.parameters().count, 0.0f);
  const std::uint8_t is_landmark[] = {1, 0, 1, 0};
  const Span<Correspondence> personal =
      find_offset_landmarks(model, {points.data(), points.size()}, residuals.data(), is_landmark, sd.data());
  REQUIRE(personal.count == 2);
  CHECK(length(personal[1].uv - uv[2]) == 0);
  // Eight coordinates, six used by the pose. Two landmarks have half of both: one degree of freedom, 200 px^2.
  const double fraction = 1 - (1 + std::sqrt(2.0)) / 200;
  CHECK(personal[1].x.x == doctest::Approx(100 + (1 - fraction) * 6));
  CHECK(personal[1].x.y == doctest::Approx(100 - (1 - fraction) * 8));
  const std::uint8_t none[] = {0, 0, 0, 0};
  CHECK(find_offset_landmarks(model, {points.data(), points.size()}, residuals.data(), none, sd.data())
            .empty());
  CHECK(find_offset_landmarks(model, {}, nullptr, nullptr, sd.data()).empty());
}

TEST_CASE("one gross outlier gives no offset") {
  Random random(41);
  const Person person(random, 0.8f);
  auto given = given_by(person, random, 0);
  const std::size_t k = 20;
  given[k] = given[k] + Vec2{0, 120};
  Start start(person, given);
  CHECK(length(start.landmark(person.names[k], true) - person.truth(k, {}, person.q)) < 20);
}

TEST_CASE("landmarks with one (u,v) get the same offset; a landmark without a given position gets none") {
  Random random(51);
  const Person person(random, 2.5f);
  Start start(person, given_by(person, random, 0));
  const Model& model = person.model;
  for (std::size_t k = 0; k < model.landmarks().count; ++k) {
    const Landmark& l = model.landmarks()[k];
    bool is_given = false;
    for (const std::string& name : person.names)
      is_given = is_given || length(person.face.uv(name) - l.uv()) == 0;
    CAPTURE(l.name);
    CHECK(is_given == (length(start.offsets->values()[k]) > 0));
  }
  // Given twice: the later position is used.
  std::vector<Correspondence> twice{{person.face.uv("ibug30"), {300, 200}},
                                    {person.face.uv("ibug30"), {310, 215}}};
  start.offsets->set_pending({twice.data(), 2}, model);
  start.offsets->place_pending(start.estimator.object);
  CHECK(length(start.landmark("ibug30", true) - Vec2{310, 215}) < 0.02f);
  CHECK(length(start.offsets->values()[model.find_landmark("ibug48")]) == 0);
}

TEST_CASE("what an alignment says of ibug48 holds for mouth_right, the same place of the face") {
  const Model& face = baked_face().model;
  InArena<Estimator> e(face, EstimatorLimits{});
  const auto q = baked_face().rest();
  REQUIRE(e->start(centred_camera(kWidth, kHeight, 700), kWidth, kHeight, {{}, {0, 0, 500}}, q.data(),
                   nullptr, {}) == Status::ok);
  std::vector<Vec2> aligned;
  for (const Landmark& l : face.landmarks()) {
    Vec2 x;
    REQUIRE(e->project(l.uv(), &x));
    aligned.push_back(x +
                      Vec2{l.name[0] == 'i' ? 3.0f : 0.0f, 0});  // only those of the ibug scheme are aligned
  }
  InArena<LandmarkOffsets> offsets(face);
  offsets->clear();
  offsets->set_pending({aligned.data(), aligned.size()}, face);
  offsets->place_pending(e.object);
  const auto offset_of = [&](const char* name) { return offsets->values()[face.find_landmark(name)]; };
  CHECK(length(offset_of("ibug48")) > 1);
  CHECK(length(offset_of("mouth_right") - offset_of("ibug48")) == 0);
  CHECK(length(offset_of("mouth_left") - offset_of("ibug54")) == 0);
  CHECK(length(offset_of("nose_tip")) == 0);  // not the place of ibug30
  for (const Landmark& l : face.landmarks())
    if (l.name[0] == 'i') CHECK(length(offset_of(l.name)) > 1);
}

TEST_CASE("an offset, whatever its depth, is no image position that waits for its place") {
  const Model& face = baked_face().model;
  InArena<Estimator> e(face, EstimatorLimits{});
  const auto q = baked_face().rest();
  REQUIRE(e->start(centred_camera(kWidth, kHeight, 700), kWidth, kHeight, {{}, {0, 0, 500}}, q.data(),
                   nullptr, {}) == Status::ok);
  InArena<LandmarkOffsets> offsets(face);
  for (const float z : {-1.0f, 0.0f, 1.0f, 2.0f}) {
    const std::vector<Vec3> given(face.landmarks().count, Vec3{2, -3, z});
    offsets->set({given.data(), given.size()});
    offsets->place_pending(e.object);
    for (const Vec3& value : offsets->values()) CHECK(length(value - given[0]) == 0);
  }
}

}  // namespace offset_landmarks_test
