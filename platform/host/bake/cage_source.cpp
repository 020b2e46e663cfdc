#include "host/bake/cage_source.hpp"

#include <algorithm>
#include <filesystem>
#include <stdexcept>

#include "host/bake/at.hpp"
#include "host/bake/chart_raster.hpp"
#include "host/bake/moves.hpp"
#include "host/bake/paint.hpp"
#include "host/bake/source_error.hpp"
#include "host/bake/subdivision.hpp"
#include "host/bake/text_table.hpp"
#include "host/io/curve_kinds.hpp"

namespace pliant::host::bake {

namespace {

/// A row of parameters.txt. A sided one becomes two parameters, NAMELeft and NAMERight.
struct CageParameter {
  std::string name;
  bool is_sided;
  SourceParameter limits;
};

class CageSourceReader {
 public:
  explicit CageSourceReader(const std::string& folder)
      : folder_(folder),
        cage_(read_cage(folder)),
        fine_(subdivide(cage_, kLevels)),
        groups_(read_groups(folder, cage_)),
        followers_(read_followers(folder, cage_)) {}

  Source run() {
    make_surface();
    read_parameters();
    make_shapes("identity.txt", Group::identity);
    make_shapes("expressions.txt", Group::expression);
    read_landmarks();
    read_curves();
    source_.is_symmetric = true;
    source_.albedo =
        paint(folder_, {cage_, fine_, source_.uv, source_.neutral, source_.triangles, source_.is_hole});
    return std::move(source_);
  }

 private:
  /// Rounds of subdivision: 64 quads for each of the cage, half a millimetre long at the lips.
  static constexpr int kLevels = 3;
  /// Rounds of residual correction of the rest shape, and of each displacement (subdivision.hpp). Displacements are smaller
  /// and smoother. Round values, not tuned.
  static constexpr int kPositionRounds = 10, kMoveRounds = 4;

  void make_surface() {
    source_.uv = fine_values(fine_, cage_.uv);
    source_.neutral = fine_values(fine_, controls_through(fine_, cage_.position, kPositionRounds));
    for (std::size_t q = 0; q < fine_.quads.size(); ++q) {
      const auto& c = fine_.quads[q];
      source_.triangles.push_back({c[0], c[1], c[2]});
      source_.triangles.push_back({c[0], c[2], c[3]});
      const bool hole = cage_.faces[at(fine_.cage_face[q])].is_hole;
      source_.is_hole.insert(source_.is_hole.end(), 2, hole);
    }
    check_chart();
  }

  /// The chart must be injective: all triangles have one orientation.
  void check_chart() const {
    const auto areas = chart_areas(source_.uv, source_.triangles);
    for (std::size_t f = 0; f < areas.size(); ++f) {
      if (areas[f] < 0) continue;
      const int v = source_.triangles[f][0];
      const auto& s = fine_.stencils[at(v)];
      const auto heaviest =
          std::max_element(s.begin(), s.end(), [](auto a, auto b) { return a.second < b.second; });
      throw SourceError(
          folder_ + "/points.txt", 0,
          "the chart (u,v) has a fold-over near point '" + cage_.names[at(heaviest->first)] + "'");
    }
  }

  void read_parameters() {
    const TextTable table(folder_ + "/parameters.txt",
                          {"parameter", "group", "sided", "minimum", "maximum", "sd"});
    for (const TextRow& row : table.rows()) {
      if (row.cells[1] != "identity" && row.cells[1] != "expression")
        table.fail(row, "group '" + row.cells[1] + "' is neither identity nor expression");
      if (row.cells[2] != "yes" && row.cells[2] != "no")
        table.fail(row, "sided is yes or no, not '" + row.cells[2] + "'");
      CageParameter p{row.cells[0],
                      row.cells[2] == "yes",
                      {row.cells[0], row.cells[1] == "identity" ? Group::identity : Group::expression,
                       table.number(row, 3), table.number(row, 4), table.number(row, 5)}};
      if (!(p.limits.minimum <= 0 && p.limits.maximum >= 0 && p.limits.sd > 0))
        table.fail(row, "needs minimum <= 0 <= maximum and sd > 0");
      check_name(table.path(), row.line, p.name + (p.is_sided ? "Right" : ""));
      for (const CageParameter& other : parameters_)
        if (other.name == p.name) table.fail(row, "parameter '" + p.name + "' appears twice");
      parameters_.push_back(p);
    }
  }

  void make_shapes(const std::string& file, Group group) {
    std::vector<std::string> names;
    for (const CageParameter& p : parameters_)
      if (p.limits.group == group) names.push_back(p.name);
    const auto moves = read_moves(folder_, file, cage_, groups_, names);
    const auto hinges = group == Group::expression ? read_hinges() : std::vector<Hinge>{};
    // Rotations first: the displacements that follow are then in the model's axes and do not turn with the jaw.
    const std::size_t first = source_.parameters.size();
    for (const CageParameter& p : parameters_) {
      if (p.limits.group != group) continue;
      for (const char* side : {p.is_sided ? "Left" : "", "Right"}) {
        if (!p.is_sided && side[0] != 0) break;
        source_.parameters.push_back(p.limits);
        source_.parameters.back().name += side;
      }
    }
    std::size_t k = first;
    for (const CageParameter& p : parameters_) {
      if (p.limits.group != group) continue;
      add_hinge(k, p, hinges, moves);
      k += p.is_sided ? 2 : 1;
    }
    k = first;
    for (const CageParameter& p : parameters_) {
      if (p.limits.group != group) continue;
      add_displacement(k, p, moves, file);
      k += p.is_sided ? 2 : 1;
    }
  }

