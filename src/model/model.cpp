// The model table: one pass that checks everything, so that nothing needs checking afterwards (DESIGN: tables).
#include "pliant/model.hpp"

#include <cstring>

namespace pliant {

std::uint32_t crc32(const void* data, std::size_t bytes, std::uint32_t previous) {
  // A nibble at a time: 64 bytes of table instead of 1 KiB, fast enough for a table read once.
  std::uint32_t nibble[16];
  for (std::uint32_t i = 0; i < 16; ++i) {
    std::uint32_t c = i;
    for (int k = 0; k < 4; ++k) c = (c & 1u) ? 0xedb88320u ^ (c >> 1) : c >> 1;
    nibble[i] = c;
  }
  const auto* p = static_cast<const std::uint8_t*>(data);
  std::uint32_t c = ~previous;
  for (std::size_t i = 0; i < bytes; ++i) {
    c ^= p[i];
    c = nibble[c & 15u] ^ (c >> 4);
    c = nibble[c & 15u] ^ (c >> 4);
  }
  return ~c;
}

namespace {

static_assert(sizeof(table::Header) == 20 && sizeof(table::Section) == 12, "file format");
static_assert(sizeof(Parameter) == 44 && sizeof(Field) == 52 && sizeof(CascadeRecord) == 96, "file format");
static_assert(sizeof(Landmark) == 36 && sizeof(Curve) == 40 && sizeof(Vec2) == 8, "file format");

constexpr std::size_t kMaxParameters = 192;
constexpr std::size_t kMaxRecordCount = 320;
constexpr std::size_t kMaxSide = 4096;

bool is_name(const char* name) {
  return name[0] != 0 && std::memchr(name, 0, table::kNameBytes) != nullptr;
}

bool same_name(const char* a, const char* b) {
  return std::strncmp(a, b, table::kNameBytes) == 0;
}

bool in_unit(float x) {
  return x >= 0 && x <= 1;
}  // false for NaN

bool all_finite(const float* x, int n) {
  for (int i = 0; i < n; ++i)
    if (!is_finite(x[i])) return false;
  return true;
}

}  // namespace

/// Fills a Model while it checks; a friend, so that Model itself stays read-only.
struct ModelOpener {
  const std::uint8_t* base;
  std::size_t bytes;
  Model model;

  template <class T>
  bool records(const table::Section& s, Span<const T>* out) {
    if (s.offset % 4 != 0 || s.offset > bytes || s.count > (bytes - s.offset) / sizeof(T)) return false;
    *out = {reinterpret_cast<const T*>(base + s.offset), s.count};
    return true;
  }

  bool image(const table::Section& s, ChartImage* out) {
    Span<const std::uint8_t> raw;
    if (!records(s, &raw) || raw.count < 8) return false;
    std::uint32_t side[2];
    std::memcpy(side, raw.data, sizeof side);
    if (side[0] < 1 || side[0] > kMaxSide || side[1] < 1 || side[1] > kMaxSide) return false;
    if (std::size_t{side[0]} * side[1] != raw.count - 8) return false;
    *out = {side[0], side[1], raw.data + 8};
    return true;
  }

  bool section(const table::Section& s, Span<const std::uint8_t>* samples) {
    switch (s.kind) {
      case table::Kind::parameters:
        return records(s, &model.parameters_);
      case table::Kind::fields:
        return records(s, &model.fields_);
      case table::Kind::samples:
        return records(s, samples);
      case table::Kind::cascade:
        return records(s, &model.cascade_);
      case table::Kind::mask:
        return image(s, &model.mask_);
      case table::Kind::vertices:
        return records(s, &model.base_uv_);
      case table::Kind::faces:
        return records(s, &model.base_corners_);
      case table::Kind::landmarks:
        return records(s, &model.landmarks_);
      case table::Kind::curves:
        return records(s, &model.curves_);
      case table::Kind::curve_points:
        return records(s, &model.curve_points_);
      case table::Kind::albedo:
        return image(s, &model.albedo_);
    }
    return false;
  }

