// The cascade from its tables: baking a point, positions and tangents at any (u,v), and a person's folded neutral
// (ALGORITHMS 3.4).
#include "model/field_sampling.hpp"
#include "model/field_step.hpp"
#include "pliant/cascade.hpp"

namespace pliant {

namespace {

/// Smallest and largest of what was seen, a component.
struct Range {
  float low[3] = {1e30f, 1e30f, 1e30f}, high[3] = {-1e30f, -1e30f, -1e30f};
  void include(Vec3 v) {
    const float c[3] = {v.x, v.y, v.z};
    for (int k = 0; k < 3; ++k) {
      low[k] = min(low[k], c[k]);
      high[k] = max(high[k], c[k]);
    }
  }
};

std::int16_t quantised(float value, float offset, float scale) {
  const float steps = scale > 0 ? clamp((value - offset) / scale, -32767, 32767) : 0.0f;
  return static_cast<std::int16_t>(steps < 0 ? steps - 0.5f : steps + 0.5f);
}

/// No component of a field's vectors is larger.
float largest_component(const Field& f) {
  const float steps = f.bits == 16 ? 32768.0f : 128.0f;
  float largest = 0;
  for (int k = 0; k < 3; ++k) largest = max(largest, magnitude(f.offset[k]) + steps * magnitude(f.scale[k]));
  return largest;
}

}  // namespace

Vec3 Cascade::point_of_source(const CascadeRecord& r, int k) const {
  return r.source[k] == kNone ? Vec3{} : point_[r.source[k]];
}

/// A record's own sample; zero when it has none.
Vec3 Cascade::record_sample(std::size_t record, Vec2 uv, Vec3* du, Vec3* dv) const {
  const CascadeRecord& r = model_.cascade()[record];
  const std::uint16_t field = r.field != kNone ? r.field : r.weight;
  if (du != nullptr) *du = *dv = {};
  return field == kNone ? Vec3{}
                        : sample_field(model_.samples(), model_.fields()[field], uv, interpolation_, du, dv);
}

/// The constant that a record's first sources lead back to.
std::uint16_t Cascade::root_field(std::size_t record) const {
  const auto records = model_.cascade();
  while (records[record].source[0] != kNone) record = records[record].source[0];
  return records[record].field;
}

/// The folded neutral: its root as the table has it, and what the fold added.
Vec3 Cascade::neutral_sample(Vec2 uv, Vec3* du, Vec3* dv) const {
  const Field& root = model_.fields()[root_field(neutral_)];
  const Vec3 rest = sample_field(model_.samples(), root, uv, interpolation_, du, dv);
  Vec3 added_u, added_v;
  const Vec3 added = sample_field(reinterpret_cast<const std::uint8_t*>(neutral_samples_), neutral_field_, uv,
                                  interpolation_, du == nullptr ? nullptr : &added_u, &added_v);
  if (du != nullptr) {
    *du = *du + added_u;
    *dv = *dv + added_v;
  }
  return rest + added;
}

void Cascade::set_interpolation(Interpolation interpolation) {
  interpolation_ = interpolation;
  forget_person();
}

void Cascade::sample_point(Vec2 uv, const float* q, Vec3* baked, float slack_mm) {
  Vec3* const first = baked;
  for (std::size_t n = 0; n < visited_count_; ++n) {
    const std::size_t i = visited_[n];
    if (is_live(i)) {
      *baked++ = record_sample(i, uv, nullptr, nullptr);
      continue;
    }
    const CascadeRecord& r = model_.cascade()[i];
    point_[i] = i == neutral_ ? neutral_sample(uv, nullptr, nullptr)
                              : applied(r, q, point_of_source(r, 0), point_of_source(r, 1),
                                        record_sample(i, uv, nullptr, nullptr));
    if (role_[i] == Role::folded) *baked++ = point_[i];
  }
  compact(first, slack_mm);
}

Vec3 Cascade::surface_point(Vec2 uv, const float* q) {
  select(q);
  return selected_point(uv);
}

void Cascade::select(const float* q, float slack_mm) {
  const auto records = model_.cascade();
  selected_q_ = q;
  selected_count_ = 0;
  for (std::size_t n = 0; n < visited_count_; ++n) {
    const std::uint16_t i = visited_[n];
    const CascadeRecord& r = records[i];
    const bool does_nothing =
        i != neutral_ &&
        (passes_through(r, q) ||
         (r.operation == Operation::add_vector &&
          magnitude(q[r.parameter[0]]) * largest_component(model_.fields()[r.field]) < slack_mm));
    stands_for_[i] = does_nothing ? stands_for_[records[i].source[0]] : i;
    if (!does_nothing) selected_[selected_count_++] = i;
  }
}

Vec3 Cascade::selected_point(Vec2 uv) {
  for (std::size_t k = 0; k < selected_count_; ++k) {
    const std::size_t i = selected_[k];
    if (i == neutral_) {
      point_[i] = neutral_sample(uv, nullptr, nullptr);
      continue;
    }
    const CascadeRecord& r = model_.cascade()[i];
    const Vec3 p0 = r.source[0] == kNone ? Vec3{} : point_[stands_for_[r.source[0]]];
    const Vec3 p1 = r.source[1] == kNone ? Vec3{} : point_[stands_for_[r.source[1]]];
    const Vec3 s = record_sample(i, uv, nullptr, nullptr);
    point_[i] = r.operation == Operation::add_vector ? p0 + selected_q_[r.parameter[0]] * s
                : r.operation == Operation::constant ? s
                                                     : applied(r, selected_q_, p0, p1, s);
  }
  return point_[stands_for_[result_]];
}

SurfaceFrame Cascade::surface_frame(Vec2 uv, const float* q) {
  select(q);
  return selected_frame(uv);
}

SurfaceFrame Cascade::selected_frame(Vec2 uv) {
  for (std::size_t n = 0; n < selected_count_; ++n) {
    const std::size_t i = selected_[n];
    if (i == neutral_) {
      point_[i] = neutral_sample(uv, &tangent_u_[i], &tangent_v_[i]);
      continue;
    }
    const CascadeRecord& r = model_.cascade()[i];
    const std::size_t first = r.source[0] == kNone ? kNone : stands_for_[r.source[0]];
    const std::size_t second = r.source[1] == kNone ? kNone : stands_for_[r.source[1]];
    Vec3 su, sv;
    const Vec3 s = record_sample(i, uv, &su, &sv);
    if (r.operation == Operation::add_vector) {
      const float amount = selected_q_[r.parameter[0]];
      point_[i] = point_[first] + amount * s;
      tangent_u_[i] = tangent_u_[first] + amount * su;
      tangent_v_[i] = tangent_v_[first] + amount * sv;
      continue;
    }
    const FieldStep f = apply(r, selected_q_, first == kNone ? Vec3{} : point_[first],
                              second == kNone ? Vec3{} : point_[second], s);
    const auto carry = [&](const Vec3* tangent, Vec3 along) {
      Vec3 t;
      if (first != kNone) t = f.maps ? f.map * tangent[first] : f.keep * tangent[first];
      if (second != kNone) t = t + f.keep_second * tangent[second];
      return r.field != kNone ? t + f.along_field * along : t + along.x * f.along_weight;
    };
    point_[i] = f.p;
    tangent_u_[i] = carry(tangent_u_, su);
    tangent_v_[i] = carry(tangent_v_, sv);
  }
  const std::size_t last = stands_for_[result_];
  return {point_[last], tangent_u_[last], tangent_v_[last]};
}

/// The part of a baked point whose folding saves most samples, or kNone when none saves any.
std::uint16_t Cascade::find_neutral() {
  const auto records = model_.cascade();
  std::uint16_t best = kNone;
  std::size_t least = sample_count();
  for (std::size_t i = 0; i < records.count; ++i) {
    if (role_[i] != Role::folded) continue;
    neutral_ = static_cast<std::uint16_t>(i);
    mark_needed(records.count - 1);
    if (sample_count() >= least) continue;
    least = sample_count();
    best = neutral_;
  }
  neutral_ = kNone;
  return best;
}

/// Samples what `record` adds to its root: once for the range, once for the samples.
Status Cascade::fill_neutral(std::size_t record, const float* q) {
  const std::size_t width = personal_limits_.width, height = personal_limits_.height;
  const Field& root = model_.fields()[root_field(record)];
  mark_needed(record);
  select(q);
  const auto added_at = [&](std::size_t i, std::size_t j) {
    const Vec2 uv{static_cast<float>(i) / static_cast<float>(width - 1),
                  static_cast<float>(j) / static_cast<float>(height - 1)};
    return selected_point(uv) - sample(model_, root, uv, interpolation_);
  };
  Range range;
  for (std::size_t j = 0; j < height; ++j)
    for (std::size_t i = 0; i < width; ++i) {
      const Vec3 added = added_at(i, j);
      if (!is_finite(added) || dot(added, added) > 1e18f) return Status::bad_argument;
      range.include(added);
    }
  Field& f = neutral_field_;
  f = {};
  f.width = personal_limits_.width;
  f.height = personal_limits_.height;
  f.components = 3;
  f.bits = 16;
  f.u1 = f.v1 = 1;
  for (int c = 0; c < 3; ++c) {
    f.offset[c] = 0.5f * (range.low[c] + range.high[c]);
    f.scale[c] = (range.high[c] - f.offset[c]) / 32767;
  }
  std::int16_t* out = neutral_samples_;
  for (std::size_t j = 0; j < height; ++j)
    for (std::size_t i = 0; i < width; ++i) {
      const Vec3 added = added_at(i, j);
      const float value[3] = {added.x, added.y, added.z};
      for (int c = 0; c < 3; ++c) *out++ = quantised(value[c], f.offset[c], f.scale[c]);
    }
  return Status::ok;
}

Status Cascade::personalise(const float* q) {
  if (neutral_samples_ == nullptr) return Status::capacity;
  if (q == nullptr) return Status::bad_argument;
  forget_person();
  const std::uint16_t record = find_neutral();
  const Status status = record == kNone ? Status::ok : fill_neutral(record, q);
  if (status == Status::ok) neutral_ = record;
  plan();
  return status;
}

}  // namespace pliant
