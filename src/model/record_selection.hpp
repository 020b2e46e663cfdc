#pragma once
// Surface points straight from the tables, at one q: visits only the records that change something there.
#include "model/cascade_plan.hpp"
#include "model/field_sampling.hpp"
#include "model/personal_field.hpp"
#include "pliant/cascade.hpp"

namespace pliant {

/// One value a record: scratch of an evaluation.
struct RecordValues {
  Vec3 *point = nullptr, *tangent_u = nullptr, *tangent_v = nullptr;
};

/// Where records read their fields.
struct FieldSource {
  const Model& model;
  const PersonalField& person;
  Interpolation interpolation;

  /// The record's own sample (of its field, or of its weight field in x); zero when it has none.
  Vec3 sample(const CascadeRecord& r, const ChartPoint& at) const;
};

class RecordSelection {
 public:
  void lay_out(Arena& arena, std::size_t records, const RecordValues& values);

  /// Lists those records of the plan that have an effect at q. `q` must stay unchanged.
  /// \param slack_mm  vectors of which no component moves any point by this are not listed.
  void select(const Model& model, const CascadePlan& plan, const float* q, float slack_mm);

  Span<const std::uint16_t> listed() const { return {listed_, count_}; }
  /// Whether each listed record but the first has the one before as its only source, and the last one is the result.
  bool is_chain() const { return is_chain_; }
  /// Starts to fetch what `frame` will read.
  void announce(const FieldSource& source, const CascadePlan& plan, Vec2 uv) const;
  /// Position, or position and tangents, of the plan's result at the selected q.
  Vec3 point(const FieldSource& source, const CascadePlan& plan, Vec2 uv);
  SurfaceFrame frame(const FieldSource& source, const CascadePlan& plan, Vec2 uv);

 private:
  SurfaceFrame next_frame(const FieldSource& source, const CascadeRecord& r, Vec2 uv,
                          const SurfaceFrame& first, const SurfaceFrame& second) const;
  void add_vector(const FieldSource& source, const CascadeRecord& r, const ChartPoint& at,
                  SurfaceFrame* to) const;

  std::uint16_t* listed_ = nullptr;
  std::uint16_t* value_of_ = nullptr;  // a record: the listed record that has the same value
  RecordValues values_;
  const float* q_ = nullptr;
  std::size_t count_ = 0;
  bool is_chain_ = false;
};

}  // namespace pliant
