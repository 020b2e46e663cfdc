// Which vertices are at one place: those of the two sides of a cut, also where the file's digits have rounded them apart.
#include "host/bake/places.hpp"

#include <doctest/doctest.h>

#include <chrono>

#include "random.hpp"

namespace places_test {

using namespace pliant;
using namespace pliant::host::bake;

TEST_CASE("places are numbered as they appear; equal and nearly equal vertices are at one") {
  CHECK(places_of({}).empty());
  CHECK(places_of({{1, 2, 3}}) == std::vector<int>{0});
  CHECK(places_of({{1, 2, 3}, {1, 2, 3}}) == std::vector<int>{0, 0});
  CHECK(places_of({{0, 0, 0}, {100, 0, 0}, {0, 0, 0}, {100, 0.0005f, 0}, {100, 0.005f, 0}, {-0.0f, 0, 0}}) ==
        std::vector<int>{0, 1, 0, 1, 2, 0});
  CHECK(places_of({{1e5f, 0, 0}, {1e5f, 0, 0}, {1e5f, 1e-20f, 0}}) == std::vector<int>{0, 0, 1});
}

TEST_CASE("a vertex belongs to the first place that is near it, wherever the two are") {
  Random random(7);
  std::vector<Vec3> points{{0, 0, 0}, {100, 100, 100}};  // the diagonal is 173 mm, the tolerance 0.00173 mm
  const auto coordinate = [&random] { return 0.0004f * static_cast<float>(random.below(100)) - 0.02f; };
  for (int k = 0; k < 4000; ++k) points.push_back({coordinate(), coordinate(), coordinate()});
  const std::vector<int> places = places_of(points);
  std::vector<std::size_t> first;
  const double tolerance = 1e-5 * static_cast<double>(length(Vec3{100.02f, 100.02f, 100.02f}));
  for (std::size_t v = 0; v < points.size(); ++v) {
    std::size_t expected = 0;
    while (expected < first.size() &&
           static_cast<double>(length(points[v] - points[first[expected]])) > tolerance)
      ++expected;
    if (expected == first.size()) first.push_back(v);
    CHECK(places[v] == static_cast<int>(expected));
  }
  CHECK(first.size() < 3000);
}

TEST_CASE(
    "a quarter of a million vertices take no longer than they must: of a plane, and all at a few places") {
  std::vector<Vec3> plane, few;
  for (int k = 0; k < 250000; ++k) {
    plane.push_back({static_cast<float>(k % 500), static_cast<float>(k / 500), 0});
    few.push_back({static_cast<float>(k % 3), 1e-6f * static_cast<float>(k % 5), 0});
  }
  const auto begin = std::chrono::steady_clock::now();
  CHECK(places_of(plane).back() == 249999);
  CHECK(places_of(few).back() < 3);
  CHECK(std::chrono::steady_clock::now() - begin <
        std::chrono::seconds(60));  // compared with each other: an hour
}

}  // namespace places_test
