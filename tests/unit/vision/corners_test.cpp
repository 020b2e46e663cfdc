#include "pliant/corners.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "aligned_block.hpp"
#include "texture.hpp"
#include "vision/corner_grid.hpp"
#include "vision/corner_scores.hpp"

namespace corners_test {

using namespace pliant;
using texture::Picture;

namespace {

struct Found {
  Status status = Status::ok;
  std::vector<Corner> corners;
};

Found find(const ImageView& image, const CornerOptions& options,
           const std::vector<std::uint8_t>& allowed = {}, std::size_t room = 1000) {
  AlignedBlock block(corner_scratch_bytes(image.width, image.height, options));
  Arena scratch(block.data(), block.size());
  Found f;
  f.corners.resize(room);
  int count = -1;
  f.status = find_corners(image, options, {allowed.data(), allowed.size()}, scratch, {f.corners.data(), room},
                          count);
  f.corners.resize(count < 0 ? 0 : static_cast<std::size_t>(count));
  CHECK(scratch.used_bytes() == 0);
  return f;
}

Picture checkerboard(int width, int height, int square) {
  Picture p(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) p.at(x, y) = (x / square + y / square) % 2 == 0 ? 60 : 200;
  return p;
}

Picture textured(int width, int height) {
  return render(texture::Texture(5), {}, width, height);
}

// The smaller eigenvalue by the definition, in double.
double plain_score(const ImageView& v, int cx, int cy) {
  double xx = 0, xy = 0, yy = 0;
  for (int y = cy - 3; y <= cy + 3; ++y)
    for (int x = cx - 3; x <= cx + 3; ++x) {
      const auto at = [&](int i, int j) { return double{1} * v.data[(y + j) * v.stride + x + i]; };
      double gx = 0, gy = 0;
      const double w[3] = {3 / 32.0, 10 / 32.0, 3 / 32.0};
      for (int k = -1; k <= 1; ++k) {
        gx += w[k + 1] * (at(1, k) - at(-1, k));
        gy += w[k + 1] * (at(k, 1) - at(k, -1));
      }
      xx += gx * gx / 49;
      xy += gx * gy / 49;
      yy += gy * gy / 49;
    }
  return 0.5 * (xx + yy - std::sqrt((xx - yy) * (xx - yy) + 4 * xy * xy));
}

}  // namespace

TEST_CASE("a checkerboard has its corners where its squares meet") {
  const Picture p = checkerboard(128, 96, 16);
  const Found f = find(p.view(), {});
  REQUIRE(f.status == Status::ok);
  CHECK(f.corners.size() == 7 * 5);
  for (const Corner& c : f.corners) {
    // A meeting point lies between pixels 16 k - 1 and 16 k. The window is a plain box: while the whole of a
    // perfect corner is in it, the score stays the same, and the first of the equals is taken.
    const double dx = std::fabs(std::remainder(double(c.x.x) + 0.5, 16)),
                 dy = std::fabs(std::remainder(double(c.x.y) + 0.5, 16));
    CHECK(dx <= 2.5);
    CHECK(dy <= 2.5);
  }
}

TEST_CASE("scores are the smaller eigenvalue of the mean structure tensor") {
  const Picture p = textured(80, 60);
  for (int y = 4; y < 56; y += 3)
    for (int x = 4; x < 76; x += 3) {
      const float s = corner_score(p.view(), {static_cast<float>(x), static_cast<float>(y)});
      CHECK(double(s) == doctest::Approx(plain_score(p.view(), x, y)).epsilon(1e-4));
    }
}

TEST_CASE("the scan and the score of a single point agree to the bit") {
  const Picture p = textured(120, 90);
  const Found f = find(p.view(), {});
  REQUIRE(f.corners.size() > 20);
  for (const Corner& c : f.corners) CHECK(c.score == corner_score(p.view(), c.x));
}

TEST_CASE("every corner is the best within its neighbourhood") {
  const Picture p = textured(120, 90);
  for (const Corner& c : find(p.view(), {}).corners)
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx)
        CHECK(corner_score(p.view(), {c.x.x + static_cast<float>(dx), c.x.y + static_cast<float>(dy)}) <=
              c.score);
}

TEST_CASE("corners come best first, keep their distance, and fewer are the first of more") {
  const Picture p = textured(160, 120);
  CornerOptions o;
  o.cell_px = 4;
  o.min_distance_px = 11;
  const Found all = find(p.view(), o), few = find(p.view(), o, {}, 10);
  REQUIRE(all.corners.size() > 20);
  REQUIRE(few.corners.size() == 10);
  for (std::size_t i = 0; i < all.corners.size(); ++i) {
    const Corner& c = all.corners[i];
    if (i > 0) CHECK(all.corners[i - 1].score >= c.score);
    if (i < 10) CHECK((few.corners[i].x.x == c.x.x && few.corners[i].x.y == c.x.y));
    for (std::size_t k = 0; k < i; ++k) CHECK(length(all.corners[k].x - c.x) >= 11);
  }
}

