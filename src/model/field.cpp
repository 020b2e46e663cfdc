// Sampling of fields on their grids (docs/algorithms.md, section 3.2): bilinear, or by cubic convolution (Keys 1981,
// a = -1/2). Samples lie on the rim of the rectangle too.
//
// A cubic cell at the rim lacks samples beyond it; they are computed from the others. On the border of the chart, by the
// parabola through three samples (Keys' condition, which keeps quadratics exact up to the border). On a rim inside the chart,
// beyond which the field is zero, by reflection, which makes the slope across the rim zero.
#include "pliant/field.hpp"

#include <cstring>

#include "base/integers.hpp"
#include "model/field_lanes.hpp"
#include "model/field_sampling.hpp"

namespace pliant {

namespace {

/// Where a point falls in a field's grid: cell and position within it.
struct Cell {
  std::size_t i, j;
  float a, b;
};

/// One axis of a field's grid.
struct GridAxis {
  float low, cells_per_unit;
  int last;  // cell

  GridAxis(float from, float to, int samples)
      : low(from), cells_per_unit(static_cast<float>(samples - 1) / (to - from)), last(samples - 2) {}
  /// The cell at `at`, which is within the field's support, and in `within` the position within it.
  std::size_t cell(float at, float* within) const {
    const float x = (at - low) * cells_per_unit;
    const int i = smaller(static_cast<int>(x), last);
    *within = x - static_cast<float>(i);
    return static_cast<std::size_t>(i);
  }
};

/// \pre is_in_support(f, at)
Cell locate(const Field& f, const ChartPoint& at) {
  Cell cell;
  cell.i = GridAxis(f.u0, f.u1, f.width).cell(f.mirror ? at.mirrored_u : at.u, &cell.a);
  cell.j = GridAxis(f.v0, f.v1, f.height).cell(at.v, &cell.b);
  return cell;
}

/// Interpolated integers of a field as floats, and, if wanted, their derivatives along both axes, per side of a cell.
struct Interpolated {
  bool with_gradient = false;
  float value[3] = {}, along_u[3] = {}, along_v[3] = {};
};

template <class Integer>
float read(const std::uint8_t* p) {
  Integer value;
  std::memcpy(&value, p, sizeof value);
  return static_cast<float>(value);
}

template <class Integer>
void interpolate_bilinear(const std::uint8_t* samples, const Field& f, const Cell& cell, Interpolated& out) {
  const std::size_t n = f.components, row = std::size_t{f.width} * n;
  const std::uint8_t* p = samples + f.first_byte + (cell.j * row + cell.i * n) * sizeof(Integer);
  for (std::size_t c = 0; c < n; ++c, p += sizeof(Integer)) {
    const float s00 = read<Integer>(p), s10 = read<Integer>(p + n * sizeof(Integer)),
                s01 = read<Integer>(p + row * sizeof(Integer)),
                s11 = read<Integer>(p + (row + n) * sizeof(Integer));
    const float top = s00 + cell.a * (s10 - s00), bottom = s01 + cell.a * (s11 - s01);
    out.value[c] = top + cell.b * (bottom - top);
    if (!out.with_gradient) continue;
    out.along_u[c] = (s10 - s00) + cell.b * ((s11 - s01) - (s10 - s00));
    out.along_v[c] = (s01 - s00) + cell.a * ((s11 - s10) - (s01 - s00));
  }
}

/// Four samples along one axis, their weights and the weights' derivatives.
struct CubicTaps {
  std::size_t at[4];
  float weight[4], slope[4];
};

/// A sample that is missing beyond the rim, as a combination of those at the rim, next to it, and opposite.
struct Beyond {
  float rim, next, opposite;
};
constexpr Beyond kReflection{0, 1, 0}, kLine{2, -1, 0}, kParabola{3, -3, 1};

/// \param first_is_rim  the first sample lies on a rim inside the chart; `last_is_rim` likewise.
CubicTaps cubic_taps(std::size_t cell, float a, std::size_t count, bool first_is_rim, bool last_is_rim) {
  const float a2 = a * a, a3 = a2 * a;
  CubicTaps t{{cell - 1, cell, cell + 1, cell + 2},
              {0.5f * (2 * a2 - a - a3), 0.5f * (3 * a3 - 5 * a2 + 2), 0.5f * (4 * a2 + a - 3 * a3),
               0.5f * (a3 - a2)},
              {0.5f * (4 * a - 1 - 3 * a2), 0.5f * (9 * a2 - 10 * a), 0.5f * (8 * a + 1 - 9 * a2),
               0.5f * (3 * a2 - 2 * a)}};
  // The weight of the missing sample moves to the others. Its tap becomes the opposite sample.
  const auto replace = [&](std::size_t missing, std::size_t rim, std::size_t next, std::size_t opposite,
                           bool is_rim) {
    const float w = t.weight[missing], s = t.slope[missing];
    const Beyond& by = is_rim ? kReflection : count == 2 ? kLine : kParabola;
    t.weight[rim] += by.rim * w;
    t.slope[rim] += by.rim * s;
    t.weight[next] += by.next * w;
    t.slope[next] += by.next * s;
    t.weight[missing] = by.opposite * w;
    t.slope[missing] = by.opposite * s;
    t.at[missing] = opposite;
  };
  // With two samples both ends are missing; the first replacement must not feed the second.
  const std::size_t after = cell + 2 < count ? cell + 2 : cell + 1, before = cell > 0 ? cell - 1 : cell;
  if (cell == 0) replace(0, 1, 2, after, first_is_rim);
  if (cell + 2 == count) replace(3, 2, 1, before, last_is_rim);
  return t;
}

/// One function for all kinds of samples: it is used less than the bilinear one, and has more code.
void interpolate_bicubic(const std::uint8_t* samples, const Field& f, const Cell& cell, Interpolated& out) {
  const std::size_t n = f.components, bytes = f.bits / 8u, row = f.width * n;
  const CubicTaps tu = cubic_taps(cell.i, cell.a, f.width, f.u0 > 0, f.u1 < 1);
  const CubicTaps tv = cubic_taps(cell.j, cell.b, f.height, f.v0 > 0, f.v1 < 1);
  for (std::size_t l = 0; l < 4; ++l) {
    float value[3] = {}, along[3] = {};
    const std::uint8_t* start = samples + f.first_byte + tv.at[l] * row * bytes;
    for (std::size_t k = 0; k < 4; ++k) {
      const std::uint8_t* p = start + tu.at[k] * n * bytes;
      for (std::size_t c = 0; c < n; ++c, p += bytes) {
        const float s = f.bits == 16 ? read<std::int16_t>(p) : read<std::int8_t>(p);
        value[c] += tu.weight[k] * s;
        along[c] += tu.slope[k] * s;
      }
    }
    for (std::size_t c = 0; c < n; ++c) {
      out.value[c] += tv.weight[l] * value[c];
      out.along_u[c] += tv.weight[l] * along[c];
      out.along_v[c] += tv.slope[l] * value[c];
    }
  }
}

/// Value alone of the most usual kind of field, vectors: the same bits in a third of the instructions.
template <class Integer>
Vec3 sample_vector(const std::uint8_t* samples, const Field& f, const Cell& cell) {
  constexpr std::size_t kNext = 3 * sizeof(Integer);
  const std::size_t row = kNext * f.width;
  const std::uint8_t* p = samples + f.first_byte + cell.j * row + cell.i * kNext;
  float value[3];
  for (std::size_t c = 0; c < 3; ++c, p += sizeof(Integer)) {
    const float s00 = read<Integer>(p), s10 = read<Integer>(p + kNext), s01 = read<Integer>(p + row),
                s11 = read<Integer>(p + row + kNext);
    const float top = s00 + cell.a * (s10 - s00), bottom = s01 + cell.a * (s11 - s01);
    value[c] = f.offset[c] + f.scale[c] * (top + cell.b * (bottom - top));
  }
  return {f.mirror ? -value[0] : value[0], value[1], value[2]};
}

#if PLIANT_HAS_VECTORS
LaneCorners corners_of(const std::uint8_t* samples, const Field& f, const Cell& cell) {
  return {f, samples + f.first_byte + 6 * (cell.j * f.width + cell.i)};
}

/// The same of two bytes a component.
Vec3 sample_words(const std::uint8_t* samples, const Field& f, const Cell& cell) {
  return lane_value(corners_of(samples, f, cell), f, cell.a, cell.b);
}
#else
Vec3 sample_words(const std::uint8_t* samples, const Field& f, const Cell& cell) {
  return sample_vector<std::int16_t>(samples, f, cell);
}
#endif

/// Cells per unit of u and v, the first negative for a mirrored field.
struct CellsPerUnit {
  float u, v;

