#include "vision/gradient_directions.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "texture.hpp"
#include "vision/resampled_frame.hpp"

using namespace pliant;
using texture::Picture;

namespace {

struct Filter {
  std::vector<std::uint8_t> block = std::vector<std::uint8_t>(1 << 16);
  Arena arena{block.data(), block.size()};
  GradientDirectionFilter filter;
  Filter(int width, int height) { filter.lay_out(arena, width * height, width); }
};

std::vector<GradientDirection> directions_of(const Picture& p, int reach) {
  Filter f(p.width, p.height);
  std::vector<GradientDirection> out(p.pixels.size());
  f.filter.compute(p.view(), reach, out.data());
  return out;
}

Picture textured() {
  return render(texture::Texture(5), {}, 60, 44);
}

}  // namespace

TEST_CASE(
    "directions point to where grey levels rise, are bounded, and are zero on even grey and along the "
    "border") {
  Picture step(32, 32, 60);
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 16; ++x) step.at(x, y) = 160;
  const auto d = directions_of(step, 4);
  const GradientDirection edge = d[16 * 32 + 15];
  CHECK(edge.x < -20);
  CHECK(edge.y == 0);
  CHECK(d[16 * 32 + 4].x == 0);
  for (const GradientDirection& g : directions_of(textured(), 3)) CHECK(dot(g, g) <= 127 * 127);
  const auto t = directions_of(textured(), 3);
  for (std::size_t x = 0; x < 60; ++x) CHECK(dot(t[x], t[x]) + dot(t[43 * 60 + x], t[43 * 60 + x]) == 0);
}

TEST_CASE("a gain and a bias of the light change directions little") {
  const Picture p = textured();
  Picture darker = p;
  for (auto& v : darker.pixels) v = static_cast<std::uint8_t>(0.6 * v + 30.5);
  const auto a = directions_of(p, 5), b = directions_of(darker, 5);
  double ab = 0, aa = 0, bb = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    ab += dot(a[k], b[k]);
    aa += dot(a[k], a[k]);
    bb += dot(b[k], b[k]);
  }
  CHECK(ab / std::sqrt(aa * bb) > 0.98);
}

TEST_CASE("the energy table gives the sum of squares over any rectangle") {
  const auto d = directions_of(textured(), 3);
  std::vector<std::uint8_t> block(61 * 45 * 4 + 16);
  Arena arena(block.data(), block.size());
  EnergyTable table;
  table.lay_out(arena, 60, 44);
  table.build(d.data(), 60, 44);
  const int boxes[][4] = {{0, 0, 60, 44}, {5, 7, 6, 8}, {10, 3, 42, 31}, {20, 20, 20, 40}};
  for (const auto& box : boxes) {
    std::uint32_t sum = 0;
    for (int y = box[1]; y < box[3]; ++y)
      for (int x = box[0]; x < box[2]; ++x) {
        const GradientDirection g = d[static_cast<std::size_t>(y * 60 + x)];
        sum += static_cast<std::uint32_t>(dot(g, g));
      }
    CHECK(table.sum(box[0], box[1], box[2], box[3]) == sum);
  }
}

TEST_CASE(
    "a resampled frame is the frame at ratio one, its pyramid at smaller ones, and its border beyond it") {
  const Picture p = textured();
  std::vector<std::uint8_t> block(1 << 14);
  Arena arena(block.data(), block.size());
  Pyramid pyramid;
  REQUIRE(pyramid.create(arena, {60, 44, 3, true}) == Status::ok);
  REQUIRE(pyramid.build(p.frame()) == Status::ok);
  const ResampledFrame full(pyramid, 1), quarter(pyramid, 0.25f);
  for (int y = 0; y < 44; y += 4)
    for (int x = 0; x < 60; x += 4) {
      const Vec2 at{static_cast<float>(x), static_cast<float>(y)};
      CHECK(full.grey(at) == p.pixels[static_cast<std::size_t>(y * 60 + x)]);
      CHECK(quarter.grey(at) == pyramid.level(2).data[y / 4 * pyramid.level(2).stride + x / 4]);
    }
  CHECK(full.grey({-5, 1e9f}) == p.pixels[43 * 60]);
  CHECK(full.grey({NAN, NAN}) == p.pixels[0]);
  const float between = 0.5f * static_cast<float>(p.pixels[10 * 60 + 10] + p.pixels[10 * 60 + 11]);
  CHECK(std::abs(static_cast<float>(full.grey({10.5f, 10})) - between) <= 0.5f);
}
