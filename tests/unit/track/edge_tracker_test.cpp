// Edges of lids, lips and brows from frame to frame: what counts as the same edge while the light changes.
#include "track/edge_tracker.hpp"

#include <doctest/doctest.h>

#include <vector>

#include "face_film.hpp"
#include "model_builder.hpp"
#include "pliant/tracker.hpp"

namespace edge_tracker_test {

using namespace pliant;

namespace {

const FaceFilm& film() {
  static const FaceFilm* one = new FaceFilm(320, 240, 1, [](float, Pose&, auto&) {});
  return *one;
}

EstimatorLimits of_estimator(const TrackerLimits& of) {
  EstimatorLimits limits;
  limits.points = 600;
  limits.silhouette_points = of.silhouette_points;
  return limits;
}

TrackerLimits limits_of(std::uint16_t curve_points, std::uint16_t silhouette_points) {
  TrackerLimits limits;
  limits.curve_points = curve_points;
  limits.silhouette_points = silhouette_points;
  limits.region_width = limits.region_height = 200;  // away from the frame's corner
  return limits;
}

/// An edge tracker on a face that stands still, and the picture in another light.
struct Rig {
  TrackerLimits limits;
  InArena<Estimator> estimator{baked_face().model, of_estimator(limits)};
  InArena<FrameRegion> region{limits};
  InArena<EdgeTracker> edges{limits};
  std::vector<Observation> seen;
  std::size_t seen_count = 0, used = 0;
  std::uint16_t hidden = kNoSlot;  // id of a point that is taken to be hidden
  std::vector<std::uint8_t> lit;

