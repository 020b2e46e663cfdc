#pragma once
/// \file model.hpp
/// The model table (`.plm`): a deformable model as data, one little-endian block, aligned to 4 bytes, that is read in place.
/// `Model::open` checks every offset, count and range once; basic blocks, print, stretch and learnt sections when they are used.
///
/// The chart is (u,v) in [0,1]^2. Seen from outside the surface, v points down where u points right. On a face, u points to the
/// subject's left, and v = 0 is the top of the forehead.
///
/// Layout (docs/model-format.md): a Header, then `section_count` Sections, then their contents, each aligned to 4 bytes. The
/// records below are the file format: members are never reordered, and there is no padding.
#include <cstddef>
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/geometry.hpp"
#include "pliant/id_set.hpp"
#include "pliant/status.hpp"

namespace pliant {
namespace table {
/// "PLM1". Versions 3, 5 and 6 are unused: each differs from a used one in one bit.
constexpr std::uint32_t kMagic = 0x314d4c50, kVersion = 7;
constexpr std::size_t kNameBytes = 28;  ///< zero-padded, always ends in a zero

/// First bytes of a table.
struct Header {
  std::uint32_t magic, version;  ///< kMagic; 1, 2, 4 or kVersion
  std::uint32_t total_bytes;     ///< of the whole table
  std::uint32_t crc32;           ///< IEEE CRC-32 of everything behind this field, `total_bytes - 16` bytes
  std::uint32_t section_count;   ///< Sections that follow
};

/// Section kinds; a table has each at most once. Those from `curves` on may be missing. Version 1 ends at `albedo`.
enum class Kind : std::uint32_t {
  parameters = 1,
  fields = 2,
  samples = 3,
  cascade = 4,
  mask = 5,
  vertices = 6,
  faces = 7,
  landmarks = 8,
  curves = 9,
  curve_points = 10,
  albedo = 11,
  detector = 12,
  aligner = 13,
  stretch = 14,
  print = 15,
  parts = 16,
};

/// Position of one section in the table.
struct Section {
  Kind kind;             ///< contents of the section
  std::uint32_t offset;  ///< from the table's start, a multiple of 4
  std::uint32_t count;   ///< records, or bytes for samples and images
};
}  // namespace table

/// What a parameter describes: the person (identity), or what the face does (expression).
enum class Group : std::uint32_t { identity = 0, expression = 1 };

/// One entry of q. Identity is in standard deviations; expression runs from `minimum` to `maximum`, 0 at rest.
struct Parameter {
  char name[table::kNameBytes];  ///< ends in a zero
  Group group;                   ///< identity or expression
  float minimum, maximum;        ///< limits, -1e6 <= minimum <= 0 <= maximum <= 1e6
  float sd;                      ///< prior standard deviation around 0, in the parameter's unit, 1e-6 to 1e6
};

/// A vector field V(u,v) (three components) or weight field w(u,v) (one), sampled on a grid over a rectangle
/// of the chart and zero outside it. Sample (i,j) sits at u = u0 + i (u1 - u0) / (width - 1), v likewise;
/// rows from v0 to v1; components interleaved. Value of component c = offset[c] + scale[c] * integer, at most
/// 1e6 in magnitude. Unless the rectangle is the whole chart, its rim should decode to zero (offset zero; not checked).
struct Field {
  std::uint16_t width, height;  ///< samples, each at least 2
  std::uint8_t components;      ///< 1 or 3
  std::uint8_t bits;            ///< 8 or 16, signed
  std::uint8_t mirror;          ///< 1: V(u,v) = diag(-1,1,1) V_stored(1-u,v); a weight is w_stored(1-u,v)
  std::uint8_t reserved;        ///< 0
  float u0, v0, u1, v1;         ///< support rectangle inside [0,1]^2 of the *stored* samples
  float scale[3], offset[3];    ///< a component
  std::uint32_t first_byte;     ///< of its samples within the samples section; a multiple of 2 for 16 bits
};

/// Operations of the cascade. p is the point of the source record, w the weight field's value (1 without one), q the
/// parameter(s). Each gives its value and its Jacobian (docs/algorithms.md, section 3.1; the paper: Eq. 1-4, 11).
enum class Operation : std::uint32_t {
  constant = 0,    ///< p = V(u,v)                                        (Eq. 2, 3)
  add_vector = 1,  ///< p + q V(u,v)                                      (Eq. 4)
  product = 2,     ///< p + q_a q_b V(u,v), a corrective shape
  /// p + phi(q) V(u,v), phi a smooth ramp: 0 for q <= -h, q for q >= h, (q+h)^2/(4h) between, h = axis.x
  one_sided = 3,
  scale = 4,   ///< c + (1 + w q) (p - c), c = pivot
  rotate = 5,  ///< c + R(axis, w q) (p - c): jaw, eyeballs; q in radians, axis a unit vector
  affine = 6,  ///< p + w q (A p + b - p); A, b from the record's matrix
  rigid = 7,   ///< c + R(w r) (p - c) + w t; six parameters: rotation vector r, translation t
  lerp = 8,    ///< (1 - w q) p_0 + w q p_1 of two sources
};

/// One step of the cascade: reads the results of earlier records only. The last record's result is the surface point.
struct CascadeRecord {
  Operation operation;         ///< the operation
  std::uint16_t source[2];     ///< indices of earlier records; kNone where unused (constant uses none)
  std::uint16_t parameter[6];  ///< indices into q; kNone where unused
  std::uint16_t field;         ///< three components; kNone where unused
  std::uint16_t weight;        ///< one component; kNone means w = 1
  float axis[3];               ///< unit vector (rotate), or axis[0] = h (one_sided)
  float pivot[3];              ///< millimetres
  float matrix[12];            ///< affine: A by rows then b; zero otherwise
};

/// A named place on the surface.
struct Landmark {
  char name[table::kNameBytes];       ///< ends in a zero
  float u, v;                         ///< place on the surface
  Vec2 uv() const { return {u, v}; }  ///< the same as a vector
};

/// What a curve runs along.
enum class CurveKind : std::uint32_t { lid = 0, lip = 1, brow = 2, boundary = 3 };

/// A named polyline in (u,v), for the edge tracker and for drawing.
struct Curve {
  char name[table::kNameBytes];            ///< ends in a zero
  CurveKind kind;                          ///< kind of the curve
  std::uint32_t first_point, point_count;  ///< in curve_points (Vec2)
};

/// A grey image over the chart, first row at v = 0, last at v = 1; also the form of the domain mask, where 0 is outside
/// the surface (eyes, mouth, beyond the boundary) and any other value inside.
struct ChartImage {
  std::uint32_t width = 0, height = 0;   ///< pixels a row and rows
  const std::uint8_t* pixels = nullptr;  ///< first row at v = 0; null: no image
};
/// \cond  of the implementation
namespace table {
/// What the sections of a table hold, each as in Model. All pointers lead into the table.
struct Contents {
  Span<const Parameter> parameters;
  Span<const Field> fields;
  const std::uint8_t* samples = nullptr;
  Span<const CascadeRecord> cascade;
  Span<const Vec2> base_uv, curve_points;
  Span<const std::uint16_t> base_corners;
  Span<const Landmark> landmarks;
  Span<const Curve> curves;
  ChartImage mask, albedo;
  Span<const std::uint8_t> detector, aligner, parts, print, stretch;
  std::size_t bytes = 0;
  std::uint32_t crc = 0;
};
}  // namespace table
/// \endcond
/// IEEE CRC-32 (polynomial 0xEDB88320) of `bytes` bytes. `previous` is the sum of what comes before them. O(bytes).
std::uint32_t crc32(const void* data, std::size_t bytes, std::uint32_t previous = 0);
/// A read-only view of a checked model table. Copies are cheap; the table must outlive them.
class Model {
 public:
  Model() = default;  ///< A model that is not open: all counts are zero.
  /// Checks the table, and points `model` into it. Whatever opens is safe to use: every index is in range, every
  /// number is finite and at most 1e6 in its unit. Cost: one pass over the bytes for the CRC, then over the records.
  /// \param data, bytes  address, a multiple of 4, and at least the table's own size.
  /// \return bad_argument, misaligned, truncated, bad_magic, bad_version, bad_checksum, bad_table.
  static Status open(const void* data, std::size_t bytes, Model* model);
  bool is_open() const { return contents_.cascade.count > 0; }               ///< After open.
  Span<const Parameter> parameters() const { return contents_.parameters; }  ///< In order.
  Span<const Field> fields() const { return contents_.fields; }              ///< Vector and weight fields.
  const std::uint8_t* samples() const { return contents_.samples; }  ///< First byte of the samples section.
  Span<const CascadeRecord> cascade() const { return contents_.cascade; }  ///< Operations, in order.
  /// Base mesh: (u,v) of every vertex, and three corners a face: basic blocks, as Mesh::set_base checks.
  Span<const Vec2> base_uv() const { return contents_.base_uv; }
  Span<const std::uint16_t> base_corners() const { return contents_.base_corners; }  ///< Three a face.
  Span<const Landmark> landmarks() const { return contents_.landmarks; }             ///< Named places.
  Span<const Curve> curves() const { return contents_.curves; }                      ///< Named polylines.
  Span<const Vec2> curve_points() const { return contents_.curve_points; }  ///< Points of all curves.
  ChartImage mask() const { return contents_.mask; }                        ///< Where the chart is surface.
  ChartImage albedo() const { return contents_.albedo; }  ///< pixels are null when the table has none
  Span<const std::uint8_t> detector() const { return contents_.detector; }  ///< Learnt; may be empty.
  Span<const std::uint8_t> aligner() const { return contents_.aligner; }    ///< As detector.
  Span<const std::uint8_t> parts() const { return contents_.parts; }        ///< As detector.
  Span<const std::uint8_t> print() const { return contents_.print; }        ///< Keypoints; may be empty.
  Span<const std::uint8_t> stretch() const { return contents_.stretch; }    ///< Springs; may be empty.
  std::uint32_t crc() const { return contents_.crc; }  ///< CRC-32 of the table; names the model in files.
  std::size_t table_bytes() const { return contents_.bytes; }  ///< Size of the table.
  /// Index of the parameter or landmark with that name (not null), or kNone. O(count).
  std::uint16_t find_parameter(const char* name) const;
  std::uint16_t find_landmark(const char* name) const;  ///< The same of landmarks.
  /// Whether (u,v) lies on the surface by the nearest sample of the mask. False outside [0,1]^2, and when not open.
  bool is_on_surface(Vec2 uv) const;

 private:
  table::Contents contents_;
};
/// create_in refuses a model that is not open (arena.hpp).
inline bool is_usable(const Model& model) {
  return model.is_open();
}
}  // namespace pliant
