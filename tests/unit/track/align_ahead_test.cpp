// The frame after an aligned one: the face is aligned first, and templates are searched for from there.
#include <doctest/doctest.h>

#include "bad_frames.hpp"

namespace align_ahead_test {

using namespace pliant;
using namespace bad_frames;

namespace {

/// The last frame of a second of aligned ones: a new track is due in it.
constexpr std::size_t kLastAligned = kChange + static_cast<std::size_t>(kRealignmentTuning.most_frames) - 1;

/// Searches in frame k, which alignment makes a tracked one.
std::uint32_t searches(Tracked& t, std::size_t k) {
  CHECK(t.state(k) == TrackState::tracking);
  return t.tracker->work().searches;
}

}  // namespace

TEST_CASE(
    "after an aligned frame each template is searched for once, where the next alignment has the face") {
  Tracked t(dim_film());
  const std::uint32_t twice = searches(t, kChange);  // the first bad frame was not to be expected
  for (std::size_t k = kChange + 1; k < kLastAligned; ++k) {
    const int before = t.fake.refinements;
    const std::uint32_t n = searches(t, k);
    CHECK(n > 0);
    CHECK(10 * n < 6 * twice);
    CHECK(t.fake.refinements == before + 1);
  }
  CHECK(searches(t, kLastAligned) == 0);  // the mean face is aligned, too: is it another person?
}

TEST_CASE(
    "after an aligned frame no templates are searched for where the mean face has to confirm the place") {
  Tracked t(dim_film());
  t.fake.refined_too_low_px =
      0.5f * (kRealignmentTuning.most_distance + kRealignmentTuning.most_disagreement) * t.eyes_px;
  CHECK(searches(t, kChange) > 0);
  t.fake.refined_too_low_px *= 2;  // from the last place, which was too low by the first half
  const int before = t.fake.alignments;
  t.state(kChange + 1);
  CHECK(t.fake.alignments == before + 1);
  CHECK(t.tracker->work().searches == 0);
}

TEST_CASE("after an aligned frame in which no face is seen the templates are searched for as usual") {
  Tracked t(dim_film());
  CHECK(t.state(kChange) == TrackState::tracking);
  t.fake.score = 0.5f * kRealignmentTuning.least_seen_score;
  const int before = t.fake.refinements;
  CHECK(t.state(kChange + 1) == TrackState::degraded);
  CHECK(t.fake.refinements == before + 1);  // not once more at the end
  CHECK(t.tracker->work().searches > 0);
}

TEST_CASE("a frame that begins where the mean face was seen searches for no templates") {
  Tracked t(dim_film());
  t.cut();
  CHECK(t.state(kChange) == TrackState::degraded);
  CHECK(t.tracker->work().searches > 0);
  t.state(kChange + 1);
  CHECK(t.tracker->work().searches == 0);
}

}  // namespace align_ahead_test