TEST_CASE("one scan serves all distances, in any order") {
  const Picture p = textured(160, 120);
  CornerOptions o;
  o.quality = 0.05f;
  std::vector<std::uint8_t> allowed(20 * 15, 1);
  for (std::size_t i = 0; i < allowed.size(); i += 3) allowed[i] = 0;
  AlignedBlock block(corner_scratch_bytes(160, 120, o));
  Arena scratch(block.data(), block.size());
  corners::Grid grid;
  REQUIRE(corners::scan_cells(p.view(), o, {allowed.data(), allowed.size()}, scratch, &grid) == Status::ok);
  for (const float distance : {30.0f, 2.0f, 11.0f, 30.0f}) {
    o.min_distance_px = distance;
    const Found expected = find(p.view(), o, allowed);
    std::vector<Corner> chosen(200);
    const int count = corners::choose_corners(grid, o.quality, distance, {chosen.data(), chosen.size()});
    REQUIRE(static_cast<std::size_t>(count) == expected.corners.size());
    REQUIRE(count > 3);
    for (std::size_t i = 0; i < expected.corners.size(); ++i) {
      CHECK(chosen[i].x.x == expected.corners[i].x.x);
      CHECK(chosen[i].x.y == expected.corners[i].x.y);
      CHECK(chosen[i].score == expected.corners[i].score);
    }
  }
}

TEST_CASE("a scan of rows writes all the memory that it takes, but for what fills up 16 bytes") {
  const Picture p = textured(77, 40);
  const ImageView image = p.view();  // the scorer keeps a pointer to it
  const int columns = 77 - 2 * kCornerMargin;
  Arena measuring;
  corners::RowScorer scorer;
  scorer.lay_out(measuring, columns);
  AlignedBlock block(measuring.used_bytes());
  std::vector<char> is_written(block.size(), 0);
  for (const int pattern : {0x5a, 0xa5}) {  // what is written may have the value of one of them
    const auto fill = static_cast<unsigned char>(pattern);
    std::memset(block.data(), fill, block.size());
    Arena arena(block.data(), block.size());
    scorer.lay_out(arena, columns);
    scorer.start(image, kCornerMargin, 77 - kCornerMargin, kCornerMargin);
    std::vector<float> scores(static_cast<std::size_t>(columns));
    for (int y = kCornerMargin; y < 40 - kCornerMargin; ++y) scorer.next(0, scores.data());
    for (std::size_t i = 0; i < block.size(); ++i)
      if (block.data()[i] != fill) is_written[i] = 1;
  }
  std::size_t longest = 0, run = 0;
  for (const char written : is_written) {
    run = written != 0 ? 0 : run + 1;
    longest = run > longest ? run : longest;
  }
  CHECK(longest < Arena::kAlignment);
}

TEST_CASE("pure edges are no corners") {
  Picture p(64, 64, 40);
  for (int y = 0; y < 64; ++y)
    for (int x = 32; x < 64; ++x) p.at(x, y) = 210;
  CHECK(find(p.view(), {}).corners.empty());
}

TEST_CASE("corners below the smallest score, or below a fraction of the best, are left out") {
  const Picture p = textured(160, 120);
  CornerOptions all;
  all.min_score = all.quality = 0;
  const Found found = find(p.view(), all);
  REQUIRE(found.corners.size() > 20);
  const float middle = found.corners[found.corners.size() / 2].score, best = found.corners[0].score;
  CornerOptions strong = all, relative = all;
  strong.min_score = middle;
  relative.quality = middle / best;
  for (const CornerOptions& o : {strong, relative}) {
    const Found fewer = find(p.view(), o);
    CHECK(fewer.corners.size() < found.corners.size());
    CHECK(fewer.corners.size() > found.corners.size() / 4);
    for (const Corner& c : fewer.corners) CHECK(c.score >= 0.999f * middle);
  }
}

