#include "host/bake/table_writer.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

#include "host/bake/source_error.hpp"
#include "host/io/table_checksum.hpp"

namespace pliant::host::bake {

namespace {

void set_name(char (&target)[table::kNameBytes], const std::string& name) {
  check_name("table", 0, name);
  std::memset(target, 0, sizeof target);
  std::memcpy(target, name.data(), name.size());
}

struct Range {
  float lowest, highest;
};

Range range_of(const FieldGrid& grid, int component) {
  const auto n = static_cast<std::size_t>(grid.components);
  Range r{grid.samples[static_cast<std::size_t>(component)],
          grid.samples[static_cast<std::size_t>(component)]};
  for (std::size_t k = static_cast<std::size_t>(component); k < grid.samples.size(); k += n) {
    r.lowest = std::min(r.lowest, grid.samples[k]);
    r.highest = std::max(r.highest, grid.samples[k]);
  }
  return r;
}

template <class Integer>
void append_quantised(std::vector<std::uint8_t>& out, const FieldGrid& grid, const Field& field) {
  const auto n = static_cast<std::size_t>(grid.components);
  for (std::size_t k = 0; k < grid.samples.size(); ++k) {
    const std::size_t c = k % n;
    const float steps = field.scale[c] == 0 ? 0 : (grid.samples[k] - field.offset[c]) / field.scale[c];
    constexpr float kMost = sizeof(Integer) == 2 ? 32767.0f : 127.0f;
    const auto value = static_cast<Integer>(std::lround(std::clamp(steps, -kMost, kMost)));
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(&value);
    out.insert(out.end(), bytes, bytes + sizeof value);
  }
}

/// The sections of a table, one behind the other.
class Layout {
 public:
  explicit Layout(std::size_t section_count)
      : bytes_(sizeof(table::Header) + section_count * sizeof(table::Section)) {}

  template <class T>
  void add(table::Kind kind, const std::vector<T>& records) {
    add_bytes(kind, records.data(), records.size() * sizeof(T), records.size());
  }
  void add(table::Kind kind, const GreyImage& image) {
    std::vector<std::uint8_t> raw(8 + image.pixels.size());
    std::memcpy(raw.data(), &image.width, 4);
    std::memcpy(raw.data() + 4, &image.height, 4);
    std::copy(image.pixels.begin(), image.pixels.end(), raw.begin() + 8);
    add(kind, raw);
  }

  std::vector<std::uint8_t> finish() {
    const table::Header h{table::kMagic, table::kVersion, static_cast<std::uint32_t>(bytes_.size()), 0,
                          count_};
    std::memcpy(bytes_.data(), &h, sizeof h);
    set_checksum<table::Header>(bytes_);
    return std::move(bytes_);
  }

 private:
  void add_bytes(table::Kind kind, const void* data, std::size_t size, std::size_t count) {
    const table::Section s{kind, static_cast<std::uint32_t>(bytes_.size()),
                           static_cast<std::uint32_t>(count)};
    std::memcpy(bytes_.data() + sizeof(table::Header) + count_++ * sizeof s, &s, sizeof s);
    const auto* first = static_cast<const std::uint8_t*>(data);
    bytes_.insert(bytes_.end(), first, first + size);
    bytes_.resize((bytes_.size() + 3) / 4 * 4);
  }

