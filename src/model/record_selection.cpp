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
  bool is_chain = true;
  for (const std::uint16_t i : plan.needed()) {
    const CascadeRecord& r = records[i];
    if (i != personal_record && changes_nothing(r, fields, q, slack_mm)) {
      value_of[i] = value_of[r.source[0]];
      continue;
    }
    value_of[i] = i;
    if (to != listed_)
      is_chain = is_chain && i != personal_record && r.source[0] != kNone && r.source[1] == kNone &&
                 value_of[r.source[0]] == to[-1];
    *to++ = i;
  }
  q_ = q;
  count_ = static_cast<std::size_t>(to - listed_);
  is_chain_ = is_chain && count_ > 0 && value_of[plan.result()] == to[-1];
}

Vec3 RecordSelection::point(const FieldSource& source, const CascadePlan& plan, Vec2 uv) {
  PLIANT_ASSERT(count_ > 0);  // `select` was called
  const CascadeRecord* const records = source.model.cascade().data;
  const Field* const fields = source.model.fields().data;
  const std::uint8_t* const samples = source.model.samples();
  Vec3* const point = values_.point;
  const bool is_chain = is_chain_;
  const ChartPoint at(uv);
  Vec3 p;  // of the record before; in a chain nothing else is read
  for (const std::uint16_t i : listed()) {
    if (i == plan.personal_record()) {
      point[i] = p = source.person.sample(source.model, uv, source.interpolation, nullptr, nullptr);
      continue;
    }
    const CascadeRecord& r = records[i];
    if (!is_chain) p = r.source[0] == kNone ? Vec3{} : point[value_of_[r.source[0]]];
    if (r.operation == Operation::add_vector) {  // most of them, and most of those are of a part of the chart
      const Field& field = fields[r.field];
      if (is_in_support(field, at))
        p = p + q_[r.parameter[0]] * sample_in_support(samples, field, at, source.interpolation);
    } else {
      const Vec3 p1 = r.source[1] == kNone ? Vec3{} : point[value_of_[r.source[1]]];
      const Vec3 s = source.sample(r, at);
      p = r.operation == Operation::constant ? s : apply_without_derivatives(r, q_, p, p1, s);
    }
    if (!is_chain) point[i] = p;
  }
  return is_chain ? p : point[value_of_[plan.result()]];
}

/// Chain rule along u and v (field_step.hpp): the sources' tangents, mapped, and the change of the record's own sample.
SurfaceFrame RecordSelection::next_frame(const FieldSource& source, const CascadeRecord& r, Vec2 uv,
                                         const SurfaceFrame& first, const SurfaceFrame& second) const {
  const std::uint16_t field = field_of(r);
  Vec3 s, su, sv;
  if (field != kNone)
    s = sample_field(source.model.samples(), source.model.fields()[field], uv, source.interpolation, &su,
                     &sv);
  const FieldStep f = apply(r, q_, first.p, second.p, s);
  const auto tangent = [&](Vec3 of_first, Vec3 of_second, Vec3 along) {
    Vec3 t;
    if (r.source[0] != kNone) t = f.maps ? f.map * of_first : f.keep * of_first;
    if (r.source[1] != kNone) t = t + f.keep_second * of_second;
    return r.field != kNone ? t + f.along_field * along : t + along.x * f.along_weight;
  };
  return {f.p, tangent(first.pu, second.pu, su), tangent(first.pv, second.pv, sv)};
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
  const auto value_of = [&](std::uint16_t from) {
    if (from == kNone) return SurfaceFrame{};
    const std::size_t i = value_of_[from];
    return SurfaceFrame{v.point[i], v.tangent_u[i], v.tangent_v[i]};
  };
  const bool is_chain = is_chain_;
  const ChartPoint at(uv);
  SurfaceFrame of{};  // as in `point`
  for (const std::uint16_t i : listed()) {
    const CascadeRecord& r = source.model.cascade()[i];
    if (i == plan.personal_record()) {
      of.p = source.person.sample(source.model, uv, source.interpolation, &of.pu, &of.pv);
    } else {
      if (!is_chain) of = value_of(r.source[0]);
      if (r.operation == Operation::add_vector)
        add_vector(source, r, at, &of);
      else
        of = next_frame(source, r, uv, of, value_of(r.source[1]));
    }
    if (is_chain) continue;
    v.point[i] = of.p;
    v.tangent_u[i] = of.pu;
    v.tangent_v[i] = of.pv;
  }
  return is_chain ? of : value_of(plan.result());
}

void RecordSelection::add_vector(const FieldSource& source, const CascadeRecord& r, const ChartPoint& at,
                                 SurfaceFrame* to) const {
  const Field& field = source.model.fields()[r.field];
  if (!is_in_support(field, at)) return;
  const float amount = q_[r.parameter[0]];
  Vec3 su, sv;
  const Vec3 s = sample_with_gradient(source.model.samples(), field, at, source.interpolation, &su, &sv);
  to->p = to->p + amount * s;
  to->pu = to->pu + amount * su;
  to->pv = to->pv + amount * sv;
}

}  // namespace pliant
