#include "estimate/stretch_rows.hpp"

#include <cstring>

#include "model/chart.hpp"

namespace pliant {

namespace {

static_assert(sizeof(Spring) == 12, "file format");

/// Limits of the format. They bound memory and time.
constexpr std::uint32_t kMostPoints = 256, kMostSprings = 1024;
/// Shortest length and smallest standard deviation, mm: both divide.
constexpr float kLeast = 1e-6f, kMost = 1e6f;
/// Length below which a spring has no direction, as a fraction of its rest length: it adds no row there.
constexpr float kNoDirection = 1e-3f;

bool is_sound(const Spring& s, std::size_t points) {
  return s.first < s.second && s.second < points && s.length_mm >= kLeast && s.length_mm <= kMost &&
         s.sd_mm >= kLeast && s.sd_mm <= kMost;
}

}  // namespace

Status SpringTable::open(Span<const std::uint8_t> section, SpringTable* table) {
  *table = {};
  if (section.empty()) return Status::ok;
  std::uint32_t count[2] = {};
  if (section.count >= sizeof count) std::memcpy(count, section.data, sizeof count);
  const std::uint32_t points = count[0], springs = count[1];
  if (points < 2 || points > kMostPoints || springs < 1 || springs > kMostSprings ||
      section.count != sizeof count + points * sizeof(Vec2) + springs * sizeof(Spring))
    return Status::bad_table;
  // Sections are aligned to 4 bytes, as these records are.
  const std::uint8_t* const first = section.data + sizeof count;
  const SpringTable found{
      {static_cast<const Vec2*>(static_cast<const void*>(first)), points},
      {static_cast<const Spring*>(static_cast<const void*>(first + points * sizeof(Vec2))), springs}};
  for (const Vec2& uv : found.points)
    if (!is_in_chart(uv)) return Status::bad_table;
  for (const Spring& s : found.springs)
    if (!is_sound(s, points)) return Status::bad_table;
  *table = found;
  return Status::ok;
}

void StretchRows::lay_out(Arena& arena, const Model& model, std::size_t samples) {
  status_ = SpringTable::open(model.stretch(), &table_);
  stride_ = samples;
  const std::size_t parameters = model.parameters().count, points = table_.points.count;
  samples_ = arena.take<Vec3>(points * samples);
  position_ = arena.take<Vec3>(points);
  column_ = arena.take<Vec3>(points * parameters);
  row_ = arena.take<Vec2>(parameters);
  unknown_ = arena.take<std::uint16_t>(parameters);
}

Status StretchRows::start(Cascade& cascade, const float* q) {
  PLIANT_ASSERT(cascade.samples_per_point() <= stride_);
  for (std::size_t k = 0; k < table_.points.count; ++k)
    cascade.sample_point(table_.points[k], q, samples_ + k * stride_);
  return status_;
}

float StretchRows::cost(Cascade& cascade, const float* q) {
  for (std::size_t k = 0; k < table_.points.count; ++k)
    position_[k] = cascade.evaluate(samples_ + k * stride_, q);
  float sum = 0;
  for (const Spring& s : table_.springs) {
    const float off = (s.length_mm - length(position_[s.first] - position_[s.second])) / s.sd_mm;
    sum += 0.5f * off * off;
  }
  return sum;
}

void StretchRows::add(Cascade& cascade, const float* q, std::size_t first_unknown,
                      NormalEquations& equations) {
  const std::size_t columns = cascade.column_count();
  for (std::size_t k = 0; k < table_.points.count; ++k) {
    Jacobian jacobian;
    position_[k] = cascade.evaluate(samples_ + k * stride_, q, &jacobian);
    Vec3* const column = column_ + k * columns;
    for (std::size_t c = 0; c < columns; ++c) column[c] = {};
    for (std::size_t c = 0; c < jacobian.count; ++c)
      column[jacobian.list[c]] = jacobian.column[jacobian.list[c]];
  }
  for (std::size_t c = 0; c < columns; ++c) unknown_[c] = static_cast<std::uint16_t>(first_unknown + c);
  for (const Spring& s : table_.springs) {
    const Vec3 d = position_[s.first] - position_[s.second];
    const float now = length(d);
    if (!(now > kNoDirection * s.length_mm)) continue;
    const Vec3 direction = (1.0f / now) * d;
    const Vec3 *const a = column_ + s.first * columns, *const b = column_ + s.second * columns;
    for (std::size_t c = 0; c < columns; ++c) row_[c] = {dot(direction, a[c] - b[c]), 0};
    equations.add(unknown_, row_, columns, {s.length_mm - now, 0}, {1.0f / (s.sd_mm * s.sd_mm), 0, 0});
  }
}

namespace {

StretchRows* lay_out(Arena& arena, const Model& model, std::size_t samples) {
  return model.stretch().empty() ? nullptr : create_part<StretchRows>(arena, model, samples);
}

std::size_t work_rows(const Model& model) {
  SpringTable table;
  return SpringTable::open(model.stretch(), &table) == Status::ok ? kRowsASpring * table.springs.count : 0;
}

Status start(StretchRows& rows, Cascade& cascade, const float* q) {
  return rows.start(cascade, q);
}

float apply(StretchRows& rows, Cascade& cascade, const float* q, NormalEquations* equations) {
  if (equations == nullptr) return rows.cost(cascade, q);
  rows.add(cascade, q, equations->count() - cascade.column_count(), *equations);
  return 0;
}

}  // namespace

const StretchPrior kStretchPrior{lay_out, work_rows, start, apply};

}  // namespace pliant
