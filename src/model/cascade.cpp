// The cascade: which records matter under a choice of free parameters, and the evaluation of baked points with their
// derivatives (the paper, section 3; Eq. 1-4 and 11).
#include "model/field_step.hpp"
#include "pliant/cascade.hpp"

namespace pliant {

namespace {

constexpr float kSkip =
    3e38f;  // in the place of a sample's x, which is millimetres: nothing to do for a while

bool is_zero(Vec3 v) {
  return v.x == 0 && v.y == 0 && v.z == 0;
}

bool is_read_after(Span<const CascadeRecord> records, std::size_t source, std::size_t i) {
  for (std::size_t k = i + 1; k < records.count; ++k)
    if (records[k].source[0] == source || records[k].source[1] == source) return true;
  return false;
}

/// The most values that are wanted at once while the records run in order. Freezing parameters only takes some of them
/// away, so that this many registers are enough for any choice.
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

void Cascade::lay_out(Arena& arena, const Model& model, const PersonalFieldLimits& person) {
  model_ = model;
  interpolation_ = Interpolation::bilinear;
  personal_limits_ = person;
  const std::size_t records = model.cascade().count, parameters = model.parameters().count;
  parameter_of_ = arena.take<std::uint16_t>(parameters);
  column_of_ = arena.take<std::uint16_t>(parameters);
  role_ = arena.take<Role>(records);
  link_ = arena.take<std::uint8_t>(records);
  needed_ = arena.take<std::uint8_t>(records);
  std::uint16_t** const per_record[] = {&visited_,  &emitted_,    &register_of_,    &last_reader_,
                                        &selected_, &stands_for_, &plain_parameter_};
  for (std::uint16_t** list : per_record) *list = arena.take<std::uint16_t>(records);
  point_ = arena.take<Vec3>(records);
  tangent_u_ = arena.take<Vec3>(records);
  tangent_v_ = arena.take<Vec3>(records);
  register_count_ = most_values_at_once(model.cascade());
  register_ = arena.take<Register>(register_count_);
  for (std::size_t k = 0; k < register_count_; ++k) {
    const Register empty{arena.take<Vec3>(parameters), arena.take<std::uint16_t>(parameters),
                         arena.take<std::uint8_t>(parameters), 0, 0};
    if (register_ != nullptr) register_[k] = empty;
  }
  const bool has_room = person.width >= 2 && person.height >= 2 && person.width <= 256 && person.height <= 256;
  neutral_samples_ = has_room ? arena.take<std::int16_t>(std::size_t{3} * person.width * person.height) : nullptr;
  selected_count_ = 0;
  if (!arena.is_measuring()) set_all_free();
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
  choose([is_free](std::size_t i) { return is_free[i] != 0; });
}

void Cascade::set_free(Group group) {
  choose([this, group](std::size_t i) { return model_.parameters()[i].group == group; });
}

void Cascade::forget_person() {
  neutral_ = kNone;
  plan();
}

/// Marks what `result` reads, at first or second hand; what the folded neutral stands for is not read.
void Cascade::mark_needed(std::size_t result) {
  const auto records = model_.cascade();
  for (std::size_t i = 0; i < records.count; ++i) needed_[i] = i == result;
  for (std::size_t i = result + 1; i-- > 0;) {
    if (!needed_[i] || i == neutral_) continue;
    for (const std::uint16_t s : records[i].source)
      if (s != kNone) needed_[s] = 1;
  }
  result_ = static_cast<std::uint16_t>(result);
  visited_count_ = 0;
  for (std::size_t i = 0; i <= result; ++i)
    if (needed_[i]) visited_[visited_count_++] = static_cast<std::uint16_t>(i);
}

/// Gives every record its role, and lists those that bakes and evaluations visit.
void Cascade::plan() {
  const auto records = model_.cascade();
  mark_needed(records.count - 1);
  for (std::size_t i = 0; i < records.count; ++i) role_[i] = Role::unused;
  for (std::size_t n = 0; n < visited_count_; ++n) {
    const std::size_t i = visited_[n];
    role_[i] = Role::frozen;
    if (i == neutral_) continue;
    for (const std::uint16_t p : records[i].parameter)
      if (p != kNone && column_of_[p] != kNone) role_[i] = Role::live;
    for (const std::uint16_t s : records[i].source)
      if (s != kNone && is_live(s)) role_[i] = Role::live;
  }
  if (!is_live(result_)) role_[result_] = Role::folded;
  for (std::size_t n = 0; n < visited_count_; ++n)
    for (const std::uint16_t s : records[visited_[n]].source)
      if (is_live(visited_[n]) && s != kNone && !is_live(s)) role_[s] = Role::folded;
  emitted_count_ = 0;
  for (std::size_t n = 0; n < visited_count_; ++n)
    if (role_[visited_[n]] != Role::frozen) emitted_[emitted_count_++] = visited_[n];
  assign_registers();
  link();
}

/// Most records of a face add a vector to the record before, and most vectors are zero at any one point: `run` carries
/// the value along in a chain of such records, and passes over the zeros.
void Cascade::link() {
  const auto records = model_.cascade();
  for (std::size_t n = 0; n < emitted_count_; ++n) {
    const std::size_t i = emitted_[n];
    const CascadeRecord& r = records[i];
    const bool follows = n > 0 && is_live(i) && r.source[0] == emitted_[n - 1] && r.source[1] == kNone;
    const bool in_place = follows && is_live(r.source[0]) && register_of_[r.source[0]] == register_of_[i];
    bool stores = n + 1 == emitted_count_;
    for (std::size_t m = n + 1; m < emitted_count_ && !stores; ++m) {
      const CascadeRecord& reader = records[emitted_[m]];
      const bool is_follower = m == n + 1 && reader.source[1] == kNone;
      stores = is_live(emitted_[m]) && !is_follower && (reader.source[0] == i || reader.source[1] == i);
    }
    const bool adds = r.operation == Operation::add_vector;
    const bool skips = in_place && !stores && (adds || passes_through_at_zero(r));
    plain_parameter_[n] = r.parameter[0];
    link_[n] = static_cast<std::uint8_t>((follows ? kFollows : 0) | (in_place && adds ? kPlain : 0) |
                                         (stores ? kStores : 0) | (skips ? kSkips : 0));
  }
}

/// Whether the n-th sample of a point may be left out: a zero, or a vector that moves it by less than the slack.
bool Cascade::is_skipped(std::size_t n, Vec3 s, float slack_mm) const {
  if ((link_[n] & kSkips) == 0) return false;
  if (is_zero(s) || (link_[n] & kPlain) == 0) return is_zero(s);
  const Parameter& p = model_.parameters()[plain_parameter_[n]];
  const float most = max(magnitude(p.minimum), magnitude(p.maximum));
  return most * max(magnitude(s.x), max(magnitude(s.y), magnitude(s.z))) < slack_mm;
}

/// A run of samples that may be left out becomes a mark with its length, and what follows moves up: what is read of a
/// point lies together.
void Cascade::compact(Vec3* baked, float slack_mm) const {
  Vec3* to = baked;
  for (std::size_t n = 0; n < emitted_count_;) {
    std::size_t end = n;
    while (end < emitted_count_ && is_skipped(end, baked[end], slack_mm)) ++end;
    *to++ = end > n ? Vec3{kSkip, static_cast<float>(end - n), 0} : baked[n];
    n = end > n ? end : n + 1;
  }
}

/// A live record takes the first register whose value nobody reads after it; a source's own comes free that way.
void Cascade::assign_registers() {
  const auto records = model_.cascade();
  for (std::size_t n = 0; n < emitted_count_; ++n) {
    const std::uint16_t i = emitted_[n];
    last_reader_[i] = i == result_ ? kNone : i;
    if (is_live(i))
      for (const std::uint16_t s : records[i].source)
        if (s != kNone) last_reader_[s] = i;
  }
  for (std::size_t k = 0; k < register_count_; ++k) {
    register_[k].count = register_[k].busy_until = 0;
    for (std::size_t c = 0; c < column_count_; ++c) register_[k].touched[c] = 0;
  }
  for (std::size_t n = 0; n < emitted_count_; ++n) {
    const std::uint16_t i = emitted_[n];
    if (!is_live(i)) continue;
    std::uint16_t k = 0;
    while (register_[k].busy_until > i) ++k;
    register_of_[i] = k;
    register_[k].busy_until = last_reader_[i];
  }
}

std::size_t Cascade::sample_count() const {
  std::size_t count = 0;
  for (std::size_t n = 0; n < visited_count_; ++n) {
    const CascadeRecord& r = model_.cascade()[visited_[n]];
    count += visited_[n] == neutral_ ? 2 : r.field != kNone || r.weight != kNone ? 1 : 0;
  }
  return count;
}

void Cascade::add_column(Register& reg, std::uint16_t parameter, Vec3 derivative) {
  const std::uint16_t c = column_of_[parameter];
  if (c == kNone) return;
  if (reg.touched[c]) {
    reg.column[c] = reg.column[c] + derivative;
    return;
  }
  reg.touched[c] = 1;
  reg.column[c] = derivative;
  reg.list[reg.count++] = c;
}

/// Chain rule: maps the columns of the sources into the record's register, then adds its own.
void Cascade::propagate(std::size_t record, const FieldStep& f) {
  const CascadeRecord& r = model_.cascade()[record];
  Register& out = register_[register_of_[record]];
  const std::uint16_t first = r.source[0], second = r.source[1];
  const bool has_first = first != kNone && is_live(first), has_second = second != kNone && is_live(second);
  const Register* from = has_first ? &register_[register_of_[first]] : nullptr;
  const Register* also = has_second ? &register_[register_of_[second]] : nullptr;
  // Columns already in `out` stay there when it is a source's register; otherwise they are stale.
  const float keep_out = from == &out ? f.keep : f.keep_second;
  if (from != &out && also != &out) {
    for (std::size_t k = 0; k < out.count; ++k) out.touched[out.list[k]] = 0;
    out.count = 0;
  } else if (f.maps || keep_out != 1) {
    for (std::size_t k = 0; k < out.count; ++k) {
      Vec3& column = out.column[out.list[k]];
      column = f.maps ? f.map * column : keep_out * column;
    }
  }
  if (from != nullptr && from != &out)
    for (std::size_t k = 0; k < from->count; ++k) {
      const Vec3 column = from->column[from->list[k]];
      add_column(out, parameter_of_[from->list[k]], f.maps ? f.map * column : f.keep * column);
    }
  if (also != nullptr && also != &out)
    for (std::size_t k = 0; k < also->count; ++k)
      add_column(out, parameter_of_[also->list[k]], f.keep_second * also->column[also->list[k]]);
  for (int k = 0; k < 6; ++k)
    if (r.parameter[k] != kNone) add_column(out, r.parameter[k], f.along_parameter[k]);
}

template <bool kDerive>
Vec3 Cascade::run(const Vec3* baked, const float* q) {
  const auto records = model_.cascade();
  Vec3 p;                     // of the record before
  Register* reg = register_;  // and where its columns are
  for (std::size_t n = 0; n < emitted_count_; ++n) {
    const Vec3& s = *baked++;
    if (s.x == kSkip) {
      n += static_cast<std::size_t>(s.y) - 1;
      continue;
    }
    const unsigned link = link_[n];
    if ((link & kPlain) != 0) {
      const std::uint16_t parameter = plain_parameter_[n];
      p = p + q[parameter] * s;
      if (kDerive && !is_zero(s)) add_column(*reg, parameter, s);
      if ((link & kStores) == 0) continue;
    }
    const std::size_t i = emitted_[n];
    if ((link & kPlain) == 0 && !is_live(i)) {
      p = s;
    } else if ((link & kPlain) == 0) {
      const CascadeRecord& r = records[i];
      const Vec3 p0 = (link & kFollows) != 0 ? p : point_of_source(r, 0);
      const Vec3 p1 = point_of_source(r, 1);
      reg = &register_[register_of_[i]];
      if (kDerive) {
        const FieldStep f = apply(r, q, p0, p1, s);
        p = f.p;
        propagate(i, f);
      } else {
        p = applied(r, q, p0, p1, s);
      }
    }
    if ((link & kStores) != 0) point_[i] = p;
  }
  return point_[result_];
}

Vec3 Cascade::evaluate(const Vec3* baked, const float* q) {
  return run<false>(baked, q);
}

Vec3 Cascade::evaluate(const Vec3* baked, const float* q, Jacobian* jacobian) {
  for (std::size_t k = 0; k < register_count_; ++k) {
    Register& reg = register_[k];
    for (std::size_t c = 0; c < reg.count; ++c) reg.touched[reg.list[c]] = 0;
    reg.count = 0;
  }
  const Vec3 p = run<true>(baked, q);
  *jacobian = {};
  if (is_live(result_)) {
    Register& out = register_[register_of_[result_]];
    for (std::size_t k = 1; k < out.count; ++k)  // insertion sort: the list is short and nearly sorted
      for (std::size_t m = k; m > 0 && out.list[m] < out.list[m - 1]; --m) {
        const std::uint16_t other = out.list[m];
        out.list[m] = out.list[m - 1];
        out.list[m - 1] = other;
      }
    *jacobian = {out.column, out.list, out.count};
  }
  return p;
}

}  // namespace pliant
