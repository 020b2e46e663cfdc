// Checks a model table in one pass. Nothing has to be checked again later.
#include "model/table_reader.hpp"

#include <cstring>

#include "model/chart.hpp"
#include "model/field_sampling.hpp"
#include "model/table_check.hpp"

namespace pliant {

namespace {

/// Any two versions differ in two bits, so that a flipped bit makes none of another.
bool is_known_version(std::uint32_t version) {
  return version == 1 || version == 2 || version == 4 || version == table::kVersion;
}

static_assert(sizeof(table::Header) == 20 && sizeof(table::Section) == 12, "file format");
static_assert(sizeof(Parameter) == 44 && sizeof(Field) == 52 && sizeof(CascadeRecord) == 96, "file format");
static_assert(sizeof(Landmark) == 36 && sizeof(Curve) == 40 && sizeof(Vec2) == 8, "file format");

// Limits of the format, besides those of the header.
constexpr std::size_t kMaxSections = 64;
constexpr std::size_t kMaxSide = 4096;  // samples or pixels
/// No sample, limit, pivot or matrix element is larger, in its unit (mm for positions: a kilometre). Samples and their sums then
/// stay below the marker that replaces samples (sampled_point.cpp); products of several `scale` or `affine` records may overflow.
constexpr float kMaxMagnitude = 1e6f;
/// Smallest side of a field's rectangle in (u,v): dividing by it keeps sample positions finite.
constexpr float kMinSupport = 1e-6f;
/// Smallest standard deviation: 1 / sd^2 is a weight.
constexpr float kMinSd = 1e-6f;

bool is_name(const char* name) {
  return name[0] != 0 && std::memchr(name, 0, table::kNameBytes) != nullptr;
}

bool are_bounded(const float* x, std::size_t n) {
  return are_within(x, n, -kMaxMagnitude, kMaxMagnitude);
}

bool are_in_chart(Span<const Vec2> uv) {
  for (const Vec2& p : uv)
    if (!is_in_chart(p)) return false;
  return true;
}

/// What an operation reads.
struct Operands {
  std::uint8_t sources, parameters;
  bool has_field;
};

constexpr Operands kOperands[] = {
    {0, 0, true},   // constant
    {1, 1, true},   // add_vector
    {1, 2, true},   // product
    {1, 1, true},   // one_sided
    {1, 1, false},  // scale
    {1, 1, false},  // rotate
    {1, 1, false},  // affine
    {1, 6, false},  // rigid
    {2, 1, false},  // lerp
};
static_assert(sizeof kOperands / sizeof *kOperands == static_cast<std::size_t>(Operation::lerp) + 1);

/// Fills the contents of a model while it checks them.
struct TableReader {
  const std::uint8_t* base;
  std::size_t bytes;
  table::Contents contents;

  /// \return the first record of a section; null where it is not within the table.
  [[gnu::noinline]] const void* first(const table::Section& s, std::size_t record_bytes) const {
    const bool is_inside =
        s.offset % 4 == 0 && s.offset <= bytes && s.count <= (bytes - s.offset) / record_bytes;
    return is_inside ? base + s.offset : nullptr;
  }