  bool check_parameters() const {
    const auto p = model.parameters();
    if (p.count > kMaxParameters) return false;
    for (std::size_t i = 0; i < p.count; ++i) {
      const bool group = p[i].group == Group::identity || p[i].group == Group::expression;
      if (!is_name(p[i].name) || !group || !all_finite(&p[i].minimum, 3)) return false;
      if (!(p[i].minimum <= 0 && p[i].maximum >= 0 && p[i].sd > 0)) return false;
      for (std::size_t k = 0; k < i; ++k)
        if (same_name(p[i].name, p[k].name)) return false;
    }
    return true;
  }

  bool check_fields(std::size_t sample_bytes) const {
    for (const Field& f : model.fields()) {
      const bool shape = f.width >= 2 && f.width <= kMaxSide && f.height >= 2 && f.height <= kMaxSide &&
                         (f.components == 1 || f.components == 3) && (f.bits == 8 || f.bits == 16) &&
                         f.mirror <= 1;
      if (!shape || !in_unit(f.u0) || !in_unit(f.v0) || !in_unit(f.u1) || !in_unit(f.v1)) return false;
      if (!(f.u0 < f.u1 && f.v0 < f.v1) || !all_finite(f.scale, 3) || !all_finite(f.offset, 3)) return false;
      const std::size_t need = std::size_t{f.width} * f.height * f.components * (f.bits / 8u);
      if (f.first_byte % (f.bits / 8u) != 0 || f.first_byte > sample_bytes ||
          need > sample_bytes - f.first_byte)
        return false;
    }
    return true;
  }

  bool check_record(std::size_t i) const {
    const CascadeRecord& r = model.cascade()[i];
    struct Needs {
      int sources, parameters;
      bool field;
    };
    Needs n{1, 1, false};
    switch (r.operation) {
      case Operation::constant:
        n = {0, 0, true};
        break;
      case Operation::add_vector:
      case Operation::one_sided:
        n = {1, 1, true};
        break;
      case Operation::product:
        n = {1, 2, true};
        break;
      case Operation::scale:
      case Operation::rotate:
      case Operation::affine:
        break;
      case Operation::rigid:
        n = {1, 6, false};
        break;
      case Operation::lerp:
        n = {2, 1, false};
        break;
      default:
        return false;
    }
    for (int k = 0; k < 2; ++k)
      if (k < n.sources ? r.source[k] >= i : r.source[k] != kNone) return false;
    for (int k = 0; k < 6; ++k)
      if (k < n.parameters ? r.parameter[k] >= model.parameters().count : r.parameter[k] != kNone)
        return false;
    const auto fields = model.fields();
    if (n.field ? (r.field >= fields.count || fields[r.field].components != 3) : r.field != kNone)
      return false;
    if (r.weight != kNone && (n.field || r.weight >= fields.count || fields[r.weight].components != 1))
      return false;
    if (n.sources == 2 && r.source[0] == r.source[1]) return false;
    if (!all_finite(r.axis, 3) || !all_finite(r.pivot, 3) || !all_finite(r.matrix, 12)) return false;
    if (r.operation == Operation::one_sided && !(r.axis[0] > 0)) return false;
    const float a2 = r.axis[0] * r.axis[0] + r.axis[1] * r.axis[1] + r.axis[2] * r.axis[2];
    return r.operation != Operation::rotate || (a2 > 0.999f && a2 < 1.001f);
  }

  bool check_cascade() const {
    const std::size_t n = model.cascade().count;
    if (n < 1 || n > kMaxRecordCount) return false;
    for (std::size_t i = 0; i < n; ++i)
      if (!check_record(i)) return false;
    return true;
  }

