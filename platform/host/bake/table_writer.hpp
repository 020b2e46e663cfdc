#pragma once
/// \file table_writer.hpp
/// Collects the parts of a model table and writes its bytes (docs/model-format.md).
#include <vector>

#include "host/bake/field_grid.hpp"
#include "host/bake/source.hpp"
#include "host/io/learnt_file.hpp"
#include "pliant/model.hpp"

namespace pliant::host::bake {

class TableWriter {
 public:
  /// Throws SourceError for an empty name and one of more than 27 letters, as add_landmark and add_curve do.
  std::uint16_t add_parameter(const SourceParameter& parameter);
  /// Quantises a field to `bits` (8 or 16) with one scale a component; the error is at most half a scale. Only a field over the
  /// whole chart has an offset, so that any other decodes to exactly zero on its border.
  std::uint16_t add_field(const FieldGrid& grid, int bits);
  /// Adds the mirror image of an earlier field with the same samples.
  std::uint16_t add_mirrored(std::uint16_t field);
  std::uint16_t add_record(const CascadeRecord& record);
  void add_landmark(const SourceLandmark& landmark);
  void add_curve(const SourceCurve& curve);
  void set_base_mesh(std::vector<Vec2> uv, std::vector<std::uint16_t> corners);
  void set_mask(GreyImage mask) { mask_ = std::move(mask); }
  void set_albedo(GreyImage albedo) { albedo_ = std::move(albedo); }
  void set_springs(SourceSprings springs) { springs_ = std::move(springs); }
  void set_learnt(LearntTables learnt) { learnt_ = std::move(learnt); }
  void set_print(std::vector<std::uint8_t> print) { print_ = std::move(print); }

  /// The whole table with its checksum.
  std::vector<std::uint8_t> bytes() const;

 private:
  std::vector<Parameter> parameters_;
  std::vector<Field> fields_;
  std::vector<std::uint8_t> samples_;
  std::vector<CascadeRecord> cascade_;
  std::vector<Vec2> base_uv_;
  std::vector<std::uint16_t> base_corners_;
  std::vector<Landmark> landmarks_;
  std::vector<Curve> curves_;
  std::vector<Vec2> curve_points_;
  GreyImage mask_, albedo_;
  SourceSprings springs_;
  LearntTables learnt_;
  std::vector<std::uint8_t> print_;
};

/// A record without sources, parameters and fields.
CascadeRecord empty_record(Operation operation);

}  // namespace pliant::host::bake
