#include "pliant/cascade.hpp"

#include "model/cascade_plan.hpp"
#include "model/field_step.hpp"
#include "model/personal_field.hpp"
#include "model/record_selection.hpp"
#include "model/sampled_point.hpp"
#include "model/vector_sum.hpp"

namespace pliant {

struct Cascade::State {
  Interpolation interpolation = Interpolation::bilinear;
  CascadePlan plan;
  PersonalField person;
  RecordSelection selection;
  SampledPointEvaluator evaluator;
  RecordValues values;  // scratch of all evaluations

  void lay_out(Arena& arena, const Model& model, const PersonalFieldLimits& limits);
  FieldSource source(const Model& model) const { return {model, person, interpolation}; }
};

namespace {

/// Follows source[0] from `record` back to a constant. \return that constant's field.
std::uint16_t root_field(Span<const CascadeRecord> records, std::size_t record) {
  while (records[record].source[0] != kNone) record = records[record].source[0];
  return records[record].field;
}

}  // namespace

void Cascade::State::lay_out(Arena& arena, const Model& model, const PersonalFieldLimits& limits) {
  const auto records = model.cascade();
  plan.lay_out(arena, records);
  values.point = arena.take<Vec3>(records.count);
  values.tangent_u = arena.take<Vec3>(records.count);
  values.tangent_v = arena.take<Vec3>(records.count);
  selection.lay_out(arena, records.count, values);
  evaluator.lay_out(arena, model, plan, values.point);
  person.lay_out(arena, limits);
}

void Cascade::lay_out(Arena& arena, const Model& model, const PersonalFieldLimits& person) {
  model_ = model;
  parameter_of_ = arena.take<std::uint16_t>(model.parameters().count);
  column_of_ = arena.take<std::uint16_t>(model.parameters().count);
  state_ = arena.take<State>(1);
  State state;
  state.lay_out(arena, model, person);
  if (state_ == nullptr) return;  // only measured
  state.evaluator.registers().set_columns(column_of_);
  *state_ = state;
  set_all_free();
}

template <class Predicate>
void Cascade::choose(const Predicate& is_free) {
  column_count_ = 0;
  for (std::size_t i = 0; i < parameter_count(); ++i) {
    const bool free = is_free(i);
    column_of_[i] = free ? static_cast<std::uint16_t>(column_count_) : kNone;
    if (free) parameter_of_[column_count_++] = static_cast<std::uint16_t>(i);
  }
  forget_person();
}

void Cascade::set_all_free() {
  choose([](std::size_t) { return true; });
}

void Cascade::set_free(const std::uint8_t* is_free) {
  PLIANT_ASSERT(is_free != nullptr);
  choose([is_free](std::size_t i) { return is_free[i] != 0; });
}

void Cascade::set_free(Group group) {
  choose([this, group](std::size_t i) { return model_.parameters()[i].group == group; });
}

void Cascade::update_plan(std::uint16_t personal_record) {
  state_->plan.make(model_.cascade(), column_of_, personal_record);
}

void Cascade::set_interpolation(Interpolation interpolation) {
  state_->interpolation = interpolation;
  forget_person();
}

Interpolation Cascade::interpolation() const {
  return state_->interpolation;
}

void Cascade::forget_person() {
  update_plan(kNone);
}

bool Cascade::is_personalised() const {
  return state_->plan.personal_record() != kNone;
}

std::size_t Cascade::sample_count() const {
  const CascadePlan& plan = state_->plan;
  std::size_t count = 0;
  for (const std::uint16_t i : plan.needed()) {
    const CascadeRecord& r = model_.cascade()[i];
    count += i == plan.personal_record() ? 2 : r.field != kNone || r.weight != kNone ? 1 : 0;
  }
  return count;
}

/// The cached record whose personal field saves most samples, or kNone when none saves any. Voids the plan.
std::uint16_t Cascade::find_personal_record() {
  const auto records = model_.cascade();
  CascadePlan& plan = state_->plan;
  std::uint16_t best = kNone;
  std::size_t least = sample_count();
  for (std::size_t i = 0; i < records.count; ++i) {
    if (plan.role(i) != CascadePlan::Role::cached) continue;
    plan.list_needed(records, records.count - 1, static_cast<std::uint16_t>(i));
    if (sample_count() >= least) continue;
    least = sample_count();
    best = static_cast<std::uint16_t>(i);
  }
  return best;
}

/// Voids the plan.
Status Cascade::fill_personal_field(std::size_t record, const float* q) {
  State& s = *state_;
  s.plan.list_needed(model_.cascade(), record, kNone);
  select(q);
  const std::uint16_t root = root_field(model_.cascade(), record);
  const VectorSum sum(model_, s.selection.listed(), q, s.person.width(), s.person.height());
  if (sum.applies() && s.selection.is_chain()) {
    const Vec3 largest = sum.largest();
    const auto differences = [&](std::size_t i, std::size_t j, Span<Vec3> out) {
      sum.compute(i, j, s.interpolation, out);
    };
    return s.person.fill(root, differences, &largest);
  }
  return s.person.fill(root, [&](std::size_t i, std::size_t j, Span<Vec3> out) {
    for (std::size_t k = 0; k < out.count; ++k) {
      const Vec2 uv = s.person.uv_of(i + k, j);
      out[k] = selected_point(uv) - sample(model_, model_.fields()[root], uv, s.interpolation);
    }
  });
}

Status Cascade::personalise(const float* q) {
  if (state_ == nullptr || !state_->person.has_room()) return Status::capacity;
  if (q == nullptr) return Status::bad_argument;
  const std::uint16_t before = state_->plan.personal_record();
  forget_person();
  const std::uint16_t record = find_personal_record();
  const Status status = record == kNone ? Status::ok : fill_personal_field(record, q);
  update_plan(status == Status::ok ? record : before);
  return status;
}

std::size_t Cascade::samples_per_point() const {
  return state_->plan.sampled_count();
}

void Cascade::sample_point(Vec2 uv, const float* q, Vec3* samples, float slack_mm) {
  PLIANT_ASSERT((q != nullptr || parameter_count() == 0) && samples != nullptr && slack_mm >= 0);
  State& s = *state_;
  const FieldSource source = s.source(model_);
  const ChartPoint at(uv);
  Vec3* to = samples;
  for (const std::uint16_t i : s.plan.needed()) {
    const CascadeRecord& r = model_.cascade()[i];
    if (s.plan.is_live(i)) {
      *to++ = source.sample(r, at);
      continue;
    }
    const auto value_of = [&](int k) { return r.source[k] == kNone ? Vec3{} : s.values.point[r.source[k]]; };
    Vec3& p = s.values.point[i];
    p = i == s.plan.personal_record()
            ? s.person.sample(model_, uv, s.interpolation, nullptr, nullptr)
            : apply_without_derivatives(r, q, value_of(0), value_of(1), source.sample(r, at));
    if (s.plan.role(i) == CascadePlan::Role::cached) *to++ = p;
  }
  SampledPointEvaluator::compact(s.plan, model_.parameters(), slack_mm, samples);
}

Vec3 Cascade::evaluate(const Vec3* samples, const float* q) {
  return state_->evaluator.evaluate(state_->plan, model_.cascade().data, samples, q);
}

Vec3 Cascade::evaluate(const Vec3* samples, const float* q, Jacobian* jacobian) {
  PLIANT_ASSERT(samples != nullptr && (q != nullptr || parameter_count() == 0) && jacobian != nullptr);
  return state_->evaluator.evaluate(state_->plan, model_.cascade().data, samples, q, jacobian);
}

void Cascade::select(const float* q, float slack_mm) {
  PLIANT_ASSERT((q != nullptr || parameter_count() == 0) && slack_mm >= 0);
  state_->selection.select(model_, state_->plan, q, slack_mm);
}

Vec3 Cascade::selected_point(Vec2 uv) {
  return state_->selection.point(state_->source(model_), state_->plan, uv);
}

void Cascade::announce(Vec2 uv) const {
  state_->selection.announce(state_->source(model_), state_->plan, uv);
}

SurfaceFrame Cascade::selected_frame(Vec2 uv) {
  return state_->selection.frame(state_->source(model_), state_->plan, uv);
}

Vec3 Cascade::surface_point(Vec2 uv, const float* q) {
  select(q);
  return selected_point(uv);
}

SurfaceFrame Cascade::surface_frame(Vec2 uv, const float* q) {
  select(q);
  return selected_frame(uv);
}

}  // namespace pliant