  std::vector<std::uint8_t> bytes_;
  std::uint32_t count_ = 0;
};

}  // namespace

namespace {

std::vector<std::uint8_t> section_of(const SourceSprings& springs) {
  static_assert(sizeof(SourceSpring) == 12 && sizeof(Vec2) == 8, "file format");
  const std::uint32_t count[2] = {static_cast<std::uint32_t>(springs.points.size()),
                                  static_cast<std::uint32_t>(springs.springs.size())};
  const std::size_t points = springs.points.size() * sizeof(Vec2);
  std::vector<std::uint8_t> bytes(sizeof count + points + springs.springs.size() * sizeof(SourceSpring));
  std::memcpy(bytes.data(), count, sizeof count);
  std::memcpy(bytes.data() + sizeof count, springs.points.data(), points);
  std::memcpy(bytes.data() + sizeof count + points, springs.springs.data(),
              springs.springs.size() * sizeof(SourceSpring));
  return bytes;
}

}  // namespace

CascadeRecord empty_record(Operation operation) {
  CascadeRecord r{};
  r.operation = operation;
  r.source[0] = r.source[1] = kNone;
  for (std::uint16_t& p : r.parameter) p = kNone;
  r.field = r.weight = kNone;
  return r;
}

std::uint16_t TableWriter::add_parameter(const SourceParameter& source) {
  Parameter p{};
  set_name(p.name, source.name);
  p.group = source.group;
  p.minimum = source.minimum;
  p.maximum = source.maximum;
  p.sd = source.sd;
  parameters_.push_back(p);
  return static_cast<std::uint16_t>(parameters_.size() - 1);
}

std::uint16_t TableWriter::add_field(const FieldGrid& grid, int bits) {
  Field f{};
  f.width = static_cast<std::uint16_t>(grid.width);
  f.height = static_cast<std::uint16_t>(grid.height);
  f.components = static_cast<std::uint8_t>(grid.components);
  f.bits = static_cast<std::uint8_t>(bits);
  f.u0 = grid.u0;
  f.v0 = grid.v0;
  f.u1 = grid.u1;
  f.v1 = grid.v1;
  const float most = bits == 16 ? 32767.0f : 127.0f;
  for (int c = 0; c < grid.components; ++c) {
    const Range r = range_of(grid, c);
    f.offset[c] = grid.is_whole_chart() ? 0.5f * (r.lowest + r.highest) : 0;
    f.scale[c] = std::max(r.highest - f.offset[c], f.offset[c] - r.lowest) / most;
  }
  samples_.resize((samples_.size() + 3) / 4 * 4);
  f.first_byte = static_cast<std::uint32_t>(samples_.size());
  if (bits == 16)
    append_quantised<std::int16_t>(samples_, grid, f);
  else
    append_quantised<std::int8_t>(samples_, grid, f);
  fields_.push_back(f);
  return static_cast<std::uint16_t>(fields_.size() - 1);
}

std::uint16_t TableWriter::add_mirrored(std::uint16_t field) {
  Field f = fields_[field];
  f.mirror ^= 1;
  fields_.push_back(f);
  return static_cast<std::uint16_t>(fields_.size() - 1);
}

std::uint16_t TableWriter::add_record(const CascadeRecord& record) {
  cascade_.push_back(record);
  return static_cast<std::uint16_t>(cascade_.size() - 1);
}

void TableWriter::add_landmark(const SourceLandmark& source) {
  Landmark l{};
  set_name(l.name, source.name);
  l.u = source.uv.x;
  l.v = source.uv.y;
  landmarks_.push_back(l);
}

void TableWriter::add_curve(const SourceCurve& source) {
  Curve c{};
  set_name(c.name, source.name);
  c.kind = source.kind;
  c.first_point = static_cast<std::uint32_t>(curve_points_.size());
  c.point_count = static_cast<std::uint32_t>(source.points.size());
  curve_points_.insert(curve_points_.end(), source.points.begin(), source.points.end());
  curves_.push_back(c);
}

void TableWriter::set_base_mesh(std::vector<Vec2> uv, std::vector<std::uint16_t> corners) {
  base_uv_ = std::move(uv);
  base_corners_ = std::move(corners);
}

std::vector<std::uint8_t> TableWriter::bytes() const {
  const bool has_curves = !curves_.empty(), has_albedo = !albedo_.pixels.empty();
  const bool has_detector = !learnt_.detector.empty(), has_aligner = !learnt_.aligner.empty(),
             has_parts = !learnt_.parts.empty();
  Layout layout(8u + (has_curves ? 2u : 0u) + (has_albedo ? 1u : 0u) + (has_detector ? 1u : 0u) +
                (has_aligner ? 1u : 0u) + (has_parts ? 1u : 0u) + (print_.empty() ? 0u : 1u) +
                (springs_.springs.empty() ? 0u : 1u));
  layout.add(table::Kind::parameters, parameters_);
  layout.add(table::Kind::fields, fields_);
  layout.add(table::Kind::samples, samples_);
  layout.add(table::Kind::cascade, cascade_);
  layout.add(table::Kind::mask, mask_);
  layout.add(table::Kind::vertices, base_uv_);
  layout.add(table::Kind::faces, base_corners_);
  layout.add(table::Kind::landmarks, landmarks_);
  if (has_curves) {
    layout.add(table::Kind::curves, curves_);
    layout.add(table::Kind::curve_points, curve_points_);
  }
  if (has_albedo) layout.add(table::Kind::albedo, albedo_);
  if (has_detector) layout.add(table::Kind::detector, learnt_.detector);
  if (has_aligner) layout.add(table::Kind::aligner, learnt_.aligner);
  if (has_parts) layout.add(table::Kind::parts, learnt_.parts);
  if (!springs_.springs.empty()) layout.add(table::Kind::stretch, section_of(springs_));
  if (!print_.empty()) layout.add(table::Kind::print, print_);
  return layout.finish();
}

}  // namespace pliant::host::bake
