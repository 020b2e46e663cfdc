#pragma once
// A sheet of paper as a small model table in memory: it rolls up to a cylinder, bends wrongly and stretches, each by a parameter of
// its own, and has springs.
#include <cstring>

#include "estimate/stretch_rows.hpp"
#include "model_builder.hpp"

namespace sheet {

using namespace pliant;

constexpr float kSheetSide = 100;   // mm
constexpr float kSpringSd = 0.01f;  // of a length
constexpr int kSpringGrid = 6;      // points a side
constexpr float kHalfArc = 0.8f;    // rad, half the arc of the roll at q = 1

struct Springs {
  std::vector<Vec2> points;
  std::vector<Spring> springs;

  /// Neighbours in a row, in a column and along the diagonal.
  static Springs of_sheet() {
    Springs s;
    for (int j = 0; j < kSpringGrid; ++j)
      for (int i = 0; i < kSpringGrid; ++i)
        s.points.push_back({0.1f + 0.16f * static_cast<float>(i), 0.1f + 0.16f * static_cast<float>(j)});
    const auto add = [&s](int i, int j, int to) {
      const auto a = static_cast<std::uint16_t>(j * kSpringGrid + i), b = static_cast<std::uint16_t>(to);
      const float rest = kSheetSide * length(s.points[b] - s.points[a]);
      s.springs.push_back({a, b, rest, kSpringSd * rest});
    };
    for (int j = 0; j < kSpringGrid; ++j)
      for (int i = 0; i < kSpringGrid; ++i) {
        if (i + 1 < kSpringGrid) add(i, j, j * kSpringGrid + i + 1);
        if (j + 1 < kSpringGrid) add(i, j, (j + 1) * kSpringGrid + i);
        if (i + 1 < kSpringGrid && j + 1 < kSpringGrid) add(i, j, (j + 1) * kSpringGrid + i + 1);
      }
    return s;
  }
  std::vector<unsigned char> bytes() const {
    const std::uint32_t count[2] = {static_cast<std::uint32_t>(points.size()),
                                    static_cast<std::uint32_t>(springs.size())};
    std::vector<unsigned char> out(sizeof count + 8 * points.size() + 12 * springs.size());
    std::memcpy(out.data(), count, sizeof count);
    std::memcpy(out.data() + sizeof count, points.data(), 8 * points.size());
    std::memcpy(out.data() + sizeof count + 8 * points.size(), springs.data(), 12 * springs.size());
    return out;
  }
};

/// x and z of the cylinder, at the arc's place s in -0.5 to 0.5, for a roll by q: its series to the second order.
inline Vec3 rise(float u, float) {
  const float s = u - 0.5f;
  return {0, 0, kHalfArc * kSheetSide * s * s};
}

inline Vec3 shortening(float u, float) {
  const float s = u - 0.5f;
  return {-kHalfArc * kHalfArc * kSheetSide * s * s * s * (2.0f / 3), 0, 0};
}

/// Parameters: roll, a bowl, which no paper can be, and stretch along u by 10 %.
inline ModelBuilder sheet_model(const std::vector<unsigned char>& springs, bool corrects = true) {
  ModelBuilder m;
  const std::uint16_t roll = m.parameter("roll", Group::expression, -2, 2, 1),
                      bowl = m.parameter("bowl", Group::expression, -2, 2, 1),
                      wide = m.parameter("wide", Group::expression, -2, 2, 1);
  m.record(Operation::constant, {}, {}, m.field(3, 2, 2, [](float u, float v) {
    return Vec3{kSheetSide * (u - 0.5f), kSheetSide * (0.5f - v), 0};
  }));
  m.record(Operation::add_vector, {m.last()}, {roll}, m.field(3, 65, 65, rise));
  m.record(Operation::add_vector, {m.last()}, {bowl},
           m.field(3, 65, 65, [](float u, float v) { return rise(u, v) + rise(v, u); }));
  m.record(Operation::add_vector, {m.last()}, {wide}, m.field(3, 2, 2, [](float u, float) {
    return Vec3{0.1f * kSheetSide * (u - 0.5f), 0, 0};
  }));
  if (corrects) m.record(Operation::product, {m.last()}, {roll, roll}, m.field(3, 65, 65, shortening));
  m.grid_mesh(4);
  for (int j = 0; j < 9; ++j)
    for (int i = 0; i < 9; ++i)
      m.landmark("p" + std::to_string(i) + std::to_string(j), 0.1f + 0.1f * static_cast<float>(i),
                 0.1f + 0.1f * static_cast<float>(j));
  m.stretch = springs;
  return m;
}

}  // namespace sheet