  template <class T>
  bool records(const table::Section& s, Span<const T>* out) const {
    *out = {static_cast<const T*>(first(s, sizeof(T))), s.count};
    return out->data != nullptr;
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

  bool read_section(const table::Section& s, Span<const std::uint8_t>* samples) {
    switch (s.kind) {
      case table::Kind::parameters:
        return records(s, &contents.parameters);
      case table::Kind::fields:
        return records(s, &contents.fields);
      case table::Kind::samples:
        return records(s, samples);
      case table::Kind::cascade:
        return records(s, &contents.cascade);
      case table::Kind::mask:
        return image(s, &contents.mask);
      case table::Kind::vertices:
        return records(s, &contents.base_uv);
      case table::Kind::faces:
        return records(s, &contents.base_corners);
      case table::Kind::landmarks:
        return records(s, &contents.landmarks);
      case table::Kind::curves:
        return records(s, &contents.curves);
      case table::Kind::curve_points:
        return records(s, &contents.curve_points);
      case table::Kind::albedo:
        return image(s, &contents.albedo);
      case table::Kind::detector:
        return records(s, &contents.detector);
      case table::Kind::aligner:
        return records(s, &contents.aligner);
      case table::Kind::stretch:
        return records(s, &contents.stretch);
      case table::Kind::print:
        return records(s, &contents.print);
      case table::Kind::parts:
        return records(s, &contents.parts);
    }
    return false;
  }

  bool check_parameters() const {
    const auto p = contents.parameters;
    if (p.count > table::kMaxParameters) return false;
    for (std::size_t i = 0; i < p.count; ++i) {
      const bool group = p[i].group == Group::identity || p[i].group == Group::expression;
      if (!is_name(p[i].name) || !group || !are_bounded(&p[i].minimum, 3)) return false;
      if (!(p[i].minimum <= 0 && p[i].maximum >= 0 && p[i].sd >= kMinSd)) return false;
      for (std::size_t k = 0; k < i; ++k)
        if (same_name(p[i].name, p[k].name)) return false;
    }
    return true;
  }

  static bool check_field(const Field& f, std::size_t sample_bytes) {
    const bool has_shape = f.width >= 2 && f.width <= kMaxSide && f.height >= 2 && f.height <= kMaxSide &&
                           (f.components == 1 || f.components == 3) && (f.bits == 8 || f.bits == 16) &&
                           f.mirror <= 1;
    if (!has_shape || !are_within(&f.u0, 4, 0, 1)) return false;
    if (!(f.u1 - f.u0 >= kMinSupport && f.v1 - f.v0 >= kMinSupport)) return false;
    for (int c = 0; c < 3; ++c)
      if (!(largest_value(f, c) <= kMaxMagnitude)) return false;
    const std::size_t bytes_each = f.bits / 8u;
    const std::size_t need = std::size_t{f.width} * f.height * f.components * bytes_each;
    return f.first_byte % bytes_each == 0 && f.first_byte <= sample_bytes &&
           need <= sample_bytes - f.first_byte;
  }

  bool check_fields(std::size_t sample_bytes) const {
    for (const Field& f : contents.fields)
      if (!check_field(f, sample_bytes)) return false;
    return true;
  }

  bool check_record(std::size_t i) const {
    const CascadeRecord& r = contents.cascade[i];
    const auto fields = contents.fields;
    if (r.operation > Operation::lerp) return false;
    const Operands& n = kOperands[static_cast<std::size_t>(r.operation)];
    for (int k = 0; k < 2; ++k)
      if (k < n.sources ? r.source[k] >= i : r.source[k] != kNone) return false;
    for (int k = 0; k < 6; ++k)
      if (k < n.parameters ? r.parameter[k] >= contents.parameters.count : r.parameter[k] != kNone)
        return false;
    if (n.has_field ? (r.field >= fields.count || fields[r.field].components != 3) : r.field != kNone)
      return false;
    if (r.weight != kNone && (n.has_field || r.weight >= fields.count || fields[r.weight].components != 1))
      return false;
    if (n.sources == 2 && r.source[0] == r.source[1]) return false;
    if (!are_bounded(r.axis, 3) || !are_bounded(r.pivot, 3) || !are_bounded(r.matrix, 12)) return false;
    if (r.operation == Operation::one_sided && !(r.axis[0] > 0)) return false;
    const float length2 = r.axis[0] * r.axis[0] + r.axis[1] * r.axis[1] + r.axis[2] * r.axis[2];
    return r.operation != Operation::rotate || (length2 > 0.999f && length2 < 1.001f);
  }

  bool check_cascade() const {
    const std::size_t n = contents.cascade.count;
    if (n < 1 || n > table::kMaxRecords) return false;
    for (std::size_t i = 0; i < n; ++i)
      if (!check_record(i)) return false;
    return true;
  }

  bool check_mesh() const {
    const auto uv = contents.base_uv;
    const auto corners = contents.base_corners;
    if (uv.count < 3 || uv.count >= kNone || corners.count < 3 || corners.count % 3 != 0 ||
        corners.count >= kNone)
      return false;
    if (!are_in_chart(uv)) return false;
    for (std::uint16_t c : corners)
      if (c >= uv.count) return false;
    return true;
  }

  bool check_names() const {
    if (contents.landmarks.count > table::kMaxLandmarks) return false;
    for (const Landmark& l : contents.landmarks)
      if (!is_name(l.name) || !is_in_chart(l.uv())) return false;
    if (!are_in_chart(contents.curve_points)) return false;
    for (const Curve& c : contents.curves) {
      const std::size_t points = contents.curve_points.count;
      if (!is_name(c.name) || c.kind > CurveKind::boundary || c.point_count < 2) return false;
      if (c.first_point > points || c.point_count > points - c.first_point) return false;
    }
    return true;
  }

  Status read_header(table::Header* h) {
    if (bytes < sizeof *h) return Status::truncated;
    std::memcpy(h, base, sizeof *h);
    if (h->magic != table::kMagic) return Status::bad_magic;
    if (!is_known_version(h->version)) return Status::bad_version;
    if (h->total_bytes > bytes) return Status::truncated;
    if (h->total_bytes < sizeof *h) return Status::bad_table;
    bytes = h->total_bytes;
    if (crc32(base + 16, bytes - 16) != h->crc32) return Status::bad_checksum;
    const bool has_room =
        h->section_count <= kMaxSections && sizeof *h + h->section_count * sizeof(table::Section) <= bytes;
    return has_room ? Status::ok : Status::bad_table;
  }

  bool read_sections(std::uint32_t count, Span<const std::uint8_t>* samples) {
    std::uint32_t seen = 0;  // a bit a kind
    for (std::uint32_t i = 0; i < count; ++i) {
      table::Section s;
      std::memcpy(&s, base + sizeof(table::Header) + i * sizeof s, sizeof s);
      const auto kind = static_cast<std::uint32_t>(s.kind);
      if (kind > 31 || (seen >> kind & 1u) || !read_section(s, samples)) return false;
      seen |= 1u << kind;
    }
    constexpr std::uint32_t kRequired = 0x1feu;  // parameters to landmarks
    return (seen & kRequired) == kRequired;
  }

  Status read() {
    table::Header h;
    const Status status = read_header(&h);
    if (status != Status::ok) return status;
    Span<const std::uint8_t> samples;
    if (!read_sections(h.section_count, &samples)) return Status::bad_table;
    if (!check_parameters() || !check_fields(samples.count) || !check_cascade() || !check_mesh() ||
        !check_names())
      return Status::bad_table;
    contents.samples = samples.data;
    contents.crc = h.crc32;
    contents.bytes = bytes;
    return Status::ok;
  }
};

}  // namespace

bool same_name(const char* a, const char* b) {
  return std::strncmp(a, b, table::kNameBytes) == 0;
}

Status read_table(const void* data, std::size_t bytes, table::Contents* contents) {
  TableReader reader{static_cast<const std::uint8_t*>(data), bytes, {}};
  const Status status = reader.read();
  if (status == Status::ok) *contents = reader.contents;
  return status;
}

}  // namespace pliant
