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

EstimatorLimits of_estimator() {
  EstimatorLimits limits;
  limits.points = 600;
  limits.silhouette_points = TrackerLimits{}.silhouette_points;
  return limits;
}

/// An edge tracker on a face that stands still, and the picture in another light.
struct Rig {
  TrackerLimits limits;
  InArena<Estimator> estimator{baked_face().model, of_estimator()};
  InArena<FrameRegion> region{limits};
  InArena<EdgeTracker> edges{limits};
  std::vector<Observation> seen;
  std::vector<std::uint8_t> lit;

  Rig() {
    REQUIRE(estimator->start(film().camera, 320, 240, film().poses[0], baked_face().rest().data(), nullptr,
                             {}) == Status::ok);
    show(1);
    edges->start(estimator.object, region.object);
    seen.resize(EdgeTracker::kAlternatives * edges->count());
  }
  void show(float light) {
    lit = film().frames[0];
    for (std::uint8_t& p : lit) p = static_cast<std::uint8_t>(light * static_cast<float>(p));
    FrameView view = film().view(0);
    view.data = lit.data();
    REQUIRE(region->build(view, {}) == Status::ok);
  }
  /// \return how many edges were found.
  int frame(float light, Reason judged = Reason::found) {
    show(light);
    const Span<const Prediction> all = estimator->predict();
    std::vector<std::uint16_t> index(of_estimator().points);
    for (std::size_t k = 0; k < all.count; ++k) index[all[k].id] = static_cast<std::uint16_t>(k);
    const std::size_t n =
        edges->match({all, index.data()}, region.object, estimator->view().s, {seen.data(), seen.size()});
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

}  // namespace edge_tracker_test
