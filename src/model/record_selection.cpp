#include "model/record_selection.hpp"

#include "model/field_step.hpp"

namespace pliant {

namespace {

/// No component of a field's vectors is larger.
float largest_component(const Field& f) {
  float largest = 0;
  for (int k = 0; k < 3; ++k) largest = max(largest, largest_value(f, k));
  return largest;
}

std::uint16_t field_of(const CascadeRecord& r) {
  return r.field != kNone ? r.field : r.weight;
}

/// Whether the record's value is that of its source at every (u,v), to within the slack.
bool changes_nothing(const CascadeRecord& r, const Field* fields, const float* q, float slack_mm) {
  if (r.operation != Operation::add_vector) return keeps_source(r, q);
  const float amount = magnitude(q[r.parameter[0]]);
  return amount == 0 || (slack_mm > 0 && amount * largest_component(fields[r.field]) < slack_mm);
}

}  // namespace

Vec3 FieldSource::sample(const CascadeRecord& r, const ChartPoint& at) const {
  const std::uint16_t field = field_of(r);
  return field == kNone ? Vec3{} : sample_at(model.samples(), model.fields()[field], at, interpolation);
}

void RecordSelection::lay_out(Arena& arena, std::size_t records, const RecordValues& values) {
  listed_ = arena.take<std::uint16_t>(records);
  value_of_ = arena.take<std::uint16_t>(records);
  values_ = values;
  q_ = nullptr;
  count_ = 0;
}

void RecordSelection::select(const Model& model, const CascadePlan& plan, const float* q, float slack_mm) {
  const CascadeRecord* const records = model.cascade().data;
  const Field* const fields = model.fields().data;
  const std::uint16_t personal_record = plan.personal_record();
  std::uint16_t* const value_of = value_of_;
  std::uint16_t* to = listed_;
  for (const std::uint16_t i : plan.needed()) {
    const CascadeRecord& r = records[i];
    if (i != personal_record && changes_nothing(r, fields, q, slack_mm)) {
      value_of[i] = value_of[r.source[0]];
    } else {
      value_of[i] = i;
      *to++ = i;
    }
  }
  q_ = q;
  count_ = static_cast<std::size_t>(to - listed_);
}

bool RecordSelection::is_chain(const Model& model, const CascadePlan& plan) const {
  for (std::size_t n = 1; n < count_; ++n) {
    const CascadeRecord& r = model.cascade()[listed_[n]];
    if (value_of_[r.source[0]] != listed_[n - 1]) return false;
  }
  return count_ > 0 && value_of_[plan.result()] == listed_[count_ - 1];
}

Vec3 RecordSelection::point(const FieldSource& source, const CascadePlan& plan, Vec2 uv) {
  PLIANT_ASSERT(count_ > 0);  // `select` was called
  const CascadeRecord* const records = source.model.cascade().data;
  const Field* const fields = source.model.fields().data;
  const std::uint8_t* const samples = source.model.samples();
  Vec3* const point = values_.point;
  const ChartPoint at(uv);
  for (const std::uint16_t i : listed()) {
    if (i == plan.personal_record()) {
      point[i] = source.person.sample(source.model, uv, source.interpolation, nullptr, nullptr);
      continue;
    }
    const CascadeRecord& r = records[i];
    const Vec3 p0 = r.source[0] == kNone ? Vec3{} : point[value_of_[r.source[0]]];
    if (r.operation == Operation::add_vector) {  // most of them, and most of those are of a part of the chart
      const Field& field = fields[r.field];
      point[i] = p0;
      if (is_in_support(field, at))
        point[i] = p0 + q_[r.parameter[0]] * sample_in_support(samples, field, at, source.interpolation);
      continue;
    }
    const Vec3 p1 = r.source[1] == kNone ? Vec3{} : point[value_of_[r.source[1]]];
    const Vec3 s = source.sample(r, at);
    point[i] = r.operation == Operation::constant ? s : apply_without_derivatives(r, q_, p0, p1, s);
  }
  return point[value_of_[plan.result()]];
}

/// Chain rule along u and v (field_step.hpp): the sources' tangents, mapped, and the change of the record's own sample.
void RecordSelection::compute_frame(const FieldSource& source, std::size_t record, Vec2 uv) {
  const CascadeRecord& r = source.model.cascade()[record];
  const std::size_t first = r.source[0] == kNone ? kNone : value_of_[r.source[0]];
  const std::size_t second = r.source[1] == kNone ? kNone : value_of_[r.source[1]];
  const RecordValues& v = values_;
  const std::uint16_t field = field_of(r);
  Vec3 s, su, sv;
  if (field != kNone)
    s = sample_field(source.model.samples(), source.model.fields()[field], uv, source.interpolation, &su,
                     &sv);
  const FieldStep f =
      apply(r, q_, first == kNone ? Vec3{} : v.point[first], second == kNone ? Vec3{} : v.point[second], s);
  const auto tangent = [&](const Vec3* of, Vec3 along) {
    Vec3 t;
    if (first != kNone) t = f.maps ? f.map * of[first] : f.keep * of[first];
    if (second != kNone) t = t + f.keep_second * of[second];
    return r.field != kNone ? t + f.along_field * along : t + along.x * f.along_weight;
  };
  v.point[record] = f.p;
  v.tangent_u[record] = tangent(v.tangent_u, su);
  v.tangent_v[record] = tangent(v.tangent_v, sv);
}

void RecordSelection::announce(const FieldSource& source, const CascadePlan& plan, Vec2 uv) const {
  const ChartPoint at(uv);
  for (const std::uint16_t i : listed()) {
    const CascadeRecord& r = source.model.cascade()[i];
    const std::uint16_t field = field_of(r);
    if (i == plan.personal_record())
      source.person.announce(source.model, uv);
    else if (field != kNone && is_in_support(source.model.fields()[field], at))
      prefetch_field(source.model.samples(), source.model.fields()[field], uv);
  }
}

SurfaceFrame RecordSelection::frame(const FieldSource& source, const CascadePlan& plan, Vec2 uv) {
  PLIANT_ASSERT(count_ > 0);  // `select` was called
  const RecordValues& v = values_;
  const ChartPoint at(uv);
  for (std::size_t n = 0; n < count_; ++n) {
    const std::size_t i = listed_[n];
    const CascadeRecord& r = source.model.cascade()[i];
    if (i == plan.personal_record()) {
      v.point[i] =
          source.person.sample(source.model, uv, source.interpolation, &v.tangent_u[i], &v.tangent_v[i]);
    } else if (r.operation == Operation::add_vector) {  // as in `point`
      const std::size_t first = value_of_[r.source[0]];
      const Field& field = source.model.fields()[r.field];
      v.point[i] = v.point[first];
      v.tangent_u[i] = v.tangent_u[first];
      v.tangent_v[i] = v.tangent_v[first];
      if (!is_in_support(field, at)) continue;
      const float amount = q_[r.parameter[0]];
      Vec3 su, sv;
      const Vec3 s = sample_with_gradient(source.model.samples(), field, at, source.interpolation, &su, &sv);
      v.point[i] = v.point[i] + amount * s;
      v.tangent_u[i] = v.tangent_u[i] + amount * su;
      v.tangent_v[i] = v.tangent_v[i] + amount * sv;
    } else {
      compute_frame(source, i, uv);
    }
  }
  const std::size_t last = value_of_[plan.result()];
  return {v.point[last], v.tangent_u[last], v.tangent_v[last]};
}

}  // namespace pliant
