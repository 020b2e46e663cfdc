// Deformation fields (the paper, section 3). Every operation is one case of `step` below: its value, how it maps what
// it is applied to, and its derivatives along its own parameters and its own sample. Position, Jacobian (Eq. 11) and
// surface tangents all follow from these by the chain rule, so a new operation is written once.
#include "pliant/field.hpp"

#include <cstring>

namespace pliant {

namespace {

/// Where (u,v) falls in a field's grid: cell and position within it; `inside` false outside the support.
struct Cell {
  std::size_t i, j;
  float a, b;
  bool inside;
};

Cell locate(const Field& f, Vec2 uv) {
  const float u = clamp(uv.x, 0, 1), v = clamp(uv.y, 0, 1);
  const float x = ((f.mirror ? 1 - u : u) - f.u0) * (static_cast<float>(f.width - 1) / (f.u1 - f.u0));
  const float y = (v - f.v0) * (static_cast<float>(f.height - 1) / (f.v1 - f.v0));
  const float w = static_cast<float>(f.width - 1), h = static_cast<float>(f.height - 1);
  if (!(x >= 0 && x <= w && y >= 0 && y <= h)) return {0, 0, 0, 0, false};
  const auto i = x >= w - 1 ? f.width - 2u : static_cast<std::size_t>(x);
  const auto j = y >= h - 1 ? f.height - 2u : static_cast<std::size_t>(y);
  return {i, j, x - static_cast<float>(i), y - static_cast<float>(j), true};
}

/// One component of the four samples around a cell, decoded to integers held as float.
struct Corners {
  float s00, s10, s01, s11;
  float at(const Cell& cell) const {
    const float top = s00 + cell.a * (s10 - s00), bottom = s01 + cell.a * (s11 - s01);
    return top + cell.b * (bottom - top);
  }
  float along_u(const Cell& cell) const { return (s10 - s00) + cell.b * ((s11 - s01) - (s10 - s00)); }
  float along_v(const Cell& cell) const { return (s01 - s00) + cell.a * ((s11 - s10) - (s01 - s00)); }
};

template <class Integer>
void read_corners(const std::uint8_t* samples, const Field& f, const Cell& cell, Corners (&out)[3]) {
  const std::size_t n = f.components, row = std::size_t{f.width} * n;
  const std::uint8_t* p = samples + f.first_byte + (cell.j * row + cell.i * n) * sizeof(Integer);
  const auto read = [p](std::size_t k) {
    Integer value;
    std::memcpy(&value, p + k * sizeof(Integer), sizeof value);
    return static_cast<float>(value);
  };
  for (std::size_t c = 0; c < n; ++c) out[c] = {read(c), read(n + c), read(row + c), read(row + n + c)};
}

Vec3 sample_cell(const Model& model, const Field& f, Vec2 uv, Vec3* du, Vec3* dv) {
  const Cell cell = locate(f, uv);
  if (du != nullptr) *du = *dv = {};
  if (!cell.inside) return {};
  Corners s[3] = {};
  if (f.bits == 16)
    read_corners<std::int16_t>(model.samples(), f, cell, s);
  else
    read_corners<std::int8_t>(model.samples(), f, cell, s);
  const bool flips = f.mirror && f.components == 3;
  const float sx = flips ? -f.scale[0] : f.scale[0], ox = flips ? -f.offset[0] : f.offset[0];
  if (du != nullptr) {
    const float per_u = static_cast<float>(f.width - 1) / (f.u1 - f.u0) * (f.mirror ? -1.0f : 1.0f);
    const float per_v = static_cast<float>(f.height - 1) / (f.v1 - f.v0);
    *du = {sx * s[0].along_u(cell) * per_u, f.scale[1] * s[1].along_u(cell) * per_u,
           f.scale[2] * s[2].along_u(cell) * per_u};
    *dv = {sx * s[0].along_v(cell) * per_v, f.scale[1] * s[1].along_v(cell) * per_v,
           f.scale[2] * s[2].along_v(cell) * per_v};
  }
  if (f.components == 1) return {f.offset[0] + f.scale[0] * s[0].at(cell), 0, 0};
  return {ox + sx * s[0].at(cell), f.offset[1] + f.scale[1] * s[1].at(cell),
          f.offset[2] + f.scale[2] * s[2].at(cell)};
}

}  // namespace

Vec3 sample(const Model& model, const Field& field, Vec2 uv) {
  return sample_cell(model, field, uv, nullptr, nullptr);
}

Vec3 sample_with_gradient(const Model& model, const Field& field, Vec2 uv, Vec3* du, Vec3* dv) {
  return sample_cell(model, field, uv, du, dv);
}

/// One record applied to one point.
struct FieldStep {
  Vec3 p;          ///< the result
  Mat3 map;        ///< dp/dp_source; only read when `maps`
  float keep = 1;  ///< otherwise dp/dp_source = keep * I
  bool maps = false;
  float keep_second = 0;    ///< dp/dp of the second source (lerp)
  Vec3 along_parameter[6];  ///< dp/dq of the record's own parameters
  float along_field = 0;    ///< dp/dV = along_field * I
  Vec3 along_weight;        ///< dp/dw
};

namespace {

constexpr Mat3 kIdentity{};

Mat3 blend_with_identity(const Mat3& a, float s) {  // I + s (A - I)
  Mat3 m;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) m.m[i][k] = kIdentity.m[i][k] + s * (a.m[i][k] - kIdentity.m[i][k]);
  return m;
}

/// Smooth ramp: 0 below -h, the identity above h, a parabola between.
float ramp(float x, float h, float* slope) {
  if (x <= -h) {
    *slope = 0;
    return 0;
  }
  if (x >= h) {
    *slope = 1;
    return x;
  }
  *slope = (x + h) / (2 * h);
  return (x + h) * (x + h) / (4 * h);
}

/// Left Jacobian of the rotation vector w applied to e: d exp(w) along e, as a rotation of the result.
Vec3 left_jacobian(Vec3 w, Vec3 e) {
  const float t2 = dot(w, w);
  float b = 0.5f - t2 / 24, c = 1.0f / 6 - t2 / 120;
  if (t2 > 1e-2f) {
    const Quat q = exp_rotation(w);
    const float s2 = (q.x * q.x + q.y * q.y + q.z * q.z) / t2;  // (sin(t/2)/t)^2
    b = 2 * s2;
    c = (1 - 2 * square_root(s2) * q.w) / t2;
  }
  const Vec3 we = cross(w, e);
  return e + b * we + c * cross(w, we);
}

FieldStep step(const CascadeRecord& r, const float* q, Vec3 p0, Vec3 p1, Vec3 s) {
  FieldStep out;
  const Vec3 pivot{r.pivot[0], r.pivot[1], r.pivot[2]}, axis{r.axis[0], r.axis[1], r.axis[2]};
  const auto value = [&](int k) { return q[r.parameter[k]]; };
  const float w = r.weight == kNone ? 1.0f : s.x;
  switch (r.operation) {
    case Operation::constant:  // Eq. 2, 3
      out.p = s;
      out.keep = 0;
      out.along_field = 1;
      break;
    case Operation::add_vector:  // Eq. 4
      out.p = p0 + value(0) * s;
      out.along_parameter[0] = s;
      out.along_field = value(0);
      break;
    case Operation::product:
      out.p = p0 + (value(0) * value(1)) * s;
      out.along_parameter[0] = value(1) * s;
      out.along_parameter[1] = value(0) * s;
      out.along_field = value(0) * value(1);
      break;
    case Operation::one_sided: {
      float slope;
      out.along_field = ramp(value(0), r.axis[0], &slope);
      out.p = p0 + out.along_field * s;
      out.along_parameter[0] = slope * s;
      break;
    }
    case Operation::scale:
      out.keep = 1 + w * value(0);
      out.p = pivot + out.keep * (p0 - pivot);
      out.along_parameter[0] = w * (p0 - pivot);
      out.along_weight = value(0) * (p0 - pivot);
      break;
    case Operation::rotate: {
      out.map = rotation_matrix(exp_rotation((w * value(0)) * axis));
      out.maps = true;
      const Vec3 arm = out.map * (p0 - pivot), turn = cross(axis, arm);
      out.p = pivot + arm;
      out.along_parameter[0] = w * turn;
      out.along_weight = value(0) * turn;
      break;
    }
    case Operation::affine: {
      Mat3 a;
      for (int i = 0; i < 9; ++i) a.m[i / 3][i % 3] = r.matrix[i];
      const Vec3 pull = a * p0 + Vec3{r.matrix[9], r.matrix[10], r.matrix[11]} - p0;
      out.map = blend_with_identity(a, w * value(0));
      out.maps = true;
      out.p = p0 + (w * value(0)) * pull;
      out.along_parameter[0] = w * pull;
      out.along_weight = value(0) * pull;
      break;
    }
    case Operation::rigid: {
      const Vec3 turn{value(0), value(1), value(2)}, move{value(3), value(4), value(5)};
      out.map = rotation_matrix(exp_rotation(w * turn));
      out.maps = true;
      const Vec3 arm = out.map * (p0 - pivot);
      out.p = pivot + arm + w * move;
      const Vec3 unit[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
      for (int k = 0; k < 3; ++k) {
        out.along_parameter[k] = w * cross(left_jacobian(w * turn, unit[k]), arm);
        out.along_parameter[3 + k] = w * unit[k];
      }
      out.along_weight = cross(turn, arm) + move;
      break;
    }
    case Operation::lerp: {
      const float t = w * value(0);
      out.p = (1 - t) * p0 + t * p1;
      out.keep = 1 - t;
      out.keep_second = t;
      out.along_parameter[0] = w * (p1 - p0);
      out.along_weight = value(0) * (p1 - p0);
      break;
    }
  }
  return out;
}

bool is_zero(Vec3 v) {
  return v.x == 0 && v.y == 0 && v.z == 0;
}

/// True where a record whose sample is zero leaves its source as it is, so that it can be skipped.
bool passes_through_at_zero(const CascadeRecord& r) {
  return r.source[1] == kNone && (r.field != kNone ? r.operation != Operation::constant : r.weight != kNone);
}

/// True where a record leaves its source as it is because its parameters are 0.
bool passes_through(const CascadeRecord& r, const float* q) {
  switch (r.operation) {
    case Operation::constant:
    case Operation::one_sided:
    case Operation::lerp:
      return false;
    case Operation::product:
      return q[r.parameter[0]] * q[r.parameter[1]] == 0;
    case Operation::rigid:
      for (std::uint16_t p : r.parameter)
        if (q[p] != 0) return false;
      return true;
    default:
      return q[r.parameter[0]] == 0;
  }
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
  const auto records = model_.cascade();
  for (std::size_t i = 0; i < records.count; ++i) {
    const CascadeRecord& r = records[i];
    const Vec3 p0 = r.source[0] == kNone ? Vec3{} : point_[r.source[0]];
    if (passes_through(r, q)) {
      point_[i] = p0;
      continue;
    }
    const Vec3 p1 = r.source[1] == kNone ? Vec3{} : point_[r.source[1]];
    point_[i] = step(r, q, p0, p1, record_sample(model_, r, uv)).p;
  }
  return point_[records.count - 1];
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
        step(r, q, first ? point_[r.source[0]] : Vec3{}, second ? point_[r.source[1]] : Vec3{}, s);
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
    point_[i] = step(r, q, p0, p1, s).p;
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
      point_[i] = step(r, q, p0, r.source[1] == kNone ? Vec3{} : point_[r.source[1]], s).p;
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
    const FieldStep f = step(r, q, p0, r.source[1] == kNone ? Vec3{} : point_[r.source[1]], s);
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
