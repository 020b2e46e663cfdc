// A personal field of 128 x 128 samples is the sum of 28 fields at 16,384 nodes, twice: once for its range. Sampled one point
// after the other that took 191 million instructions of a start, of which most were spent on where a point lies in a grid that
// has a sample there.
#include "model/vector_sum.hpp"

#include <cstring>

#include "base/integers.hpp"
#include "model/field_lanes.hpp"
#include "model/field_sampling.hpp"

namespace pliant {

namespace {

/// Distance from a node up to which a field's sample is that of the node, nodes. Rounding of the fields' corners; round value.
constexpr float kMostOff = 1e-3f;

/// The node at which a field's support begins along one axis.
std::size_t first_node(float low, std::size_t nodes) {
  return static_cast<std::size_t>(low * static_cast<float>(nodes - 1) + 0.5f);
}

bool lies_at_nodes(float low, float high, std::size_t samples, std::size_t nodes) {
  const auto steps = static_cast<float>(nodes - 1), first = static_cast<float>(first_node(low, nodes));
  return magnitude(low * steps - first) < kMostOff &&
         magnitude(high * steps - first - static_cast<float>(samples - 1)) < kMostOff;
}

}  // namespace

bool VectorSum::has_samples_at_nodes(const Field& f) const {
  return !f.mirror && f.bits == 16 && f.components == 3 && lies_at_nodes(f.u0, f.u1, f.width, width_) &&
         lies_at_nodes(f.v0, f.v1, f.height, height_);
}

/// False where the field is zero at the nodes (first, j) to (last, j).
bool VectorSum::overlaps(const Field& f, std::size_t first, std::size_t last, std::size_t j) const {
  constexpr float kMargin = 0.5f;  // nodes: a corner may be rounded
  const float across = static_cast<float>(width_ - 1), down = static_cast<float>(height_ - 1);
  const float low_u = f.mirror ? 1 - f.u1 : f.u0, high_u = f.mirror ? 1 - f.u0 : f.u1;
  return static_cast<float>(j) > f.v0 * down - kMargin && static_cast<float>(j) < f.v1 * down + kMargin &&
         static_cast<float>(last) > low_u * across - kMargin &&
         static_cast<float>(first) < high_u * across + kMargin;
}

bool VectorSum::applies() const {
  const auto cascade = model_.cascade();
  for (std::size_t n = 0; n < records_.count; ++n) {
    const CascadeRecord& r = cascade[records_[n]];
    // Records between two of the list have no effect: the second adds to the value of the first.
    if (r.operation != (n == 0 ? Operation::constant : Operation::add_vector)) return false;
  }
  return true;
}

Vec3 VectorSum::largest() const {
  float most[3] = {};
  for (std::size_t n = 1; n < records_.count; ++n) {
    const CascadeRecord& r = model_.cascade()[records_[n]];
    const Field& f = model_.fields()[r.field];
    const float amount = magnitude(q_[r.parameter[0]]);
    for (int c = 0; c < 3; ++c) most[c] += amount * largest_value(f, c);
  }
  return {most[0], most[1], most[2]};
}

void VectorSum::compute(std::size_t first, std::size_t j, Interpolation interpolation, Span<Vec3> out) const {
  const ChartRow row{static_cast<float>(j) / static_cast<float>(height_ - 1), first, width_ - 1};
  for (Vec3& sum : out) sum = {};
  for (std::size_t n = 1; n < records_.count; ++n) {
    const CascadeRecord& r = model_.cascade()[records_[n]];
    const Field& field = model_.fields()[r.field];
    const float amount = q_[r.parameter[0]];
    if (!overlaps(field, first, first + out.count - 1, j)) continue;
    if (has_samples_at_nodes(field))
      add_samples(field, amount, first, j, out);
    else
      add_row(model_.samples(), field, amount, row, interpolation, out);
  }
}

void VectorSum::add_samples(const Field& f, float amount, std::size_t first, std::size_t j,
                            Span<Vec3> out) const {
  const std::size_t i0 = first_node(f.u0, width_), j0 = first_node(f.v0, height_);
  const std::size_t begin = larger(first, i0), out_end = first + out.count, end = i0 + f.width;
  if (j < j0 || j >= j0 + f.height || begin >= out_end || begin >= end) return;
  const std::uint8_t* samples = model_.samples() + f.first_byte + 6 * ((j - j0) * f.width + (begin - i0));
  const Vec3 offset = amount * Vec3{f.offset[0], f.offset[1], f.offset[2]},
             scale = amount * Vec3{f.scale[0], f.scale[1], f.scale[2]};
  Vec3* const to = out.data + (begin - first);
  const std::size_t count = smaller(end, out_end) - begin;
  std::size_t k = 0;
#if PLIANT_HAS_VECTORS
  k = add_lanes(samples, count, scale, offset, to);
#endif
  for (samples += 6 * k; k < count; ++k, samples += 6) {
    std::int16_t s[3];
    std::memcpy(s, samples, sizeof s);
    to[k] = to[k] + Vec3{offset.x + scale.x * static_cast<float>(s[0]),
                         offset.y + scale.y * static_cast<float>(s[1]),
                         offset.z + scale.z * static_cast<float>(s[2])};
  }
}

}  // namespace pliant
