// Turns a mesh over the chart and its shapes into fields and a cascade.
#include <algorithm>

#include "host/bake/at.hpp"
#include "host/bake/bake.hpp"
#include "host/bake/base_mesh.hpp"
#include "host/bake/chart_raster.hpp"
#include "host/bake/opened_table.hpp"
#include "host/bake/print_keypoints.hpp"
#include "host/bake/shape_grids.hpp"
#include "host/bake/source_check.hpp"
#include "host/bake/source_error.hpp"
#include "host/bake/table_writer.hpp"
#include "host/io/numbers.hpp"

namespace pliant::host::bake {

namespace {

/// Tuning of what is accepted. Each constant: unit, reason, experiment.
struct RestShapeTuning {
  /// Largest errors of a rest shape that is a copy of the surface, fractions of its diagonal: at 95 % of the vertices, and at
  /// every vertex. Random charts are within a tenth of them.
  float most_off = 0.02f, most_off_anywhere = 0.1f;
};
constexpr RestShapeTuning kTuning{};

class Baker {
 public:
  Baker(const Source& source, const BakeOptions& options)
      : source_(source),
        options_(options),
        surface_(surface_vertices(source)),
        grids_(source, surface_, options.size, options.tolerance_mm) {}

  std::vector<std::uint8_t> run(BakeReport* report) {
    check_source(source_, options_.source);
    add_base_mesh();
    for (const SourceParameter& p : source_.parameters) writer_.add_parameter(p);
    add_neutral();
    for (std::size_t k = 0; k < source_.shapes.size(); ++k) {
      add_shape(k);
      if (options_.progress) options_.progress("shapes", k + 1, source_.shapes.size());
    }
    for (const SourceLandmark& l : source_.landmarks) writer_.add_landmark(l);
    for (const SourceCurve& c : source_.curves) writer_.add_curve(c);
    writer_.set_mask(grids_.mask());
    writer_.set_albedo(source_.albedo);
    writer_.set_learnt(source_.learnt);
    writer_.set_springs(source_.springs);
    auto bytes = writer_.bytes();
    report_.field_count = fields_.size() + 1;
    report_.table_bytes = bytes.size();
    const OpenedTable opened(bytes);
    if (opened.status() != Status::ok)
      fail(std::string("makes a table that cannot be opened: ") + text(opened.status()));
    if (!source_.base_corners.empty()) check_winding(opened.model());
    report_.errors = reconstruct(opened.model(), source_);
    check_rest_shape();
    if (source_.has_print) {
      auto print = make_print_table(opened.model());
      report_.has_texture = true;
      report_.print_bytes = print.size();
      writer_.set_print(std::move(print));
      bytes = writer_.bytes();
      report_.table_bytes = bytes.size();
    }
    if (report != nullptr) *report = report_;
    return bytes;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw SourceError(options_.source, 0, what); }

  void check_winding(const Model& model) const {
    const Span<const Vec2> uv = model.base_uv();
    const Span<const std::uint16_t> corners = model.base_corners();
    std::vector<std::array<int, 3>> triangles;
    for (std::size_t k = 0; k < corners.count; k += 3)
      triangles.push_back({corners[k], corners[k + 1], corners[k + 2]});
    for (const float area : chart_areas({uv.begin(), uv.end()}, triangles))
      if (!(area < 0))
        fail("has a base mesh with a triangle that has no area, or whose corners run clockwise seen from outside");
  }

  void check_rest_shape() const {
    const Distances& off = report_.errors.rest;
    const float diagonal = grids_.diagonal();
    if (off.p95_mm <= kTuning.most_off * diagonal && off.max_mm <= kTuning.most_off_anywhere * diagonal)
      return;
    throw SourceError(
        options_.source, 0,
        "the rest shape of the table would be off by " + number_text(static_cast<double>(off.p95_mm)) +
            " mm at 95 % of the vertices and " + number_text(static_cast<double>(off.max_mm)) +
            " mm at worst: give narrow parts more room in u,v (--relax-chart) or take a larger --size");
  }

  void add_base_mesh() {
    BaseMesh mesh{source_.base_uv, source_.base_corners};
    if (mesh.corners.empty()) mesh = make_base_mesh(source_, options_.base_vertices, source_.is_symmetric);
    if (mesh.corners.empty())
      fail("no base mesh of at most 9000 vertices follows the surface's boundary in the chart");
    report_.base_vertices = mesh.uv.size();
    report_.warnings = source_.warnings;
    for (std::string& line : tracking_warnings(source_, surface_))
      report_.warnings.push_back(std::move(line));
    writer_.set_base_mesh(mesh.uv, mesh.corners);
  }

  void add_neutral() {
    CascadeRecord r = empty_record(Operation::constant);
    r.field = writer_.add_field(grids_.rest_shape(), 16);
    last_ = writer_.add_record(r);
  }

  void add_shape(std::size_t k) {
    const SourceShape& shape = source_.shapes[k];
    const bool turns = !shape.weight.empty();
    CascadeRecord r = empty_record(turns               ? Operation::rotate
                                   : shape.second >= 0 ? Operation::product
                                                       : Operation::add_vector);
    r.source[0] = last_;
    r.parameter[0] = static_cast<std::uint16_t>(shape.parameter);
    if (shape.second >= 0) r.parameter[1] = static_cast<std::uint16_t>(shape.second);
    const std::uint16_t field = shape.mirror_of >= 0 ? writer_.add_mirrored(fields_[at(shape.mirror_of)])
                                                     : writer_.add_field(grids_.shape(shape), options_.bits);
    fields_.push_back(field);
    (turns ? r.weight : r.field) = field;
    const float axis[3] = {shape.axis.x, shape.axis.y, shape.axis.z},
                pivot[3] = {shape.pivot.x, shape.pivot.y, shape.pivot.z};
    if (turns) std::copy(axis, axis + 3, r.axis), std::copy(pivot, pivot + 3, r.pivot);
    last_ = writer_.add_record(r);
  }

  const Source& source_;
  const BakeOptions& options_;
  const std::vector<std::size_t> surface_;  // vertices
  const ShapeGrids grids_;
  TableWriter writer_;
  std::vector<std::uint16_t> fields_;  // of each shape
  std::uint16_t last_ = kNone;
  BakeReport report_;
};

}  // namespace

std::vector<std::uint8_t> bake_source(const Source& source, const BakeOptions& options, BakeReport* report) {
  return Baker(source, options).run(report);
}

}  // namespace pliant::host::bake
