#include "host/learn/boosted_trees.hpp"

#include <doctest/doctest.h>

#include <cstring>

#include "host/learn/sample_random.hpp"

namespace boosted_trees_test {

using namespace pliant;
using namespace pliant::host::learn;

namespace {

// Random windows. In those of faces ten features are a little higher.
std::vector<Window> windows(std::size_t count, bool are_faces, std::uint64_t seed) {
  std::vector<Window> all(count);
  for (std::size_t k = 0; k < count; ++k) {
    SampleRandom random(seed, k);
    for (auto& v : all[k]) v = static_cast<std::uint8_t>(random.below(256));
    for (std::size_t f = 100; f < 1100; f += 100)
      all[k][f] = static_cast<std::uint8_t>((are_faces ? 100 : 0) + static_cast<int>(random.below(150)));
  }
  return all;
}

std::vector<DetectorTree> learnt(std::size_t trees, int threads) {
  BoostTuning tuning;
  tuning.feature_fraction = 1;
  return boost_trees(windows(400, true, 1), windows(700, false, 2), trees, tuning, 3, threads, {});
}

}  // namespace

TEST_CASE("trees tell classes apart that no single feature tells apart") {
  const auto trees = learnt(40, 1);
  int right = 0;
  for (const Window& w : windows(200, true, 5)) right += full_sum(trees, w) > 0 ? 1 : 0;
  for (const Window& w : windows(200, false, 6)) right += full_sum(trees, w) <= 0 ? 1 : 0;
  CHECK(right >= 390);
}

TEST_CASE("the trees are the same whatever the number of threads") {
  const auto one = learnt(8, 1), two = learnt(8, 2);
  REQUIRE(one.size() == two.size());
  CHECK(std::memcmp(one.data(), two.data(), one.size() * sizeof(DetectorTree)) == 0);
}

TEST_CASE("features and places in a window are the same numbers") {
  for (int place = 0; place < kWindowFeatures; ++place) CHECK(place_of(feature_at(place)) == place);
  CHECK(feature_at(0) == detector_feature(0, 0, 0));
  CHECK(place_of(detector_feature(2, 3, 4)) == (2 * kWindowCells + 3) * kCellChannels + 4);
}

TEST_CASE("the search finds windows with the bytes that training computes at the same place") {
  SampleRandom random(9, 1);
  pliant::host::Image picture(150, 131, 1);
  for (auto& v : picture.pixels) v = static_cast<std::uint8_t>(random.below(256));
  DetectorTree all{};
  all.rejection = -32768;
  int compared = 0;
  for (const WindowHit& hit : find_hits(picture, {all})) {
    if (hit.box.side < kWindowPx) continue;
    CHECK(window_of(picture, hit.box) == hit.window);
    ++compared;
  }
  CHECK(compared > 500);
}

}  // namespace boosted_trees_test
