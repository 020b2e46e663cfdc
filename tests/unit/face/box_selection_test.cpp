#include "face/box_selection.hpp"

#include <doctest/doctest.h>

#include "aligned_block.hpp"

namespace box_selection_test {

using namespace pliant;

namespace {

constexpr int kCapacity = 192;

struct Rig {
  AlignedBlock block{1 << 13};
  Arena arena{block.data(), block.size()};
  BoxHits hits;
  Rig() {
    hits.lay_out(arena, kCapacity);
    REQUIRE(!arena.exhausted());
  }
};

BoxHit hit(float x, float y, float side, int sum) {
  return {{{x, y}, side}, sum};
}

}  // namespace

TEST_CASE("the overlap of boxes is the shared area over the area of both") {
  CHECK(overlap({{0, 0}, 10}, {{0, 0}, 10}) == doctest::Approx(1));
  CHECK(overlap({{0, 0}, 10}, {{5, 0}, 10}) == doctest::Approx(1.0 / 3));
  CHECK(overlap({{0, 0}, 10}, {{0, 0}, 20}) == doctest::Approx(0.25));
  CHECK(overlap({{0, 0}, 10}, {{10, 0}, 20}) == doctest::Approx(1.0 / 9));  // 50 of 100 + 400 - 50
  CHECK(overlap({{0, 0}, 10}, {{30, 0}, 10}) == 0);
  CHECK(overlap({{0, 0}, 0}, {{0, 0}, 0}) == 0);
}

TEST_CASE("hits around one face become one, those of another face stay") {
  Rig rig;
  rig.hits.add(hit(100, 100, 50, 300));
  rig.hits.add(hit(104, 100, 50, 300));
  rig.hits.add(hit(96, 100, 50, 300));
  rig.hits.add(hit(200, 100, 60, 200));
  const BoxHit first = rig.hits.take_best(100);
  CHECK(first.sum == 300);
  CHECK(first.box.center.x == doctest::Approx(100));
  CHECK(first.box.side == doctest::Approx(50));
  const BoxHit second = rig.hits.take_best(100);
  CHECK(second.box.center.x == doctest::Approx(200));
  CHECK(rig.hits.empty());
}

TEST_CASE("less clear hits within a face, or around it, go with it") {
  Rig rig;
  rig.hits.add(hit(100, 100, 100, 300));
  rig.hits.add(hit(80, 90, 35, 200));
  rig.hits.add(hit(110, 120, 250, 250));
  const BoxHit face = rig.hits.take_best(100);
  CHECK(face.box.side == 100);
  CHECK(rig.hits.empty());
}

TEST_CASE("a clear hit weighs more than a weak one") {
  Rig rig;
  rig.hits.add(hit(100, 100, 50, 499));
  rig.hits.add(hit(110, 100, 50, 199));
  CHECK(rig.hits.take_best(100).box.center.x == doctest::Approx(102));
}

TEST_CASE("of equally clear hits the larger one weighs more: both middle and side are its side's") {
  Rig rig;
  rig.hits.add(hit(100, 100, 40, 300));
  rig.hits.add(hit(102, 100, 50, 300));
  const BoxHit mean = rig.hits.take_best(100);
  CHECK(mean.box.center.x == doctest::Approx((40 * 100 + 50 * 102) / 90.0));
  CHECK(mean.box.side == doctest::Approx((40 * 40 + 50 * 50) / 90.0));
}

TEST_CASE("a hit below the least sum weighs as one at it") {
  for (const int sum : {100, 60, -500}) {
    CAPTURE(sum);
    Rig rig;
    rig.hits.add(hit(100, 100, 50, 102));
    rig.hits.add(hit(104, 100, 50, sum));
    CHECK(rig.hits.take_best(100).box.center.x == doctest::Approx(101));
  }
}

TEST_CASE("of equal sums the first hit counts, also where there is no room for more") {
  Rig rig;
  for (int k = 0; k < 3; ++k) rig.hits.add(hit(static_cast<float>(100 * k), 0, 50, 300));
  for (float x = 0; x < 300; x += 100) CHECK(rig.hits.take_best(0).box.center.x == x);
  for (int k = 0; k < kCapacity; ++k) rig.hits.add(hit(0, 0, 50, 300));
  rig.hits.add(hit(500, 0, 50, 300));
  rig.hits.take_best(0);
  CHECK(rig.hits.empty());
}

TEST_CASE("beyond its capacity the weakest hits are dropped") {
  Rig rig;
  for (int k = 0; k < 3 * kCapacity; ++k)
    rig.hits.add(hit(static_cast<float>(100 * k), 0, 50, (k * 7919) % 1000));
  int count = 0, last = 1000;
  for (; !rig.hits.empty(); ++count) {
    const int sum = rig.hits.take_best(0).sum;
    CHECK(sum <= last);
    last = sum;
  }
  CHECK(count == kCapacity);
  CHECK(last > 600);
}

}  // namespace box_selection_test
