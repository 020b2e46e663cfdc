// The cascade: runs the operations of a model over one point (the paper, section 3; Eq. 1-4), and carries their
// derivatives along (Eq. 11).
#include "field_step.hpp"
#include "pliant/field.hpp"

namespace pliant {

namespace {

bool is_zero(Vec3 v) {
  return v.x == 0 && v.y == 0 && v.z == 0;
}

Vec3 record_sample(const Model& model, const CascadeRecord& r, Vec2 uv) {
  const std::uint16_t field = r.field != kNone ? r.field : r.weight;
  return field == kNone ? Vec3{} : sample(model, model.fields()[field], uv);
}

}  // namespace

void Cascade::lay_out(Arena& arena, const Model& model) {
  model_ = model;
  const std::size_t records = model.cascade().count, parameters = model.parameters().count;
  parameter_of_ = arena.take<std::uint16_t>(parameters);
  column_of_ = arena.take<std::uint16_t>(parameters);
  live_ = arena.take<std::uint8_t>(records);
  folded_ = arena.take<std::uint8_t>(records);
  register_of_ = arena.take<std::uint8_t>(records);
  last_reader_ = arena.take<std::uint16_t>(records);
  selected_ = arena.take<std::uint16_t>(records);
  stands_for_ = arena.take<std::uint16_t>(records);
  selected_count_ = 0;
  point_ = arena.take<Vec3>(records);
  tangent_u_ = arena.take<Vec3>(records);
  tangent_v_ = arena.take<Vec3>(records);
  // As many registers as records that a later one reads out of turn, and one: enough for any choice of free ones.
  register_count_ = 1;
  for (std::size_t i = 0; i < records; ++i)
    for (std::uint16_t s : model.cascade()[i].source)
      if (s != kNone && s + 1u != i && register_count_ < kMaxRegisters) ++register_count_;
  for (std::size_t k = 0; k < register_count_; ++k)
    register_[k] = {arena.take<Vec3>(parameters), arena.take<std::uint16_t>(parameters),
                    arena.take<std::uint8_t>(parameters), 0};
  if (!arena.is_measuring()) set_all_free();
}

void Cascade::set_all_free() {
  for (std::size_t i = 0; i < parameter_count(); ++i) parameter_of_[i] = 0;
  column_count_ = 0;
  for (std::size_t i = 0; i < parameter_count(); ++i) {
    column_of_[i] = static_cast<std::uint16_t>(i);
    parameter_of_[i] = static_cast<std::uint16_t>(i);
  }
  column_count_ = parameter_count();
  assign_registers();
}

void Cascade::set_free(const std::uint8_t* is_free) {
  column_count_ = 0;
  for (std::size_t i = 0; i < parameter_count(); ++i) {
    column_of_[i] = is_free[i] ? static_cast<std::uint16_t>(column_count_) : kNone;
    if (is_free[i]) parameter_of_[column_count_++] = static_cast<std::uint16_t>(i);
  }
  assign_registers();
}

void Cascade::set_free(Group group) {
  column_count_ = 0;
  for (std::size_t i = 0; i < parameter_count(); ++i) {
    const bool is_free = model_.parameters()[i].group == group;
    column_of_[i] = is_free ? static_cast<std::uint16_t>(column_count_) : kNone;
    if (is_free) parameter_of_[column_count_++] = static_cast<std::uint16_t>(i);
  }
  assign_registers();
}

void Cascade::assign_registers() {
  const auto records = model_.cascade();
  for (std::size_t i = 0; i < records.count; ++i) {
    live_[i] = folded_[i] = 0;
    last_reader_[i] = static_cast<std::uint16_t>(i + 1 == records.count ? records.count : i);
    for (std::uint16_t p : records[i].parameter)
      if (p != kNone && column_of_[p] != kNone) live_[i] = 1;
    for (std::uint16_t s : records[i].source) {
      if (s == kNone) continue;
      if (live_[s]) live_[i] = 1;
      last_reader_[s] = static_cast<std::uint16_t>(i);
    }
  }
  baked_count_ = 0;
  std::uint16_t busy_until[kMaxRegisters] = {};
  for (std::size_t i = 0; i < records.count; ++i) {
    if (i + 1 == records.count && !is_live(i)) folded_[i] = 1;
    if (!is_live(i)) continue;
    for (std::uint16_t s : records[i].source)
      if (s != kNone && !is_live(s)) folded_[s] = 1;
    // The first register whose value nobody reads after this record; the source's own comes free here too.
    std::size_t k = 0;
    while (k + 1 < register_count_ && busy_until[k] > i) ++k;
    register_of_[i] = static_cast<std::uint8_t>(k);
    busy_until[k] = last_reader_[i];
  }
  for (std::size_t i = 0; i < records.count; ++i) baked_count_ += is_live(i) || folded_[i];
}

Vec3 Cascade::surface_point(Vec2 uv, const float* q) {
  select(q);
  return selected_point(uv);
}

void Cascade::select(const float* q) {
  const auto records = model_.cascade();
  selected_q_ = q;
  selected_count_ = 0;
  for (std::size_t i = 0; i < records.count; ++i) {
    const bool does_nothing = passes_through(records[i], q);
    stands_for_[i] = does_nothing ? stands_for_[records[i].source[0]] : static_cast<std::uint16_t>(i);
    if (!does_nothing) selected_[selected_count_++] = static_cast<std::uint16_t>(i);
  }
}

Vec3 Cascade::selected_point(Vec2 uv) {
  const auto records = model_.cascade();
  for (std::size_t k = 0; k < selected_count_; ++k) {
    const CascadeRecord& r = records[selected_[k]];
    const Vec3 p0 = r.source[0] == kNone ? Vec3{} : point_[stands_for_[r.source[0]]];
    const Vec3 p1 = r.source[1] == kNone ? Vec3{} : point_[stands_for_[r.source[1]]];
    const Vec3 s = record_sample(model_, r, uv);
    point_[selected_[k]] = r.operation == Operation::add_vector ? p0 + selected_q_[r.parameter[0]] * s
                           : r.operation == Operation::constant ? s
                                                                : apply(r, selected_q_, p0, p1, s).p;
  }
  return point_[stands_for_[records.count - 1]];
}

SurfaceFrame Cascade::surface_frame(Vec2 uv, const float* q) {
  const auto records = model_.cascade();
  for (std::size_t i = 0; i < records.count; ++i) {
    const CascadeRecord& r = records[i];
    if (passes_through(r, q)) {
      point_[i] = point_[r.source[0]];
      tangent_u_[i] = tangent_u_[r.source[0]];
      tangent_v_[i] = tangent_v_[r.source[0]];
      continue;
    }
    const std::uint16_t field = r.field != kNone ? r.field : r.weight;
    Vec3 su, sv, s;
    if (field != kNone) s = sample_with_gradient(model_, model_.fields()[field], uv, &su, &sv);
    const bool first = r.source[0] != kNone, second = r.source[1] != kNone;
    const FieldStep f =
        apply(r, q, first ? point_[r.source[0]] : Vec3{}, second ? point_[r.source[1]] : Vec3{}, s);
    const auto carry = [&](const Vec3* tangent, Vec3 along) {
      Vec3 t = first ? (f.maps ? f.map * tangent[r.source[0]] : f.keep * tangent[r.source[0]]) : Vec3{};
      if (second) t = t + f.keep_second * tangent[r.source[1]];
      return r.field != kNone ? t + f.along_field * along : t + along.x * f.along_weight;
    };
    const Vec3 tu = carry(tangent_u_, su), tv = carry(tangent_v_, sv);
    point_[i] = f.p;
    tangent_u_[i] = tu;
    tangent_v_[i] = tv;
  }
  const std::size_t last = records.count - 1;
  return {point_[last], tangent_u_[last], tangent_v_[last]};
}

void Cascade::bake(Vec2 uv, const float* q, Vec3* baked) {
  const auto records = model_.cascade();
  for (std::size_t i = 0; i < records.count; ++i) {
    const CascadeRecord& r = records[i];
    const Vec3 s = record_sample(model_, r, uv);
    if (is_live(i)) {
      *baked++ = s;
      continue;
    }
    const Vec3 p0 = r.source[0] == kNone ? Vec3{} : point_[r.source[0]];
    const Vec3 p1 = r.source[1] == kNone ? Vec3{} : point_[r.source[1]];
    point_[i] = apply(r, q, p0, p1, s).p;
    if (folded_[i]) *baked++ = point_[i];
  }
}

Vec3 Cascade::evaluate(const Vec3* baked, const float* q) {
  const auto records = model_.cascade();
  for (std::size_t i = 0; i < records.count; ++i) {
    if (!is_live(i)) {
      if (folded_[i]) point_[i] = *baked++;
      continue;
    }
    const CascadeRecord& r = records[i];
    const Vec3 s = *baked++;
    const Vec3 p0 = r.source[0] == kNone ? Vec3{} : point_[r.source[0]];
    if (r.operation == Operation::add_vector) {  // nearly all records; `step` would give the same
      point_[i] = p0 + q[r.parameter[0]] * s;
    } else if (is_zero(s) && passes_through_at_zero(r)) {
      point_[i] = p0;
    } else {
      point_[i] = apply(r, q, p0, r.source[1] == kNone ? Vec3{} : point_[r.source[1]], s).p;
    }
  }
  return point_[records.count - 1];
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

Vec3 Cascade::evaluate(const Vec3* baked, const float* q, Jacobian* jacobian) {
  const auto records = model_.cascade();
  for (std::size_t k = 0; k < register_count_; ++k) {
    register_[k].count = 0;
    for (std::size_t c = 0; c < column_count_; ++c) register_[k].touched[c] = 0;
  }
  for (std::size_t i = 0; i < records.count; ++i) {
    if (!is_live(i)) {
      if (folded_[i]) point_[i] = *baked++;
      continue;
    }
    const CascadeRecord& r = records[i];
    const Vec3 s = *baked++;
    const Vec3 p0 = r.source[0] == kNone ? Vec3{} : point_[r.source[0]];
    const bool same_register =
        r.source[0] != kNone && is_live(r.source[0]) && register_of_[r.source[0]] == register_of_[i];
    const bool nothing_yet =
        (r.source[0] == kNone || !is_live(r.source[0])) && register_[register_of_[i]].count == 0;
    if (is_zero(s) && passes_through_at_zero(r) && (same_register || nothing_yet)) {
      point_[i] = p0;
      continue;
    }
    const FieldStep f = apply(r, q, p0, r.source[1] == kNone ? Vec3{} : point_[r.source[1]], s);
    point_[i] = f.p;
    propagate(i, f);
  }
  const std::size_t last = records.count - 1;
  *jacobian = {};
  if (is_live(last)) {
    Register& out = register_[register_of_[last]];
    for (std::size_t k = 1; k < out.count; ++k)  // insertion sort: the list is short and nearly sorted
      for (std::size_t m = k; m > 0 && out.list[m] < out.list[m - 1]; --m) {
        const std::uint16_t other = out.list[m];
        out.list[m] = out.list[m - 1];
        out.list[m - 1] = other;
      }
    *jacobian = {out.column, out.list, out.count};
  }
  return point_[last];
}

}  // namespace pliant
