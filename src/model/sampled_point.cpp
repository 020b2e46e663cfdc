#include "model/sampled_point.hpp"

#include "model/field_step.hpp"

namespace pliant {

namespace {

/// The x of a marker that replaces a run of samples; its y is the length of the run. No live record's sample has this value,
/// because Model::open bounds samples. A cached value may have it, but its record lacks the flag kMaySkip.
constexpr float kLeftOut = 3e38f;

bool is_zero(Vec3 v) {
  return v.x == 0 && v.y == 0 && v.z == 0;
}

bool is_left_out(const CascadePlan& plan, std::size_t n, Vec3 sample) {
  return sample.x == kLeftOut && (plan.link(n) & CascadePlan::kMaySkip) != 0;
}

/// Whether the n-th sample may be left out.
bool is_negligible(const CascadePlan& plan, Span<const Parameter> parameters, std::size_t n, Vec3 s,
                   float slack_mm) {
  const unsigned link = plan.link(n);
  if ((link & CascadePlan::kMaySkip) == 0) return false;
  if (is_zero(s) || (link & CascadePlan::kAddsHere) == 0) return is_zero(s);
  const Parameter& p = parameters[plan.first_parameter(n)];
  const float most = max(magnitude(p.minimum), magnitude(p.maximum));
  return most * max(magnitude(s.x), max(magnitude(s.y), magnitude(s.z))) < slack_mm;
}

Vec3 value_of(const Vec3* value, std::uint16_t record) {
  return record == kNone ? Vec3{} : value[record];
}

}  // namespace

void SampledPointEvaluator::lay_out(Arena& arena, const Model& model, const CascadePlan& plan, Vec3* value) {
  value_ = value;
  registers_.lay_out(arena, plan.register_count(), model.parameters().count);
}

void SampledPointEvaluator::compact(const CascadePlan& plan, Span<const Parameter> parameters, float slack_mm,
                                    Vec3* samples) {
  Vec3* to = samples;
  for (std::size_t n = 0; n < plan.sampled_count();) {
    std::size_t end = n;
    while (end < plan.sampled_count() && is_negligible(plan, parameters, end, samples[end], slack_mm)) ++end;
    *to++ = end > n ? Vec3{kLeftOut, static_cast<float>(end - n), 0} : samples[n];
    n = end > n ? end : n + 1;
  }
}

template <bool kDerive>
Vec3 SampledPointEvaluator::run(const CascadePlan& plan, const CascadeRecord* records, const Vec3* samples,
                                const float* q) {
  Vec3 p;                                  // value of the sampled record before
  JacobianRegister* reg = &registers_[0];  // and its derivatives
  for (std::size_t n = 0; n < plan.sampled_count(); ++n) {
    const Vec3& s = *samples++;
    if (is_left_out(plan, n, s)) {
      n += static_cast<std::size_t>(s.y) - 1;
      continue;
    }
    const unsigned link = plan.link(n);
    const std::size_t i = plan.sampled(n);
    if ((link & (CascadePlan::kAddsHere | CascadePlan::kMultipliesHere)) != 0) {  // Eq. 4
      const std::uint16_t parameter = plan.first_parameter(n);
      const float a = q[parameter];
      const bool derives = kDerive && !is_zero(s);
      float b = 1;
      if ((link & CascadePlan::kMultipliesHere) != 0) {
        const std::uint16_t second = records[i].parameter[1];
        b = q[second];
        if (derives) registers_.add(*reg, second, a * s);
      }
      p = p + (a * b) * s;
      if (derives) registers_.add(*reg, parameter, b * s);
    } else if (!plan.is_live(i)) {
      p = s;
    } else {
      const CascadeRecord& r = records[i];
      const Vec3 p0 = (link & CascadePlan::kFollows) != 0 ? p : value_of(value_, r.source[0]);
      const Vec3 p1 = value_of(value_, r.source[1]);
      reg = &registers_[plan.register_of(i)];
      if (kDerive) {
        const FieldStep step = apply(r, q, p0, p1, s);
        p = step.p;
        registers_.propagate(plan, r, i, step);
      } else {
        p = apply_without_derivatives(r, q, p0, p1, s);
      }
    }
    if ((link & CascadePlan::kStores) != 0) value_[i] = p;
  }
  return value_[plan.result()];
}

Vec3 SampledPointEvaluator::evaluate(const CascadePlan& plan, const CascadeRecord* records,
                                     const Vec3* samples, const float* q) {
  return run<false>(plan, records, samples, q);
}

Vec3 SampledPointEvaluator::evaluate(const CascadePlan& plan, const CascadeRecord* records,
                                     const Vec3* samples, const float* q, Jacobian* jacobian) {
  registers_.clear();
  const Vec3 p = run<true>(plan, records, samples, q);
  *jacobian = {};
  if (plan.is_live(plan.result())) *jacobian = registers_.sorted(plan.register_of(plan.result()));
  return p;
}

}  // namespace pliant