  bool check_mesh() const {
    const auto uv = model.base_uv();
    const auto corners = model.base_corners();
    if (uv.count < 3 || uv.count >= kNone || corners.count < 3 || corners.count % 3 != 0 ||
        corners.count >= kNone)
      return false;
    for (Vec2 p : uv)
      if (!in_unit(p.x) || !in_unit(p.y)) return false;
    for (std::uint16_t c : corners)
      if (c >= uv.count) return false;
    return true;
  }

  bool check_names() const {
    for (const Landmark& l : model.landmarks())
      if (!is_name(l.name) || !in_unit(l.u) || !in_unit(l.v)) return false;
    for (Vec2 p : model.curve_points())
      if (!in_unit(p.x) || !in_unit(p.y)) return false;
    for (const Curve& c : model.curves()) {
      const std::size_t points = model.curve_points().count;
      if (!is_name(c.name) || c.kind > CurveKind::boundary || c.point_count < 2) return false;
      if (c.first_point > points || c.point_count > points - c.first_point) return false;
    }
    return true;
  }

  Status run() {
    table::Header h;
    if (bytes < sizeof h) return Status::truncated;
    std::memcpy(&h, base, sizeof h);
    if (h.magic != table::kMagic) return Status::bad_magic;
    if (h.version != table::kVersion) return Status::bad_version;
    if (h.total_bytes > bytes) return Status::truncated;
    if (h.total_bytes < sizeof h) return Status::bad_table;
    bytes = h.total_bytes;
    if (crc32(base + 16, bytes - 16) != h.crc32) return Status::bad_checksum;
    if (h.section_count > 64 || sizeof h + h.section_count * sizeof(table::Section) > bytes)
      return Status::bad_table;
    Span<const std::uint8_t> samples;
    std::uint32_t seen = 0;
    for (std::uint32_t i = 0; i < h.section_count; ++i) {
      table::Section s;
      std::memcpy(&s, base + sizeof h + i * sizeof s, sizeof s);
      const auto kind = static_cast<std::uint32_t>(s.kind);
      if (kind > 31 || (seen >> kind & 1u) || !section(s, &samples)) return Status::bad_table;
      seen |= 1u << kind;
    }
    constexpr std::uint32_t kRequired = 0x1feu;  // sections 1 to 8
    if ((seen & kRequired) != kRequired) return Status::bad_table;
    if (!check_parameters() || !check_fields(samples.count) || !check_cascade() || !check_mesh() ||
        !check_names())
      return Status::bad_table;
    model.samples_ = samples.data;
    model.crc_ = h.crc32;
    model.bytes_ = bytes;
    return Status::ok;
  }
};

Status Model::open(const void* data, std::size_t bytes, Model* model) {
  if (data == nullptr || model == nullptr) return Status::bad_argument;
  if (reinterpret_cast<std::uintptr_t>(data) % 4 != 0) return Status::misaligned;
  ModelOpener opener{static_cast<const std::uint8_t*>(data), bytes, {}};
  const Status status = opener.run();
  if (status == Status::ok) *model = opener.model;
  return status;
}

std::uint16_t Model::find_parameter(const char* name) const {
  for (std::size_t i = 0; i < parameters_.count; ++i)
    if (same_name(parameters_[i].name, name)) return static_cast<std::uint16_t>(i);
  return kNone;
}

std::uint16_t Model::find_landmark(const char* name) const {
  for (std::size_t i = 0; i < landmarks_.count; ++i)
    if (same_name(landmarks_[i].name, name)) return static_cast<std::uint16_t>(i);
  return kNone;
}

bool Model::is_on_surface(Vec2 uv) const {
  if (!(in_unit(uv.x) && in_unit(uv.y))) return false;
  const auto i = static_cast<std::size_t>(uv.x * static_cast<float>(mask_.width - 1) + 0.5f);
  const auto j = static_cast<std::size_t>(uv.y * static_cast<float>(mask_.height - 1) + 0.5f);
  return mask_.pixels[j * mask_.width + i] != 0;
}

}  // namespace pliant
