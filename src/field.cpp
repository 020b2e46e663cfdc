// Sampling of vector fields on their grids (ALGORITHMS 3.2: bilinear, samples on the rims of the rectangle).
#include "pliant/field.hpp"

#include <cstring>

namespace pliant {

namespace {

/// Where (u,v) falls in a field's grid: cell and position within it; `inside` false outside the support.
struct Cell {
  std::size_t i, j;
  float a, b;
  bool inside;
};

Cell locate(const Field& f, Vec2 uv) {
  const float u = clamp(uv.x, 0, 1), v = clamp(uv.y, 0, 1);
  const float x = ((f.mirror ? 1 - u : u) - f.u0) * (static_cast<float>(f.width - 1) / (f.u1 - f.u0));
  const float y = (v - f.v0) * (static_cast<float>(f.height - 1) / (f.v1 - f.v0));
  const float w = static_cast<float>(f.width - 1), h = static_cast<float>(f.height - 1);
  if (!(x >= 0 && x <= w && y >= 0 && y <= h)) return {0, 0, 0, 0, false};
  const auto i = x >= w - 1 ? f.width - 2u : static_cast<std::size_t>(x);
  const auto j = y >= h - 1 ? f.height - 2u : static_cast<std::size_t>(y);
  return {i, j, x - static_cast<float>(i), y - static_cast<float>(j), true};
}

/// One component of the four samples around a cell, decoded to integers held as float.
struct Corners {
  float s00, s10, s01, s11;
  float at(const Cell& cell) const {
    const float top = s00 + cell.a * (s10 - s00), bottom = s01 + cell.a * (s11 - s01);
    return top + cell.b * (bottom - top);
  }
  float along_u(const Cell& cell) const { return (s10 - s00) + cell.b * ((s11 - s01) - (s10 - s00)); }
  float along_v(const Cell& cell) const { return (s01 - s00) + cell.a * ((s11 - s10) - (s01 - s00)); }
};

template <class Integer>
void read_corners(const std::uint8_t* samples, const Field& f, const Cell& cell, Corners (&out)[3]) {
  const std::size_t n = f.components, row = std::size_t{f.width} * n;
  const std::uint8_t* p = samples + f.first_byte + (cell.j * row + cell.i * n) * sizeof(Integer);
  const auto read = [p](std::size_t k) {
    Integer value;
    std::memcpy(&value, p + k * sizeof(Integer), sizeof value);
    return static_cast<float>(value);
  };
  for (std::size_t c = 0; c < n; ++c) out[c] = {read(c), read(n + c), read(row + c), read(row + n + c)};
}

Vec3 sample_cell(const Model& model, const Field& f, Vec2 uv, Vec3* du, Vec3* dv) {
  const Cell cell = locate(f, uv);
  if (du != nullptr) *du = *dv = {};
  if (!cell.inside) return {};
  Corners s[3] = {};
  if (f.bits == 16)
    read_corners<std::int16_t>(model.samples(), f, cell, s);
  else
    read_corners<std::int8_t>(model.samples(), f, cell, s);
  const bool flips = f.mirror && f.components == 3;
  const float sx = flips ? -f.scale[0] : f.scale[0], ox = flips ? -f.offset[0] : f.offset[0];
  if (du != nullptr) {
    const float per_u = static_cast<float>(f.width - 1) / (f.u1 - f.u0) * (f.mirror ? -1.0f : 1.0f);
    const float per_v = static_cast<float>(f.height - 1) / (f.v1 - f.v0);
    *du = {sx * s[0].along_u(cell) * per_u, f.scale[1] * s[1].along_u(cell) * per_u,
           f.scale[2] * s[2].along_u(cell) * per_u};
    *dv = {sx * s[0].along_v(cell) * per_v, f.scale[1] * s[1].along_v(cell) * per_v,
           f.scale[2] * s[2].along_v(cell) * per_v};
  }
  if (f.components == 1) return {f.offset[0] + f.scale[0] * s[0].at(cell), 0, 0};
  return {ox + sx * s[0].at(cell), f.offset[1] + f.scale[1] * s[1].at(cell),
          f.offset[2] + f.scale[2] * s[2].at(cell)};
}

}  // namespace

Vec3 sample(const Model& model, const Field& field, Vec2 uv) {
  return sample_cell(model, field, uv, nullptr, nullptr);
}

Vec3 sample_with_gradient(const Model& model, const Field& field, Vec2 uv, Vec3* du, Vec3* dv) {
  return sample_cell(model, field, uv, du, dv);
}

}  // namespace pliant
