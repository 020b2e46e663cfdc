// Turns a mesh over the chart and its shapes into fields and a cascade: sample each shape on a grid, crop the grid, choose
// its resolution, quantise.
#include <algorithm>
#include <cmath>

#include "host/bake/at.hpp"
#include "host/bake/bake.hpp"
#include "host/bake/base_mesh.hpp"
#include "host/bake/field_grid.hpp"
#include "host/bake/grid_fit.hpp"
#include "host/bake/landmark_names.hpp"
#include "host/bake/opened_table.hpp"
#include "host/bake/print_keypoints.hpp"
#include "host/bake/source_error.hpp"
#include "host/bake/table_writer.hpp"
#include "host/io/bounding_box.hpp"
#include "host/io/numbers.hpp"
#include "host/io/track_table.hpp"
#include "model/table_reader.hpp"

namespace pliant::host::bake {

namespace {

/// Tuning of the fields' resolution. Each constant: unit, reason, experiment.
struct FieldTuning {
  /// Samples on a side of the coarsest grid, count. Fewer cannot hold the support of a lip or a lid. Round value, not tuned.
  int least_side = 16;
  /// Standard deviations at which the error of an identity is judged. Two cover 95 % of people.
  float identity_sds = 2;
  /// Distance from the axis at which the error of a rotation's weight is judged, millimetres: the chin's from the jaw's hinge.
  float rotation_arm_mm = 80;
  /// Motion below which a sample counts as zero, millimetres, at the parameter's largest value. Grids are cropped to the
  /// other samples. A tenth of the tolerance, so that the error of cropping is negligible. Not tuned further.
  float still_mm = 0.004f;
  /// Diagonal of a surface for which these lengths and the tolerance hold, millimetres, up to ten times as much. Those of a
  /// surface ten times as large are ten times as large.
  float diagonal_mm = 100;
  /// Largest errors of a rest shape that is a copy of the surface, fractions of its diagonal: at 95 % of the vertices, and at
  /// every vertex. Random charts are within a tenth of them.
  float most_off = 0.02f, most_off_anywhere = 0.1f;
  /// Diagonal below which a user is warned, millimetres. A camera is 50 mm or more from what it tracks, and sheets of 40, 20 and
  /// 10 mm that fill a third of the frame were found in 39, 27 and 0 of 40 frames.
  float least_tracked_mm = 30;
  /// Distance of the surface's middle from the origin, in diagonals, above which a user is warned. With 1.5 a sheet was tracked in
  /// all frames, with 25 in 83 of 100; one 5 diagonals in front of its origin was not found, since that was behind the camera.
  float most_off_origin = 3;
};
constexpr FieldTuning kTuning{};

class Baker {
 public:
  Baker(const Source& source, const BakeOptions& options)
      : source_(source),
        options_(options),
        places_(fit_places(source.uv, source.triangles, source.is_hole, options.size)) {
    for (int side = options.size; side >= kTuning.least_side; side = (side + 1) / 2)
      rasters_.push_back(raster(side));
    is_on_surface_.assign(source.uv.size(), 0);
    for (std::size_t f = 0; f < source.triangles.size(); ++f)
      if (!source.is_hole[f])
        for (int v : source.triangles[f]) is_on_surface_[at(v)] = 1;
    diagonal_ = diagonal();
    while (diagonal_ > 10 * kTuning.diagonal_mm * scale_) scale_ *= 10;
    while (diagonal_ < kTuning.diagonal_mm * scale_ && scale_ > 1e-6f) scale_ /= 10;
  }