  explicit CellsPerUnit(const Field& f)
      : u(static_cast<float>(f.width - 1) / (f.u1 - f.u0) * (f.mirror ? -1.0f : 1.0f)),
        v(static_cast<float>(f.height - 1) / (f.v1 - f.v0)) {}
};

/// Any field, any way. Of a copy of the cell: where this is not called, the cell stays in registers.
Vec3 sample_any(const std::uint8_t* samples, const Field& f, Cell cell, Interpolation interpolation, Vec3* du,
                Vec3* dv) {
  const auto bilinear = f.bits == 16 ? interpolate_bilinear<std::int16_t> : interpolate_bilinear<std::int8_t>;
  Interpolated s;
  s.with_gradient = du != nullptr;
  (interpolation == Interpolation::bicubic ? interpolate_bicubic : bilinear)(samples, f, cell, s);
  const bool flips = f.mirror && f.components == 3;
  const float sx = flips ? -f.scale[0] : f.scale[0], ox = flips ? -f.offset[0] : f.offset[0];
  if (du != nullptr) {
    const CellsPerUnit per(f);
    *du = {sx * s.along_u[0] * per.u, f.scale[1] * s.along_u[1] * per.u, f.scale[2] * s.along_u[2] * per.u};
    *dv = {sx * s.along_v[0] * per.v, f.scale[1] * s.along_v[1] * per.v, f.scale[2] * s.along_v[2] * per.v};
  }
  if (f.components == 1) return {f.offset[0] + f.scale[0] * s.value[0], 0, 0};
  return {ox + sx * s.value[0], f.offset[1] + f.scale[1] * s.value[1], f.offset[2] + f.scale[2] * s.value[2]};
}

/// Calls use(k, cell) for those of the first `count` points of a row that are in the field's support. \pre its v is
template <class Use>
void for_cells(const Field& f, const ChartRow& row, std::size_t count, const Use& use) {
  const GridAxis along_u(f.u0, f.u1, f.width);
  const float low = f.u0, high = f.u1;
  const bool is_mirrored = f.mirror;
  Cell cell;
  cell.j = GridAxis(f.v0, f.v1, f.height).cell(row.v, &cell.b);
  for (std::size_t k = 0; k < count; ++k) {
    const ChartPoint at({static_cast<float>(row.first + k) / static_cast<float>(row.steps), row.v});
    const float u = is_mirrored ? at.mirrored_u : at.u;
    if (u < low || u > high) continue;
    cell.i = along_u.cell(u, &cell.a);
    use(k, cell);
  }
}

}  // namespace

ChartPoint::ChartPoint(Vec2 uv) : u(clamp(uv.x, 0, 1)), mirrored_u(1 - u), v(clamp(uv.y, 0, 1)) {}

void prefetch_field(const std::uint8_t* samples, const Field& f, Vec2 uv) {
  const ChartPoint at(uv);
  if (!is_in_support(f, at)) return;
  const Cell cell = locate(f, at);
  const std::size_t bytes = f.bits / 8u * f.components, row = f.width * bytes;
  const std::uint8_t* const p = samples + f.first_byte + cell.j * row + cell.i * bytes;
  __builtin_prefetch(p);
  __builtin_prefetch(p + row);
}

Vec3 sample_in_support(const std::uint8_t* samples, const Field& f, const ChartPoint& at,
                       Interpolation interpolation) {
  const Cell cell = locate(f, at);
  if (interpolation == Interpolation::bilinear && f.components == 3)
    return f.bits == 16 ? sample_words(samples, f, cell) : sample_vector<std::int8_t>(samples, f, cell);
  return sample_any(samples, f, cell, interpolation, nullptr, nullptr);
}

Vec3 sample_at(const std::uint8_t* samples, const Field& f, const ChartPoint& at,
               Interpolation interpolation) {
  return is_in_support(f, at) ? sample_in_support(samples, f, at, interpolation) : Vec3{};
}

void add_row(const std::uint8_t* samples, const Field& f, float amount, const ChartRow& row,
             Interpolation interpolation, Span<Vec3> sums) {
  if (row.v < f.v0 || row.v > f.v1) return;
  const bool is_usual = interpolation == Interpolation::bilinear && f.components == 3 && f.bits == 16;
#if PLIANT_HAS_VECTORS
  if (is_usual) {
    // Of a mirrored field x has the other sign.
    const Lanes amounts{f.mirror ? -amount : amount, amount, amount, 0};
    const Lanes offset = first_three(f.offset), scale = first_three(f.scale);
    for_cells(f, row, sums.count, [&](std::size_t k, const Cell& cell) {
      const Lanes steps = lane_steps(corners_of(samples, f, cell), cell.a, splat(cell.b));
      const Lanes added = amounts * (offset + scale * steps);
      sums[k] = sums[k] + Vec3{added[0], added[1], added[2]};
    });
    return;
  }
#endif
  for_cells(f, row, sums.count, [&](std::size_t k, const Cell& cell) {
    sums[k] = sums[k] + amount * (is_usual ? sample_words(samples, f, cell)
                                           : sample_any(samples, f, cell, interpolation, nullptr, nullptr));
  });
}

Vec3 sample_field(const std::uint8_t* samples, const Field& f, Vec2 uv, Interpolation interpolation, Vec3* du,
                  Vec3* dv) {
  const ChartPoint at(uv);
  if (du == nullptr) return sample_at(samples, f, at, interpolation);
  *du = *dv = {};
  return is_in_support(f, at) ? sample_with_gradient(samples, f, at, interpolation, du, dv) : Vec3{};
}

Vec3 sample_with_gradient(const std::uint8_t* samples, const Field& f, const ChartPoint& at,
                          Interpolation interpolation, Vec3* du, Vec3* dv) {
  const Cell cell = locate(f, at);
#if PLIANT_HAS_VECTORS
  if (interpolation == Interpolation::bilinear && f.components == 3 && f.bits == 16) {
    const LaneCorners corners = corners_of(samples, f, cell);
    const CellsPerUnit per(f);
    lane_gradient(corners, f, cell.a, cell.b, per.u, per.v, du, dv);
    return lane_value(corners, f, cell.a, cell.b);
  }
#endif
  return sample_any(samples, f, cell, interpolation, du, dv);
}

Vec3 sample(const Model& model, const Field& field, Vec2 uv, Interpolation interpolation) {
  return sample_field(model.samples(), field, uv, interpolation, nullptr, nullptr);
}

Vec3 sample_with_gradient(const Model& model, const Field& field, Vec2 uv, Vec3* du, Vec3* dv,
                          Interpolation interpolation) {
  return sample_field(model.samples(), field, uv, interpolation, du, dv);
}

}  // namespace pliant
