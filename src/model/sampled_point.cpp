#include "model/sampled_point.hpp"

#include <cstring>

#include "model/field_step.hpp"

namespace pliant {

namespace {

/// The x of a marker that replaces a run of samples. Its y is the length of the run, its z how many vectors follow that only
/// add to the value. No live record's sample has this x, because Model::open bounds samples. A cached value may have it, but
/// its record lacks the flag kMaySkip.
constexpr float kLeftOut = 3e38f;

/// By its bits: cheaper than three comparisons of floats.
bool is_zero(const Vec3& v) {
  std::uint32_t bits[3];
  std::memcpy(bits, &v, sizeof bits);
  return ((bits[0] | bits[1] | bits[2]) << 1) == 0;
}

/// Whether the n-th sample may be left out.
inline bool is_negligible(const CascadePlan& plan, Span<const Parameter> parameters, std::size_t n,
                          const Vec3& s, float slack_mm) {
  const unsigned link = plan.link(n);
  if ((link & CascadePlan::kMaySkip) == 0) return false;
  if (is_zero(s)) return true;
  if (slack_mm == 0 || (link & CascadePlan::kAddsHere) == 0) return false;
  const Parameter& p = parameters[plan.first_parameters()[n]];
  const float most = max(magnitude(p.minimum), magnitude(p.maximum));
  return most * max(magnitude(s.x), max(magnitude(s.y), magnitude(s.z))) < slack_mm;
}

Vec3 value_of(const Vec3* value, std::uint16_t record) {
  return record == kNone ? Vec3{} : value[record];
}

/// Whether the n-th sampled record does no more than to add its vector.
bool only_adds(const CascadePlan& plan, std::size_t n) {
  return (plan.link(n) & (CascadePlan::kAddsHere | CascadePlan::kStores)) == CascadePlan::kAddsHere;
}

bool is_marker(const Vec3& sample) {
  std::uint32_t bits, left_out;  // cheaper to compare than floats
  std::memcpy(&bits, &sample.x, sizeof bits);
  std::memcpy(&left_out, &kLeftOut, sizeof left_out);
  return bits == left_out;
}

std::size_t to_count(float v) {
  return static_cast<unsigned>(static_cast<int>(v));
}

}  // namespace

void SampledPointEvaluator::lay_out(Arena& arena, const Model& model, const CascadePlan& plan, Vec3* value) {
  value_ = value;
  registers_.lay_out(arena, plan.register_count(), model.parameters().count);
}

void SampledPointEvaluator::compact(const CascadePlan& plan, Span<const Parameter> parameters, float slack_mm,
                                    Vec3* samples) {
  Vec3 *to = samples, *marker = nullptr;  // the marker that counts the present vectors
  const std::size_t count = plan.sampled_count();
  for (std::size_t n = 0; n < count;) {
    std::size_t end = n;
    while (end < count && is_negligible(plan, parameters, end, samples[end], slack_mm)) ++end;
    if (end > n) {
      marker = to++;
      *marker = {kLeftOut, static_cast<float>(end - n), 0};
      n = end;
      continue;
    }
    if (!only_adds(plan, n)) marker = nullptr;
    if (marker != nullptr) marker->z += 1;
    *to++ = samples[n++];
  }
}

template <bool kDerive>
Vec3 SampledPointEvaluator::run(const CascadePlan& plan, const CascadeRecord* records, const Vec3* samples,
                                const float* q) {
  Vec3 p;                                  // value of the sampled record before
  JacobianRegister* reg = &registers_[0];  // and its derivatives
  // Pointers of its own: the loop writes values, and the plan's would be read again after each.
  const std::uint8_t* const links = plan.links();
  const std::uint16_t* const parameters = plan.first_parameters();
  const std::size_t count = plan.sampled_count();
  const auto add = [&](std::uint16_t parameter, const Vec3& s) {  // Eq. 4
    const float a = q[parameter];
    p.x += a * s.x;
    p.y += a * s.y;
    p.z += a * s.z;
    if (kDerive && !is_zero(s)) registers_.add(*reg, parameter, s);
  };
  for (std::size_t n = 0; n < count; ++n) {
    const unsigned link = links[n];
    const Vec3& s = *samples++;
    if (is_marker(s) && (link & CascadePlan::kMaySkip) != 0) {
      n += to_count(s.y);
      for (std::size_t left = to_count(s.z); left > 0; --left) add(parameters[n++], *samples++);
      --n;
      continue;
    }
    if ((link & CascadePlan::kAddsHere) != 0) {
      add(parameters[n], s);
    } else if ((link & CascadePlan::kMultipliesHere) != 0) {
      const std::uint16_t first = parameters[n], second = records[plan.sampled(n)].parameter[1];
      const float a = q[first], b = q[second];
      p = p + (a * b) * s;
      if (kDerive && !is_zero(s)) {
        registers_.add(*reg, second, a * s);
        registers_.add(*reg, first, b * s);
      }
    } else if (const std::size_t i = plan.sampled(n); !plan.is_live(i)) {
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
    if ((link & CascadePlan::kStores) != 0) value_[plan.sampled(n)] = p;
  }
  return p;  // the last sampled record is the result
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
