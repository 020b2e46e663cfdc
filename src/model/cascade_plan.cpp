#include "model/cascade_plan.hpp"

#include "model/field_step.hpp"

namespace pliant {

namespace {

bool is_read_after(Span<const CascadeRecord> records, std::size_t source, std::size_t i) {
  for (std::size_t k = i + 1; k < records.count; ++k)
    if (records[k].source[0] == source || records[k].source[1] == source) return true;
  return false;
}

/// The largest number of values that are alive at once while the records run in order. Freezing parameters only removes
/// some of them, so this many registers are enough for any choice of free parameters.
std::size_t most_values_at_once(Span<const CascadeRecord> records) {
  std::size_t waiting = 0, most = 1;
  for (std::size_t i = 0; i < records.count; ++i) {
    for (const std::uint16_t s : records[i].source)
      if (s != kNone && !is_read_after(records, s, i)) --waiting;
    if (waiting + 1 > most) most = waiting + 1;
    if (is_read_after(records, i, i)) ++waiting;
  }
  return most;
}

}  // namespace

void CascadePlan::lay_out(Arena& arena, Span<const CascadeRecord> records) {
  *this = {};
  register_count_ = most_values_at_once(records);
  role_ = arena.take<Role>(records.count);
  is_needed_ = arena.take<std::uint8_t>(records.count);
  link_ = arena.take<std::uint8_t>(records.count);
  std::uint16_t** const lists[] = {&needed_, &sampled_, &register_of_, &last_reader_, &first_parameter_};
  for (std::uint16_t** list : lists) *list = arena.take<std::uint16_t>(records.count);
  busy_until_ = arena.take<std::uint16_t>(register_count_);
}

void CascadePlan::make(Span<const CascadeRecord> records, const std::uint16_t* column_of,
                       std::uint16_t personal_record) {
  list_needed(records, records.count - 1, personal_record);
  assign_roles(records, column_of);
  sampled_count_ = 0;
  for (const std::uint16_t i : needed())
    if (role_[i] != Role::frozen) sampled_[sampled_count_++] = i;
  find_last_readers(records);
  assign_registers();
  link_records(records);
}

void CascadePlan::list_needed(Span<const CascadeRecord> records, std::size_t result,
                              std::uint16_t personal_record) {
  PLIANT_ASSERT(result < records.count);
  result_ = static_cast<std::uint16_t>(result);
  personal_record_ = personal_record;
  for (std::size_t i = 0; i < records.count; ++i) is_needed_[i] = i == result;
  for (std::size_t i = result + 1; i-- > 0;) {
    if (!is_needed_[i] || i == personal_record) continue;
    for (const std::uint16_t s : records[i].source)
      if (s != kNone) is_needed_[s] = 1;
  }
  needed_count_ = 0;
  for (std::size_t i = 0; i <= result; ++i)
    if (is_needed_[i]) needed_[needed_count_++] = static_cast<std::uint16_t>(i);
}

void CascadePlan::assign_roles(Span<const CascadeRecord> records, const std::uint16_t* column_of) {
  for (std::size_t i = 0; i < records.count; ++i) role_[i] = Role::unused;
  for (const std::uint16_t i : needed()) {
    role_[i] = Role::frozen;
    if (i == personal_record_) continue;
    for (const std::uint16_t p : records[i].parameter)
      if (p != kNone && column_of[p] != kNone) role_[i] = Role::live;
    for (const std::uint16_t s : records[i].source)
      if (s != kNone && is_live(s)) role_[i] = Role::live;
  }
  if (!is_live(result_)) role_[result_] = Role::cached;
  for (const std::uint16_t i : needed())
    for (const std::uint16_t s : records[i].source)
      if (is_live(i) && s != kNone && !is_live(s)) role_[s] = Role::cached;
}

void CascadePlan::find_last_readers(Span<const CascadeRecord> records) {
  for (std::size_t n = 0; n < sampled_count_; ++n) {
    const std::uint16_t i = sampled_[n];
    last_reader_[i] = i;
    if (!is_live(i)) continue;
    for (const std::uint16_t s : records[i].source)
      if (s != kNone) last_reader_[s] = i;
  }
}

/// A live record takes the first register whose value no later record reads. That may be the register of its source.
void CascadePlan::assign_registers() {
  for (std::size_t k = 0; k < register_count_; ++k) busy_until_[k] = 0;
  for (std::size_t n = 0; n < sampled_count_; ++n) {
    const std::uint16_t i = sampled_[n];
    if (!is_live(i)) continue;
    std::uint16_t k = 0;
    while (busy_until_[k] > i) ++k;
    PLIANT_ASSERT(k < register_count_);
    register_of_[i] = k;
    busy_until_[k] = last_reader_[i];
  }
}

/// Whether the value of the n-th sampled record has to be kept beyond the next one, or for a record with two sources.
bool CascadePlan::is_stored(Span<const CascadeRecord> records, std::size_t n) const {
  if (n + 1 == sampled_count_) return true;
  const std::uint16_t last = last_reader_[sampled_[n]];
  return last != sampled_[n] && (last != sampled_[n + 1] || records[last].source[1] != kNone);
}

/// Most records of a face add a vector to the record before, and most of these vectors are zero at any one point. Most of a
/// surface with bending modes are products. The links let the evaluation carry the value along such a chain in a variable
/// and skip the zeros.
void CascadePlan::link_records(Span<const CascadeRecord> records) {
  for (std::size_t n = 0; n < sampled_count_; ++n) {
    const std::size_t i = sampled_[n];
    const CascadeRecord& r = records[i];
    const std::uint16_t source = r.source[0];
    const bool follows = n > 0 && is_live(i) && source == sampled_[n - 1] && r.source[1] == kNone;
    const bool in_place = follows && is_live(source) && register_of_[source] == register_of_[i];
    const bool adds = r.operation == Operation::add_vector, stores = is_stored(records, n);
    unsigned link = follows ? kFollows : 0;
    if (in_place && adds) link |= kAddsHere;
    if (in_place && r.operation == Operation::product) link |= kMultipliesHere;
    if (stores)
      link |= kStores;
    else if (in_place && (adds || keeps_source_at_zero_sample(r)))
      link |= kMaySkip;
    first_parameter_[n] = r.parameter[0];
    link_[n] = static_cast<std::uint8_t>(link);
  }
}

}  // namespace pliant
