#include "model/personal_field.hpp"

#include "model/field_lanes.hpp"
#include "model/field_sampling.hpp"

namespace pliant {

namespace {

constexpr std::uint16_t kMostSide = 256;
constexpr float kMostSteps = 32767;  // of an int16 sample
constexpr std::size_t kTogether = 64;  // samples of a row that are computed at once, on the stack

std::int16_t quantised(float value, float offset, float scale) {
  const float steps = scale > 0 ? clamp((value - offset) / scale, -kMostSteps, kMostSteps) : 0.0f;
  return static_cast<std::int16_t>(steps < 0 ? steps - 0.5f : steps + 0.5f);
}

}  // namespace

void PersonalField::lay_out(Arena& arena, const PersonalFieldLimits& limits) {
  limits_ = limits;
  const bool has_room =
      limits.width >= 2 && limits.height >= 2 && limits.width <= kMostSide && limits.height <= kMostSide;
  samples_ = has_room ? arena.take<std::int16_t>(std::size_t{3} * limits.width * limits.height) : nullptr;
}

void PersonalField::Range::include(Vec3 v) {
  const float c[3] = {v.x, v.y, v.z};
  for (int k = 0; k < 3; ++k) {
    low[k] = min(low[k], c[k]);
    high[k] = max(high[k], c[k]);
  }
}

Status PersonalField::fill(std::uint16_t root, const Vec3* largest, Compute compute, const void* state) {
  Range range;
  if (largest != nullptr) {
    if (!is_usable(*largest)) return Status::bad_argument;
    range.include(*largest);
    range.include(-1 * *largest);
  }
  Vec3 some[kTogether];
  for (int pass = largest != nullptr ? 1 : 0; pass < 2; ++pass) {
    if (pass == 1) set_range(range);
    for (std::size_t j = 0; j < limits_.height; ++j)
      for (std::size_t i = 0; i < limits_.width; i += kTogether) {
        const std::size_t left = limits_.width - i;
        const Span<Vec3> differences{some, left < kTogether ? left : kTogether};
        compute(state, i, j, differences);
        if (pass == 1) {
          set_samples(i, j, differences);
          continue;
        }
        for (const Vec3 d : differences) {
          if (!is_usable(d)) return Status::bad_argument;
          range.include(d);
        }
      }
  }
  root_ = root;
  return Status::ok;
}

void PersonalField::set_range(const Range& range) {
  field_ = {};
  field_.width = limits_.width;
  field_.height = limits_.height;
  field_.components = 3;
  field_.bits = 16;
  field_.u1 = field_.v1 = 1;
  for (int c = 0; c < 3; ++c) {
    field_.offset[c] = 0.5f * (range.low[c] + range.high[c]);
    field_.scale[c] = (range.high[c] - field_.offset[c]) / kMostSteps;
  }
}

/// Of nodes (i, j) and those that follow it.
void PersonalField::set_samples(std::size_t i, std::size_t j, Span<const Vec3> differences) {
  std::int16_t* const to = samples_ + 3 * (j * limits_.width + i);
  std::size_t n = 0;
#if PLIANT_HAS_VECTORS
  const float* const scale = field_.scale;
  if (scale[0] > 0 && scale[1] > 0 && scale[2] > 0) n = quantise_lanes(differences, field_, kMostSteps, to);
#endif
  for (; n < differences.count; ++n) {
    const float value[3] = {differences[n].x, differences[n].y, differences[n].z};
    for (std::size_t c = 0; c < 3; ++c) to[3 * n + c] = quantised(value[c], field_.offset[c], field_.scale[c]);
  }
}

void PersonalField::announce(const Model& model, Vec2 uv) const {
  prefetch_field(model.samples(), model.fields()[root_], uv);
  prefetch_field(reinterpret_cast<const std::uint8_t*>(samples_), field_, uv);
}

Vec3 PersonalField::sample(const Model& model, Vec2 uv, Interpolation interpolation, Vec3* du,
                           Vec3* dv) const {
  const Vec3 rest = sample_field(model.samples(), model.fields()[root_], uv, interpolation, du, dv);
  Vec3 added_u, added_v;
  const Vec3 added = sample_field(reinterpret_cast<const std::uint8_t*>(samples_), field_, uv, interpolation,
                                  du == nullptr ? nullptr : &added_u, &added_v);
  if (du != nullptr) {
    *du = *du + added_u;
    *dv = *dv + added_v;
  }
  return rest + added;
}

}  // namespace pliant