  struct Hinge {
    std::string parameter;
    Vec3 axis, pivot;
  };

  std::vector<Hinge> read_hinges() const {
    const TextTable table(folder_ + "/hinges.txt",
                          {"parameter", "axis_x", "axis_y", "axis_z", "pivot_x", "pivot_y", "pivot_z"});
    std::vector<Hinge> hinges;
    for (const TextRow& row : table.rows()) {
      const Vec3 axis = table.vector(row, 1);
      if (magnitude(length(axis) - 1) > 1e-3f) table.fail(row, "the axis is not a unit vector");
      hinges.push_back({row.cells[0], axis, table.vector(row, 4)});
    }
    return hinges;
  }

  void add_hinge(std::size_t parameter, const CageParameter& p, const std::vector<Hinge>& hinges,
                 const std::vector<Move>& moves) {
    const auto weights = hinge_of(moves, p.name, cage_, followers_);
    if (weights.empty()) return;
    for (const Hinge& h : hinges)
      if (h.parameter == p.name) {
        source_.shapes.push_back({parameter, {}, fine_values(fine_, weights), h.axis, h.pivot, -1});
        return;
      }
    throw SourceError(folder_ + "/hinges.txt", 0, "no row for parameter '" + p.name + "'");
  }

  void add_displacement(std::size_t parameter, const CageParameter& p, const std::vector<Move>& moves,
                        const std::string& file) {
    const auto has_row = [&p](const Move& m) { return m.parameter == p.name && m.kind != MoveKind::hinge; };
    if (std::none_of(moves.begin(), moves.end(), has_row)) {
      if (std::none_of(moves.begin(), moves.end(), [&p](const Move& m) { return m.parameter == p.name; }))
        throw SourceError(folder_ + "/" + file, 0, "no row for parameter '" + p.name + "'");
      return;
    }
    const auto cage_moves = displacement_of(moves, p.name, p.is_sided, cage_, followers_);
    std::vector<char> is_still;
    for (Vec3 d : cage_moves) is_still.push_back(d.x == 0 && d.y == 0 && d.z == 0);
    const auto controls = controls_through(fine_, cage_moves, kMoveRounds, is_still);
    source_.shapes.push_back({parameter, fine_values(fine_, controls), {}, {}, {}, -1});
    if (!p.is_sided) return;
    const int left = static_cast<int>(source_.shapes.size()) - 1;
    source_.shapes.push_back({parameter + 1, {}, {}, {}, {}, left});
  }

  int point(const TextTable& table, const TextRow& row, std::size_t column) const {
    try {
      const auto points = points_of(cage_, row.cells[column]);
      if (points.size() == 1) return points[0];
    } catch (const std::invalid_argument& error) {
      table.fail(row, error.what());
    }
    table.fail(row, "'" + row.cells[column] + "' is more than one point");
  }

  void read_landmarks() {
    const TextTable table(folder_ + "/landmarks.txt", {"landmark", "from", "to", "fraction"});
    for (const TextRow& row : table.rows()) {
      const Vec2 from = source_.uv[at(point(table, row, 1))], to = source_.uv[at(point(table, row, 2))];
      const float fraction = table.number(row, 3);
      if (!(fraction >= 0 && fraction <= 1)) table.fail(row, "the fraction is not from 0 to 1");
      source_.landmarks.push_back({table.name(row, 0), from + fraction * (to - from)});
    }
  }

  void read_curves() {
    const TextTable table(folder_ + "/curves.txt", {"curve", "kind", "points..."});
    for (const TextRow& row : table.rows()) {
      const auto kind = std::find(std::begin(kCurveKindNames), std::end(kCurveKindNames), row.cells[1]);
      if (kind == std::end(kCurveKindNames))
        table.fail(row, "kind '" + row.cells[1] + "' is none of lid, lip, brow, boundary");
      std::vector<int> points;
      for (const std::string& word : table.words(row, 2)) try {
          for (int p : points_of(cage_, word)) points.push_back(p);
        } catch (const std::invalid_argument& error) {
          table.fail(row, error.what());
        }
      SourceCurve curve{table.name(row, 0), static_cast<CurveKind>(kind - std::begin(kCurveKindNames)), {}};
      for (int v : path_through(fine_, points)) curve.points.push_back(source_.uv[at(v)]);
      if (curve.points.size() < 2) table.fail(row, "a curve has at least two points");
      source_.curves.push_back(std::move(curve));
    }
  }

  const std::string folder_;
  const Cage cage_;
  const SubdividedCage fine_;
  const Groups groups_;
  const std::vector<Follower> followers_;
  std::vector<CageParameter> parameters_;
  Source source_;
};

}  // namespace

Source read_cage_source(const std::string& folder) {
  return CageSourceReader(folder).run();
}

bool is_cage_folder(const std::string& folder) {
  std::error_code error;  // as of a folder that may not be read
  return std::filesystem::exists(folder + "/points.txt", error);
}

}  // namespace pliant::host::bake
