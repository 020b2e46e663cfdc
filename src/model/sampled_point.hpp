#pragma once
// Evaluates sampled surface points (Eq. 1) with their Jacobians (Eq. 11).
//
// A sampled surface point holds one Vec3 for each sampled record of the plan: a live record's sample, or a cached record's
// value. `compact` replaces each run of samples without effect by one marker and moves the following samples up, so that
// the samples that are read are contiguous.
#include "model/cascade_plan.hpp"
#include "model/jacobian_registers.hpp"
#include "pliant/cascade.hpp"

namespace pliant {

class SampledPointEvaluator {
 public:
  /// \param value  scratch: one value a record.
  void lay_out(Arena& arena, const Model& model, const CascadePlan& plan, Vec3* value);

  JacobianRegisters& registers() { return registers_; }

  /// Leaves out zeros, and vectors that move the point by less than `slack_mm` at the limits of their parameter.
  static void compact(const CascadePlan& plan, Span<const Parameter> parameters, float slack_mm,
                      Vec3* samples);

  Vec3 evaluate(const CascadePlan& plan, const CascadeRecord* records, const Vec3* samples, const float* q);
  Vec3 evaluate(const CascadePlan& plan, const CascadeRecord* records, const Vec3* samples, const float* q,
                Jacobian* jacobian);

 private:
  template <bool kDerive>
  Vec3 run(const CascadePlan& plan, const CascadeRecord* records, const Vec3* samples, const float* q);

  JacobianRegisters registers_;
  Vec3* value_ = nullptr;
};

}  // namespace pliant