  std::vector<std::uint8_t> run(BakeReport* report) {
    check_source();
    add_base_mesh();
    for (const SourceParameter& p : source_.parameters) writer_.add_parameter(p);
    add_neutral();
    for (std::size_t k = 0; k < source_.shapes.size(); ++k) {
      add_shape(k);
      if (options_.progress) options_.progress("shapes", k + 1, source_.shapes.size());
    }
    for (const SourceLandmark& l : source_.landmarks) writer_.add_landmark(l);
    for (const SourceCurve& c : source_.curves) writer_.add_curve(c);
    writer_.set_mask(mask());
    writer_.set_albedo(source_.albedo);
    writer_.set_learnt(source_.learnt);
    writer_.set_springs(source_.springs);
    auto bytes = writer_.bytes();
    report_.field_count = fields_.size() + 1;
    report_.table_bytes = bytes.size();
    const OpenedTable opened(bytes);
    if (opened.status() != Status::ok)
      fail(std::string("makes a table that cannot be opened: ") + text(opened.status()));
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
  ChartRaster raster(int side) const {
    return rasterise(source_.uv, source_.triangles, source_.is_hole, side, side);
  }

  [[noreturn]] void fail(const std::string& what) const { throw SourceError(options_.source, 0, what); }

  /// What a table cannot hold, each by its name.
  void check_source() const {
    constexpr float kFarthest = 2e5f;  // millimetres or radians: well within the format's 1e6
    if (source_.parameters.size() > table::kMaxParameters)
      fail("has " + std::to_string(source_.parameters.size()) + " parameters, more than " +
           std::to_string(table::kMaxParameters) + ": choose some with --identities and --expressions");
    if (source_.landmarks.size() > table::kMaxLandmarks)
      fail("has " + std::to_string(source_.landmarks.size()) + " landmarks, more than " +
           std::to_string(table::kMaxLandmarks));
    for (std::size_t k = 0; k < source_.landmarks.size(); ++k) {
      const SourceLandmark& l = source_.landmarks[k];
      if (!(l.uv.x >= 0 && l.uv.x <= 1 && l.uv.y >= 0 && l.uv.y <= 1))
        fail("the landmark '" + l.name + "' lies outside the chart");
      for (std::size_t i = 0; i < k; ++i)
        if (source_.landmarks[i].name == l.name) fail("the landmark '" + l.name + "' appears twice");
    }
    for (const SourceParameter& p : source_.parameters)
      if (is_track_column(p.name))
        fail("the parameter '" + p.name + "' has the name of another column of a track: rename it");
    for (const SourceShape& shape : source_.shapes) {
      const SourceParameter& p = source_.parameters[shape.parameter];
      float reach = std::max(1.0f, std::abs(p.farthest()));
      if (shape.second >= 0)
        reach *= std::max(1.0f, std::abs(source_.parameters[at(shape.second)].farthest()));
      bool is_near = true;  // false for what is not a number
      for (const Vec3 d : shape.displacement) is_near &= length(d) * reach <= kFarthest;
      for (const float w : shape.weight) is_near &= magnitude(w) * reach <= kFarthest;
      if (!is_near) fail("the parameter '" + p.name + "' moves a vertex by more than 200 m");
    }
  }

  float diagonal() const {
    BoundingBox<Vec3> box;
    for (std::size_t v = 0; v < is_on_surface_.size(); ++v)
      if (is_on_surface_[v]) box.add(source_.neutral[v]);
    return length(box.size());
  }

  void check_rest_shape() const {
    const Distances& off = report_.errors.rest;
    if (off.p95_mm <= kTuning.most_off * diagonal_ && off.max_mm <= kTuning.most_off_anywhere * diagonal_)
      return;
    throw SourceError(
        options_.source, 0,
        "the rest shape of the table would be off by " + number_text(static_cast<double>(off.p95_mm)) +
            " mm at 95 % of the vertices and " + number_text(static_cast<double>(off.max_mm)) +
            " mm at worst: give narrow parts more room in u,v (--relax-chart) or take a larger --size");
  }

  /// Whether the surface, projected along z, has its corners clockwise.
  bool shows_back() const {
    double area = 0, all = 0;
    for (std::size_t k = 0; k < source_.triangles.size(); ++k) {
      if (k < source_.is_hole.size() && source_.is_hole[k] != 0) continue;
      const auto p = [&](std::size_t corner) { return source_.neutral[at(source_.triangles[k][corner])]; };
      const Vec3 normal = cross(p(1) - p(0), p(2) - p(0));
      area += static_cast<double>(normal.z);
      all += static_cast<double>(length(normal));
    }
    constexpr double kRounding = 1e-3;  // of a closed surface, which has no such side
    return area < -kRounding * all;
  }

  Vec3 middle() const {
    Vec3 sum{};
    for (std::size_t v = 0; v < is_on_surface_.size(); ++v)
      if (is_on_surface_[v]) sum = sum + source_.neutral[v];
    const auto count = std::count(is_on_surface_.begin(), is_on_surface_.end(), 1);
    return (1 / static_cast<float>(std::max<std::ptrdiff_t>(count, 1))) * sum;
  }

  void add_warnings() {
    report_.warnings = source_.warnings;
    for (std::string& line : misspelt_landmarks(source_)) report_.warnings.push_back(std::move(line));
    const auto millimetres = [](float x) {
      return number_text(std::round(100 * static_cast<double>(x)) / 100) + " mm";
    };
    if (shows_back())
      report_.warnings.push_back(
          "seen from the front, along z, this surface shows its back: a rendered picture without a turn, or "
          "a start from a box, sees nothing of it. A start by print or points turns it. Else turn its "
          "vertices; to reverse the corners of its faces would mirror the print");
    if (diagonal_ < kTuning.least_tracked_mm)
      report_.warnings.push_back("the surface is " + millimetres(diagonal_) +
                                 " across, and nothing is tracked nearer than 50 mm: is it in centimetres "
                                 "(--unit 10), inches (--unit 25.4) or metres (--unit 1000)?");
    if (length(middle()) > kTuning.most_off_origin * diagonal_)
      report_.warnings.push_back(
          "the origin is " + millimetres(length(middle())) + " from the surface, which is " +
          millimetres(diagonal_) +
          " across, and must be in front of the camera as well: move the surface to it");
  }

  void add_base_mesh() {
    BaseMesh mesh{source_.base_uv, source_.base_corners};
    if (mesh.corners.empty()) mesh = make_base_mesh(source_, options_.base_vertices, source_.is_symmetric);
    if (mesh.corners.empty())
      fail("no base mesh of at most 9000 vertices follows the surface's boundary in the chart");
    report_.base_vertices = mesh.uv.size();
    add_warnings();
    writer_.set_base_mesh(mesh.uv, mesh.corners);
  }

  void add_neutral() {
    FieldGrid grid = grid_of(raster(2 * options_.size), source_.neutral);
    fit_grid(grid, places_, source_.neutral, 0);
    CascadeRecord r = empty_record(Operation::constant);
    r.field = writer_.add_field(grid, 16);
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
    const std::uint16_t field =
        shape.mirror_of >= 0
            ? writer_.add_mirrored(fields_[at(shape.mirror_of)])
            : writer_.add_field(turns ? grid_for(shape.weight, shape) : grid_for(shape.displacement, shape),
                                options_.bits);
    fields_.push_back(field);
    (turns ? r.weight : r.field) = field;
    const float axis[3] = {shape.axis.x, shape.axis.y, shape.axis.z},
                pivot[3] = {shape.pivot.x, shape.pivot.y, shape.pivot.z};
    if (turns) std::copy(axis, axis + 3, r.axis), std::copy(pivot, pivot + 3, r.pivot);
    last_ = writer_.add_record(r);
  }

  /// The value of a parameter at which the error of its shape is judged.
  float most_of(std::size_t parameter) const {
    const SourceParameter& p = source_.parameters[parameter];
    const float most = std::abs(p.farthest());
    return p.group == Group::identity ? std::min(kTuning.identity_sds * p.sd, most) : most;
  }

  /// The coarsest grid within the tolerance. If no sampled grid is within it, the finest grid fitted by least squares, or the
  /// coarsest fitted grid that is as good to within the tolerance.
  template <class T>
  FieldGrid grid_for(const std::vector<T>& values, const SourceShape& shape) {
    const float most = most_of(shape.parameter) * (shape.second >= 0 ? most_of(at(shape.second)) : 1.0f);
    const float effect = std::max(most, 1e-6f) * (shape.weight.empty() ? 1.0f : kTuning.rotation_arm_mm);
    const float threshold = scale_ * kTuning.still_mm / effect, tolerance = scale_ * options_.tolerance_mm;
    for (std::size_t level = rasters_.size(); level-- > 0;) {
      FieldGrid grid = cropped(sampled(level, values), threshold);
      const std::vector<float> off = deviations(grid, values);
      if (*std::max_element(off.begin(), off.end()) * effect > tolerance) continue;
      return grid;
    }
    FieldGrid best = cropped(fitted(0, values, threshold), threshold);
    const std::vector<float> finest = deviations(best, values);
    for (std::size_t level = 1; level < rasters_.size(); ++level) {
      FieldGrid grid = cropped(fitted(level, values, threshold), threshold);
      if (largest_excess(deviations(grid, values), finest) * effect > tolerance) break;
      best = std::move(grid);
    }
    return best;
  }

  template <class T>
  FieldGrid sampled(std::size_t level, const std::vector<T>& values) const {
    FieldGrid grid = grid_of(rasters_[level], values);
    clear_border(grid, rasters_[level]);
    return grid;
  }

  template <class T>
  FieldGrid fitted(std::size_t level, const std::vector<T>& values, float threshold) const {
    FieldGrid grid = grid_of(rasters_[level], values);
    fit_grid(grid, places_, values, threshold);
    clear_border(grid, rasters_[level]);
    return grid;
  }

  static float largest_excess(const std::vector<float>& of, const std::vector<float>& over) {
    float excess = 0;
    for (std::size_t i = 0; i < of.size(); ++i) excess = std::max(excess, of[i] - over[i]);
    return excess;
  }

  /// Distances between the grid and the values at the vertices of the surface.
  std::vector<float> deviations(const FieldGrid& grid, const std::vector<Vec3>& values) const {
    std::vector<float> result;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const Vec2 uv = source_.uv[i];
      if (is_on_surface_[i])
        result.push_back(
            length(values[i] - Vec3{sample(grid, 0, uv), sample(grid, 1, uv), sample(grid, 2, uv)}));
    }
    return result;
  }
  std::vector<float> deviations(const FieldGrid& grid, const std::vector<float>& values) const {
    std::vector<float> result;
    for (std::size_t i = 0; i < values.size(); ++i)
      if (is_on_surface_[i]) result.push_back(std::fabs(values[i] - sample(grid, 0, source_.uv[i])));
    return result;
  }

  GreyImage mask() const {
    const ChartRaster fine = raster(2 * options_.size);
    GreyImage image{static_cast<std::uint32_t>(fine.width), static_cast<std::uint32_t>(fine.height), {}};
    for (const ChartSample& s : fine.samples)
      image.pixels.push_back(s.triangle >= 0 && !source_.is_hole[at(s.triangle)] ? 1 : 0);
    return image;
  }

  const Source& source_;
  const BakeOptions& options_;
  std::vector<ChartRaster> rasters_;  // from fine to coarse
  std::vector<char> is_on_surface_;
  float diagonal_ = 0, scale_ = 1;  // of lengths
  std::vector<FitPlace> places_;
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
