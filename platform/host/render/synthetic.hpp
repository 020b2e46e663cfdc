#pragma once
/// \file synthetic.hpp
/// What drawn pictures are made of: light on a surface, images over a chart, smooth and normal noise. Without the host library, so
/// that tests draw with it on every target.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "pliant/geometry.hpp"

namespace pliant::host {

/// A well-mixed 32-bit number from two.
inline std::uint32_t hash(std::uint32_t a, std::uint32_t b) {
  std::uint32_t h = a * 0x9e3779b1u ^ (b + 0x85ebca6bu) * 0xc2b2ae35u;
  h = (h ^ h >> 15) * 0x2c1b3c6du;
  h = (h ^ h >> 12) * 0x297a2d39u;
  return h ^ h >> 15;
}

/// In [0,1), from random bits.
inline float uniform(std::uint32_t bits) {
  return static_cast<float>(bits >> 8) * (1.0f / 16777216.0f);
}

/// Smooth noise in [0,1] with one random value at each corner of the unit grid. |x| and |y| below 2^31.
inline float value_noise(float x, float y, std::uint32_t seed) {
  const auto rounded_down = [](float t) {
    const int i = static_cast<int>(t);
    return static_cast<float>(i) > t ? i - 1 : i;
  };
  const int i = rounded_down(x), j = rounded_down(y);
  const std::uint32_t left = hash(static_cast<std::uint32_t>(i), seed),
                      right = hash(static_cast<std::uint32_t>(i + 1), seed);
  const auto corner = [&](std::uint32_t column, int b) {
    return uniform(hash(column, static_cast<std::uint32_t>(b)));
  };
  const auto ease = [](float t) { return t * t * (3 - 2 * t); };
  const float fx = ease(x - static_cast<float>(i)), fy = ease(y - static_cast<float>(j));
  const float top = corner(left, j) * (1 - fx) + corner(right, j) * fx;
  return top * (1 - fy) + (corner(left, j + 1) * (1 - fx) + corner(right, j + 1) * fx) * fy;
}

/// Grey value, 45 to 135, of a soft, blotchy backdrop at a pixel; another one for each seed.
/// \param side  the picture's longer side, px.
inline float backdrop_grey(int x, int y, int side, std::uint32_t seed) {
  const float unit = 6.0f / static_cast<float>(side);
  const float u = static_cast<float>(x) * unit, v = static_cast<float>(y) * unit;
  const float blotches = 0.6f * value_noise(u, v, seed) + 0.3f * value_noise(3 * u, 3 * v, seed + 1) +
                         0.1f * value_noise(11 * u, 11 * v, seed + 2);
  return 45 + 90 * blotches;
}

/// Adds normal noise of `sd` grey levels to pixels of `channels` bytes, the same to each of their channels. Equal seeds give equal
/// noise.
inline void add_normal_noise(std::vector<std::uint8_t>& bytes, std::size_t channels, float sd,
                             std::uint32_t seed) {
  const std::size_t count = bytes.size() / channels;
  for (std::size_t i = 0; i < count; i += 2) {
    // Box and Muller: two uniform numbers give two normal ones.
    const auto k = static_cast<std::uint32_t>(i);
    const float u = uniform(hash(seed, k)) + 1.0f / 33554432.0f,
                angle = 6.2831853f * uniform(hash(seed, k + 1));
    const float radius = sd * std::sqrt(-2 * std::log(u));
    const float noise[2] = {radius * std::cos(angle), radius * std::sin(angle)};
    for (std::size_t n = 0; n < 2 && i + n < count; ++n)
      for (std::size_t c = 0; c < channels; ++c) {
        std::uint8_t& value = bytes[(i + n) * channels + c];
        value = static_cast<std::uint8_t>(clamp(static_cast<float>(value) + noise[n] + 0.5f, 0, 255));
      }
  }
}

/// Brightness of a surface with unit normal n (camera axes: x right, y down, z away): a key light from the upper left that reaches
/// a little round the shadow side, so that this still shows its shape, a weak one from the right, and light from everywhere.
inline float light_on(Vec3 n) {
  static const Vec3 key = normalised(Vec3{-0.55f, -0.65f, -0.85f}),
                    fill = normalised(Vec3{0.8f, 0.1f, -0.6f});
  return 0.22f + 0.78f * max(0.0f, (dot(n, key) + 0.2f) / 1.2f) + 0.16f * max(0.0f, dot(n, fill));
}

/// Bilinear value of an image over the chart, whose first and last pixels lie at 0 and 1.
inline float chart_value(const std::uint8_t* pixels, std::uint32_t width, std::uint32_t height, Vec2 uv) {
  const float x = clamp(uv.x, 0, 1) * static_cast<float>(width - 1),
              y = clamp(uv.y, 0, 1) * static_cast<float>(height - 1);
  const auto i = static_cast<std::uint32_t>(x), j = static_cast<std::uint32_t>(y);
  const std::uint32_t i1 = i + 1 < width ? i + 1 : i, j1 = j + 1 < height ? j + 1 : j;
  const float fx = x - static_cast<float>(i), fy = y - static_cast<float>(j);
  const auto at = [&](std::uint32_t a, std::uint32_t b) {
    return static_cast<float>(pixels[std::size_t{b} * width + a]);
  };
  const float top = at(i, j) * (1 - fx) + at(i1, j) * fx;
  return top * (1 - fy) + (at(i, j1) * (1 - fx) + at(i1, j1) * fx) * fy;
}

/// Zeros of a mask that are joined to its border become 0, all other pixels, holes among them, 1.
inline std::vector<std::uint8_t> without_holes(const std::uint8_t* mask, int width, int height) {
  const auto index = [width](int x, int y) { return static_cast<std::size_t>(y * width + x); };
  std::vector<std::uint8_t> result(index(0, height), 1);
  std::vector<std::size_t> pending;
  const auto visit = [&](int x, int y) {
    if (x < 0 || y < 0 || x >= width || y >= height) return;
    const std::size_t k = index(x, y);
    if (mask[k] != 0 || result[k] == 0) return;
    result[k] = 0;
    pending.push_back(k);
  };
  for (int x = 0; x < width; ++x) visit(x, 0), visit(x, height - 1);
  for (int y = 0; y < height; ++y) visit(0, y), visit(width - 1, y);
  while (!pending.empty()) {
    const int x = static_cast<int>(pending.back()) % width, y = static_cast<int>(pending.back()) / width;
    pending.pop_back();
    visit(x - 1, y), visit(x + 1, y), visit(x, y - 1), visit(x, y + 1);
  }
  return result;
}

/// Mean over 5 x 5 pixels, from 0 to 255, of a picture of 0 and 1. Its contour at 1/2 is the boundary without the steps.
inline std::vector<std::uint8_t> smooth_cover(const std::vector<std::uint8_t>& inside, int width,
                                              int height) {
  std::vector<std::uint8_t> out(inside.size());
  const auto limited = [](int x, int size) { return x < 0 ? 0 : x < size ? x : size - 1; };
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      int sum = 0;
      for (int j = -2; j <= 2; ++j)
        for (int i = -2; i <= 2; ++i)
          sum += inside[static_cast<std::size_t>(limited(y + j, height) * width + limited(x + i, width))];
      out[static_cast<std::size_t>(y * width + x)] = static_cast<std::uint8_t>(sum * 255 / 25);
    }
  return out;
}

}  // namespace pliant::host