TEST_CASE("a mask keeps corners out of forbidden cells, and a mask of everything is none") {
  const Picture p = textured(100, 70);
  const CornerOptions o;
  const int w = corner_cells(100, 8), h = corner_cells(70, 8);
  std::vector<std::uint8_t> allowed(static_cast<std::size_t>(w * h), 1);
  const Found all = find(p.view(), o), same = find(p.view(), o, allowed);
  REQUIRE(all.corners.size() == same.corners.size());
  for (int cy = 0; cy < h; ++cy)
    for (int cx = 0; cx < w; ++cx)
      allowed[static_cast<std::size_t>(cy * w + cx)] = cx > 3 && cx < 9 && cy != 4;
  const Found some = find(p.view(), o, allowed);
  CHECK(some.corners.size() > 4);
  for (const Corner& c : some.corners) {
    const int cx = static_cast<int>(c.x.x) / 8, cy = static_cast<int>(c.x.y) / 8;
    CHECK((cx > 3 && cx < 9 && cy != 4));
  }
  CHECK(find(p.view(), o, std::vector<std::uint8_t>(allowed.size(), 0)).corners.empty());
  CHECK(find(p.view(), o, std::vector<std::uint8_t>(allowed.size() + 1, 1)).status == Status::bad_argument);
}

TEST_CASE("equal corners are taken in reading order") {
  const Picture p = checkerboard(160, 160, 20);
  const Found f = find(p.view(), {}, {}, 12);
  REQUIRE(f.corners.size() == 12);
  for (std::size_t i = 1; i < f.corners.size(); ++i) {
    const Corner &a = f.corners[i - 1], &b = f.corners[i];
    CHECK((a.score > b.score || a.x.y < b.x.y || (a.x.y == b.x.y && a.x.x < b.x.x)));
  }
}

TEST_CASE("images without corners give none, unreadable ones a status") {
  CHECK(find(Picture(64, 48, 0).view(), {}).corners.empty());
  CHECK(find(Picture(64, 48, 255).view(), {}).corners.empty());
  for (int side = 1; side < 12; ++side) {
    const Found f = find(textured(side, side).view(), {});
    CHECK(f.status == Status::ok);
    if (side < 9) CHECK(f.corners.empty());
  }
  CHECK(find({nullptr, 64, 48, 64}, {}).status == Status::bad_argument);
  const Picture p = textured(64, 48);
  CHECK(find({p.pixels.data(), 64, 48, 63}, {}).status == Status::bad_argument);
  CornerOptions o;
  o.cell_px = 1;
  CHECK(find(p.view(), o).status == Status::bad_argument);
  o = {};
  o.min_distance_px = std::numeric_limits<float>::quiet_NaN();
  CHECK(find(p.view(), o).status == Status::bad_argument);
}

TEST_CASE("one pixel of noise is found, and nothing else") {
  Picture p(64, 48, 100);
  p.at(30, 20) = 180;
  const Found f = find(p.view(), {});
  REQUIRE(f.corners.size() == 1);
  CHECK(length(f.corners[0].x - Vec2{30, 20}) <= 4);
}

TEST_CASE("where grey levels do not change, or along one direction only, the score is 0") {
  Picture edge(40, 30);
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 40; ++x) edge.at(x, y) = x < 20 ? 60 : 200;
  for (int x = 4; x < 36; ++x) CHECK(corner_score(edge.view(), {static_cast<float>(x), 15}) == 0);
  CHECK(find(edge.view(), {}).corners.empty());
}

TEST_CASE("points near the border or outside, and NaN, score nothing") {
  const Picture p = textured(40, 30);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const Vec2 x :
       {Vec2{3, 15}, Vec2{36, 15}, Vec2{20, 3}, Vec2{20, 26}, Vec2{-5, 5}, Vec2{1e30f, 5}, Vec2{nan, 5}})
    CHECK(corner_score(p.view(), x) == 0);
  for (const Vec2 x : {Vec2{4, 4}, Vec2{35, 25}, Vec2{3.6f, 25.4f}}) CHECK(corner_score(p.view(), x) > 0);
}

TEST_CASE("what find_corners refuses takes no scratch") {
  const CornerOptions o;
  CHECK(corner_scratch_bytes(16384, 16384, o) > 0);
  for (const int side : {16385, 100'000, std::numeric_limits<int>::max(), 0, -1}) {
    CHECK(corner_scratch_bytes(side, 48, o) == 0);
    CHECK(corner_scratch_bytes(64, side, o) == 0);
  }
}

TEST_CASE("too little scratch is a status") {
  const Picture p = textured(64, 48);
  const CornerOptions o;
  AlignedBlock block(corner_scratch_bytes(64, 48, o));
  std::vector<Corner> out(10);
  int count = 77;
  Arena small(block.data(), block.size() - 16);
  CHECK(find_corners(p.view(), o, {}, small, {out.data(), 10}, count) == Status::out_of_memory);
  CHECK(count == 77);
  CHECK(small.used_bytes() == 0);
  Arena exact(block.data(), block.size());
  CHECK(find_corners(p.view(), o, {}, exact, {out.data(), 10}, count) == Status::ok);
  CHECK(count > 0);
}

}  // namespace corners_test