  /// \param light  in which it starts. \param turn  of the head about the vertical axis, rad; the picture's has none.
  explicit Rig(const TrackerLimits& of = {}, float light = 1, float turn = 0) : limits(of) {
    start(light, turn);
  }
  void start(float light, float turn) {
    Pose pose = film().poses[0];
    pose.q = exp_rotation({0, turn, 0});
    REQUIRE(estimator->start(film().camera, 320, 240, pose, baked_face().rest().data(), nullptr, {}) ==
            Status::ok);
    show(light);
    used = edges->start(estimator.object, region.object);
    seen.resize(EdgeTracker::kAlternatives * edges->count());
  }
  void show(float light) {
    lit = film().frames[0];
    for (std::uint8_t& p : lit) p = static_cast<std::uint8_t>(light * static_cast<float>(p));
    FrameView view = film().view(0);
    view.data = lit.data();
    REQUIRE(region->build(view, {160, 120}) == Status::ok);
  }
  /// \return how many edges were found.
  int frame(float light, Reason judged = Reason::found) {
    show(light);
    const Span<const Prediction> now = estimator->predict();
    std::vector<Prediction> all(now.begin(), now.end());
    std::vector<std::uint16_t> index(of_estimator(limits).points);
    for (std::size_t k = 0; k < all.size(); ++k) {
      index[all[k].id] = static_cast<std::uint16_t>(k);
      if (all[k].id == hidden) all[k].visible = false;
    }
    const std::size_t n = edges->match({{all.data(), all.size()}, index.data()}, region.object,
                                       estimator->view().s, {seen.data(), seen.size()});
    seen_count = n;
    int found = 0;
    for (std::size_t k = 0; k < n; ++k) {
      found += seen[k].reason == Reason::found && (k == 0 || seen[k].id != seen[k - 1].id);
      CHECK(seen[k].cue == Cue::edge);
      if (seen[k].reason == Reason::found) seen[k].reason = judged;
    }
    edges->end_frame({seen.data(), n});
    return found;
  }
};

/// Points that the first frame after a start observes, with edges or without.
int observed_first(bool keeps_previous, bool with_edges) {
  TrackerLimits limits;
  limits.keeps_previous = keeps_previous;
  TrackerOptions options;
  if (!with_edges)
    options.estimator.cues &= static_cast<std::uint8_t>(~(1u << static_cast<unsigned>(Cue::edge)));
  InArena<Tracker> tracker(baked_face().model, limits);
  REQUIRE(tracker->start_from_pose(film().view(0), film().camera, film().poses[0], baked_face().rest().data(),
                                   options) == Status::ok);
  FrameView next = film().view(0);
  next.time_ns += 40000000;
  ++next.sequence;
  FrameResult result;
  REQUIRE(tracker->update(next, &result) == Status::ok);
  return result.tracked;
}

}  // namespace

// Where the frame before is kept, edges are captured when the next one comes.
TEST_CASE("the first frame after a start observes edges, whether the frame before is kept or not") {
  for (const bool keeps_previous : {true, false}) {
    CAPTURE(keeps_previous);
    CHECK(observed_first(keeps_previous, true) > observed_first(keeps_previous, false) + 20);
  }
}

TEST_CASE("edges are followed through light that fades slowly, and are others where it fades at once") {
  constexpr float kDark = 0.25f;
  Rig slow, sudden, doubted;
  const int at_first = slow.frame(1);
  REQUIRE(at_first > 30);
  int last = 0;
  for (float light = 1; light > kDark; light *= 0.97f) {
    last = slow.frame(light);
    doubted.frame(light, Reason::rejected);
  }
  CHECK(last > 0.7f * static_cast<float>(at_first));
  const int at_once = sudden.frame(kDark), not_followed = doubted.frame(kDark);
  MESSAGE("found: " << at_first << ", slowly " << last << ", at once " << at_once << ", rejected "
                    << not_followed);
  CHECK(at_once < 0.6f * static_cast<float>(last));
  CHECK(not_followed < 0.6f * static_cast<float>(last));
}

TEST_CASE(
    "edges of a face that stands still are where they are expected, though the model's curves lie beside "
    "them") {
  Rig rig(limits_of(300, 0));
  rig.frame(1);
  int points = 0, near = 0;
  for (std::size_t k = 0; k < rig.seen_count; ++k) {
    if (k > 0 && rig.seen[k].id == rig.seen[k - 1].id) continue;
    const Prediction p = rig.estimator->predict(rig.seen[k].id);
    bool is_near = false;
    for (std::size_t i = k; i < rig.seen_count && rig.seen[i].id == rig.seen[k].id; ++i)
      is_near = is_near || magnitude(dot(rig.seen[i].x - p.x, p.normal)) < 0.3f;
    ++points;
    near += is_near;
  }
  CHECK(points > 30);
  CHECK(near > 0.9f * static_cast<float>(points));
}

TEST_CASE(
    "curves leave the silhouette its room, and a start after another one begins with none of its points") {
  Rig rig(limits_of(20, 8));
  for (int again = 0; again < 2; ++again) {
    CHECK(rig.edges->count() == 28);
    std::uint16_t id;
    CHECK(rig.estimator->add_silhouette_point(&id) == Status::capacity);
    rig.start(1, 0);
  }
}

TEST_CASE("the silhouette needs no reference: it is found in any light, whatever its contrast was") {
  Rig rig(limits_of(0, 24)), other(limits_of(0, 24));
  CHECK(rig.used == 24);
  for (Rig* one : {&rig, &other}) one->estimator->begin(33'333'333);  // finds it
  REQUIRE(rig.frame(1) > 8);
  for (int k = 0; k < 40; ++k) rig.frame(1);
  const int in_the_dark = rig.frame(0.25f);
  CHECK(in_the_dark > 5);
  CHECK(in_the_dark == other.frame(0.25f));
}

TEST_CASE("points of curves that are hidden, or showed no edge at the start, are not matched") {
  Rig turned(limits_of(300, 0), 1, 0.9f);
  std::vector<bool> was_visible(of_estimator(turned.limits).points);
  std::size_t visible = 0;
  for (const Prediction& p : turned.estimator->predict()) {
    visible += p.visible;
    was_visible[p.id] = p.visible;
  }
  REQUIRE(visible < turned.edges->count());
  std::vector<float> q = baked_face().rest();
  State frontal;
  frontal.pose = film().poses[0];
  frontal.q = q.data();
  REQUIRE(turned.estimator->restore(frontal) == Status::ok);
  CHECK(turned.frame(1) > 0);
  for (std::size_t k = 0; k < turned.seen_count; ++k) CHECK(was_visible[turned.seen[k].id]);
  Rig dark(limits_of(300, 0), 0);
  CHECK(dark.used == 0);
  CHECK(dark.frame(1) == 0);
  CHECK(dark.seen_count == 0);
  Rig rig(limits_of(300, 0));
  REQUIRE(rig.frame(1) > 0);
  rig.hidden = rig.seen[0].id;
  rig.frame(1);
  for (std::size_t k = 0; k < rig.seen_count; ++k) CHECK(rig.seen[k].id != rig.hidden);
}

TEST_CASE("no more observations are written than there is room for") {
  Rig rig(limits_of(300, 0));
  for (std::size_t room = 0; room < 12; ++room) {
    rig.seen.resize(room);
    rig.seen.reserve(room + EdgeTracker::kAlternatives);
    rig.frame(1);
    CHECK(rig.seen_count <= room);
  }
}

}  // namespace edge_tracker_test
