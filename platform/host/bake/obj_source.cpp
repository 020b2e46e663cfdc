#include "host/bake/obj_source.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <iterator>
#include <map>
#include <sstream>

#include "host/bake/albedo_picture.hpp"
#include "host/bake/at.hpp"
#include "host/bake/bending_modes.hpp"
#include "host/bake/chart_raster.hpp"
#include "host/bake/chart_relaxation.hpp"
#include "host/bake/material_library.hpp"
#include "host/bake/obj_file.hpp"
#include "host/bake/principal_components.hpp"
#include "host/bake/source_error.hpp"
#include "host/bake/surface_check.hpp"
#include "host/bake/text_table.hpp"
#include "host/io/csv.hpp"
#include "host/io/failure.hpp"
#include "host/io/files.hpp"
#include "host/io/ibug_names.hpp"
#include "host/io/words.hpp"

namespace pliant::host::bake {

namespace {

namespace fs = std::filesystem;

bool is_obj_file(const std::string& source) {
  return ends_with(in_lower_case(source), ".obj") && !fs::is_directory(source);
}

/// The material files that `mtllib` lines name: one a line, with blanks in its name, or several.
std::vector<std::string> libraries_in(const std::string& folder, const std::vector<std::string>& lines) {
  std::vector<std::string> names;
  for (std::string line : lines) {
    std::replace(line.begin(), line.end(), '\\', '/');
    std::istringstream words(line);
    const std::vector<std::string> each{std::istream_iterator<std::string>(words), {}};
    const bool are_several = each.size() > 1 && !fs::exists(folder + line) && fs::exists(folder + each[0]);
    if (are_several)
      names.insert(names.end(), each.begin(), each.end());
    else
      names.push_back(line);
  }
  return names;
}

/// Vertices of a mesh, count, at most: about four samples of the largest rest shape each. Bounds the time.
constexpr std::size_t kMostVertices = 250000;
/// Largest distance of a vertex from the origin, millimetres: a tenth of what a table can hold.
constexpr float kFarthestMm = 1e5f;
/// Pictures of materials, count, at most. Bounds the memory.
constexpr std::size_t kMostPictures = 64;
/// Corners of a polygon that are tried as the apex of its fan, count, at most. Bounds the time.
constexpr std::size_t kMostApexes = 64;

/// Name of a file without its folder and ending.
std::string name_of(const std::string& path) {
  return fs::path(path).stem().string();
}

/// The OBJ files, sorted by their names. Hidden ones are left out: some systems put one of another kind beside each file.
std::vector<std::string> obj_files(const std::string& source) {
  if (is_obj_file(source)) return {source};
  std::vector<std::string> files;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(source, error))
    if (is_obj_file(entry.path().string()) && entry.path().filename().string()[0] != '.')
      files.push_back(entry.path().string());
  std::sort(files.begin(), files.end(), [](const std::string& a, const std::string& b) {
    return std::pair(name_of(a), a) < std::pair(name_of(b), b);
  });
  return files;
}

std::string parameter_name(std::string name) {
  if (ends_with(name, "_L"))
    name.replace(name.size() - 2, 2, "Left");
  else if (ends_with(name, "_R"))
    name.replace(name.size() - 2, 2, "Right");
  return name;
}

class FolderReader {
 public:
  FolderReader(const std::string& source, const ObjOptions& options)
      : folder_(is_obj_file(source) ? fs::path(source).parent_path().string() : source),
        options_(options),
        files_(obj_files(source)),
        is_one_file_(is_obj_file(source)) {}

  Source run() {
    const bool scans = options_.components > 0;
    rest_ = read_obj(scans ? files_[0] : rest_path());
    make_vertices();
    make_triangles();
    if (scans)
      read_scans();
    else
      read_shapes();
    add_modes();
    read_ranges();
    if (options_.relaxes_chart) relax_chart(source_.uv, source_.neutral, source_.triangles);
    read_albedo();
    read_landmarks();
    set_origin();
    add_curves();
    return std::move(source_);
  }

 private:
  /// The rest shape is the only file, or neutral.obj.
  std::string rest_path() const {
    const auto neutral = std::find_if(files_.begin(), files_.end(),
                                      [](const std::string& path) { return name_of(path) == "neutral"; });
    if (files_.size() > 1 && neutral == files_.end())
      throw SourceError(
          folder_, 0,
          "has " + std::to_string(files_.size()) +
              " OBJ files, and none is neutral.obj, the rest shape (--pca N takes all as scans)");
    return files_.size() == 1 ? files_[0] : *neutral;
  }
  void report_progress(std::size_t done) const {
    if (options_.progress) options_.progress("files", done, files_.size());
  }

  /// Makes one vertex for each pair of place and texture coordinate. A place on a cut of the chart has several. Equal numbers
  /// count as one, whether the file repeats them or not.
  void make_vertices() {
    std::map<std::array<float, 5>, int> ids;
    for (std::size_t polygon = 0, k = 0; polygon < rest_.polygon_end.size(); ++polygon)
      for (; k < at(rest_.polygon_end[polygon]); ++k) {
        const ObjCorner c = rest_.corners[k];
        if (c.texture < 0)
          throw SourceError(rest_.path, rest_.polygon_line[polygon], "the face has no texture coordinates");
        const Vec2 t = rest_.texture[at(c.texture)];
        const Vec3 p = rest_.vertices[at(c.vertex)];
        const auto [entry, fresh] = ids.insert({{p.x, p.y, p.z, t.x, t.y}, static_cast<int>(ids.size())});
        if (fresh) {
          if (!(t.x >= 0 && t.x <= 1 && t.y >= 0 && t.y <= 1))
            throw SourceError(rest_.path, rest_.polygon_line[polygon],
                              "a texture coordinate of the face is outside 0 to 1");
          source_.uv.push_back({t.x, 1 - t.y});
          painted_.picture_uv.push_back(t);
          vertex_of_.push_back(c.vertex);
        }
        first_id_.insert({c.vertex, entry->second});
        id_of_corner_.push_back(entry->second);
      }
    if (source_.uv.size() > kMostVertices)
      throw SourceError(rest_.path, 0,
                        "has " + std::to_string(source_.uv.size()) + " vertices, more than " +
                            std::to_string(kMostVertices) + ": reduce the mesh");
    source_.neutral = placed(rest_);
  }

  std::vector<Vec3> placed(const ObjMesh& mesh) const {
    std::vector<Vec3> result;
    for (int v : vertex_of_) {
      const Vec3 p = options_.unit_mm * mesh.vertices[at(v)];
      if (!(length(p) <= kFarthestMm))
        throw SourceError(
            mesh.path, 0,
            "vertex " + std::to_string(v + 1) + " is more than 100 m from the origin: check it and --unit");
      result.push_back(p);
    }
    return result;
  }

  /// Splits polygons into fans, and mirrors the chart if necessary: seen from outside, u points right and v points down.
  void make_triangles() {
    std::vector<int> line;
    for (std::size_t polygon = 0, k = 0; polygon < rest_.polygon_end.size();
         k = at(rest_.polygon_end[polygon++])) {
      const std::vector<int> corners(id_of_corner_.begin() + static_cast<std::ptrdiff_t>(k),
                                     id_of_corner_.begin() + rest_.polygon_end[polygon]);
      add_fan(corners);
      line.resize(source_.triangles.size(), rest_.polygon_line[polygon]);
      painted_.picture.resize(source_.triangles.size(), rest_.material[polygon]);
    }
    if (source_.triangles.empty()) throw SourceError(rest_.path, 0, "holds no faces");
    source_.is_hole.assign(source_.triangles.size(), 0);
    double sum = 0;
    for (float area : chart_areas(source_.uv, source_.triangles)) sum += static_cast<double>(area);
    if (sum > 0) {
      for (Vec2& uv : source_.uv) uv.x = 1 - uv.x;
      source_.warnings.push_back(
          "seen from outside, the u of this file runs to the left: u in the model is 1 - u (mesh --mirror-u "
          "turns it back)");
    }
    if (const auto defect = find_defect(source_.uv, source_.triangles))
      throw SourceError(rest_.path, line[defect->triangle], defect->what);
  }

  /// Adds the triangles of a polygon: the fan around its first corner or, where it is not convex, around the corner with the
  /// largest least area in the chart.
  void add_fan(const std::vector<int>& corners) {
    const std::size_t n = corners.size();
    std::vector<std::array<int, 3>> best;
    float best_area = 0;
    for (std::size_t apex = 0; apex < std::min(n, kMostApexes); ++apex) {
      std::vector<std::array<int, 3>> fan;
      for (std::size_t c = 2; c < n; ++c)
        fan.push_back({corners[apex], corners[(apex + c - 1) % n], corners[(apex + c) % n]});
      const auto areas = chart_areas(source_.uv, fan);
      const auto [least, most] = std::minmax_element(areas.begin(), areas.end());
      const float area = std::max(*least, -*most);  // positive if all triangles have one orientation
      if (apex == 0 || area > best_area) {
        best = std::move(fan);
        best_area = area;
      }
      if (apex == 0 && area > 0) break;
    }
    source_.triangles.insert(source_.triangles.end(), best.begin(), best.end());
  }

  void add_parameter(const std::string& file, const std::string& name, Group group,
                     std::vector<Vec3> displacement) {
    check_name(file, 0, name);
    for (const SourceParameter& p : source_.parameters)
      if (p.name == name)
        throw SourceError(file, 0, "another file gives the parameter '" + name + "' as well");
    const bool identity = group == Group::identity;
    source_.shapes.push_back({source_.parameters.size(), std::move(displacement), {}, {}, {}, -1});
    source_.parameters.push_back(
        {name, group, identity ? -3.0f : 0.0f, identity ? 3.0f : 1.0f, identity ? 1.0f : 0.35f});
  }

  void read_shapes() {
    std::size_t done = 1;
    for (const bool identity : {true, false})
      for (const std::string& path : files_) {
        const std::string name = name_of(path);
        if (path == rest_.path || (name.compare(0, 8, "identity") == 0) != identity) continue;
        auto moved = placed(read_obj_like(path, rest_));
        for (std::size_t v = 0; v < moved.size(); ++v) moved[v] = moved[v] - source_.neutral[v];
        if (std::all_of(moved.begin(), moved.end(), [](Vec3 d) { return dot(d, d) == 0; }))
          source_.warnings.push_back(name + ".obj is the rest shape: the parameter '" + parameter_name(name) +
                                     "' moves nothing");
        add_parameter(path, parameter_name(name), identity ? Group::identity : Group::expression,
                      std::move(moved));
        report_progress(++done);
      }
  }

  void read_scans() {
    std::vector<std::vector<Vec3>> scans;
    for (const std::string& path : files_) {
      scans.push_back(placed(read_obj_like(path, rest_)));
      report_progress(scans.size());
    }
    if (scans.size() < 2 || at(options_.components) >= scans.size())
      throw SourceError(folder_.empty() ? files_.front() : folder_, 0,
                        std::to_string(scans.size()) + " scans have at most " +
                            std::to_string(scans.size() - 1) + " components");
    PrincipalComponents pca = find_components(scans, options_.components);
    source_.neutral = std::move(pca.mean);
    for (std::size_t k = 0; k < pca.components.size(); ++k) {
      const std::string digits = std::to_string(k);
      add_parameter(folder_,
                    "identity" + std::string(3 - std::min<std::size_t>(3, digits.size()), '0') + digits,
                    Group::identity, std::move(pca.components[k]));
    }
  }

  /// Adds the bending modes of the rest shape. Vertices at one place move alike, so that cuts of the chart do not open.
  void add_modes() {
    if (options_.modes == 0) return;
    BendingMesh mesh;
    std::map<std::array<float, 3>, int> places;
    std::vector<int> place_of;
    for (const Vec3 p : source_.neutral) {
      const auto [entry, fresh] = places.insert({{p.x, p.y, p.z}, static_cast<int>(places.size())});
      if (fresh) mesh.position.push_back(p);
      place_of.push_back(entry->second);
    }
    if (mesh.position.size() > kMostModeVertices)
      throw SourceError(rest_.path, 0,
                        "has " + std::to_string(mesh.position.size()) + " vertices, more than " +
                            std::to_string(kMostModeVertices) + ", for --modes: reduce the mesh");
    mesh.is_fixed.assign(mesh.position.size(), 0);
    for (std::size_t polygon = 0, k = 0; polygon < rest_.polygon_end.size(); ++polygon)
      for (; k < at(rest_.polygon_end[polygon]); ++k)
        if (rest_.is_fixed[polygon]) mesh.is_fixed[at(place_of[at(id_of_corner_[k])])] = 1;
    mesh.triangles = source_.triangles;
    for (auto& t : mesh.triangles)
      for (int& v : t) v = place_of[at(v)];
    const BendingModes modes = modes_of(mesh);
    if (modes.displacement.size() < at(options_.modes))
      throw SourceError(rest_.path, 0,
                        "has only " + std::to_string(modes.displacement.size()) + " bending modes, not " +
                            std::to_string(options_.modes));
    const auto placed_at = [&place_of](const std::vector<Vec3>& of_places) {
      std::vector<Vec3> result;
      for (const int place : place_of) result.push_back(of_places[at(place)]);
      return result;
    };
    const std::size_t first = source_.parameters.size();
    for (std::size_t k = 0; k < modes.displacement.size(); ++k) {
      add_parameter(rest_.path, (k < 10 ? "mode0" : "mode") + std::to_string(k), Group::expression,
                    placed_at(modes.displacement[k]));
      SourceParameter& p = source_.parameters.back();
      p.minimum = -3, p.maximum = 3, p.sd = 1;
    }
    for (const ModeCorrection& c : modes.corrections)
      source_.shapes.push_back(
          {first + c.first, placed_at(c.displacement), {}, {}, {}, -1, static_cast<int>(first + c.second)});
  }

  BendingModes modes_of(const BendingMesh& mesh) const {
    try {
      return find_bending_modes(mesh, options_.modes, options_.stiffness);
    } catch (const std::runtime_error& error) {
      throw SourceError(rest_.path, 0, std::string("has no bending modes: ") + error.what());
    }
  }

  void read_albedo() {
    if (options_.texture == "none") return;
    std::vector<int> picture_of(rest_.materials.size(), -1);
    if (!options_.texture.empty()) {
      painted_.pictures.push_back(read_image(options_.texture));
      std::fill(picture_of.begin(), picture_of.end(), 0);
    } else {
      find_pictures(picture_of);
    }
    if (painted_.pictures.empty()) return;
    for (int& picture : painted_.picture) picture = picture_of[at(picture)];  // so far, of the material
    source_.albedo = albedo_of(source_, painted_, options_.most_texture_side);
    source_.has_print = true;
  }

  /// Reads the pictures of the materials; each picture once.
  void find_pictures(std::vector<int>& picture_of) {
    std::map<std::string, std::string> names;
    const std::string folder = rest_.path.substr(0, rest_.path.find_last_of('/') + 1);
    for (const std::string& library : libraries_in(folder, rest_.libraries)) {
      if (!fs::exists(folder + library))
        source_.warnings.push_back("there is no material file " + folder + library +
                                   ": the surface has no texture from it");
      names.merge(read_picture_names(folder + library, &source_.warnings));
    }
    for (const std::string& material : rest_.materials)
      if (!names.empty() && !material.empty() && names.count(material) == 0)
        source_.warnings.push_back("no material file has the material '" + material +
                                   "': its part of the surface has no texture");
    std::map<std::string, int> ids;
    for (std::size_t m = 0; m < rest_.materials.size(); ++m) {
      const auto name = names.find(rest_.materials[m]);
      if (name == names.end() || name->second.empty()) continue;
      const auto [entry, fresh] = ids.insert({name->second, static_cast<int>(ids.size())});
      if (fresh) {
        if (!fs::exists(name->second))
          throw SourceError(name->second, 0,
                            "the picture of material '" + rest_.materials[m] +
                                "' cannot be read (--texture none does without)");
        if (ids.size() > kMostPictures)
          throw SourceError(rest_.path, 0, "has more than " + std::to_string(kMostPictures) + " pictures");
        painted_.pictures.push_back(
            shrunk_to(read_image(name->second), options_.most_texture_side, options_.most_texture_side));
      }
      picture_of[m] = entry->second;
    }
  }

  /// Changes what parameters.txt lists.
  void read_ranges() {
    const std::string file = folder_ + "/parameters.txt";
    if (is_one_file_ || !fs::exists(file)) return;
    const TextTable table(file, {"parameter", "group", "minimum", "maximum", "sd"});
    std::vector<std::string> seen;
    for (const TextRow& row : table.rows()) {
      const std::string& name = row.cells[0];
      const auto p = std::find_if(source_.parameters.begin(), source_.parameters.end(),
                                  [&name](const SourceParameter& q) { return q.name == name; });
      const auto is_file = [&name](const std::string& path) { return name_of(path) == name; };
      if (p == source_.parameters.end())
        table.fail(row, std::none_of(files_.begin(), files_.end(), is_file)
                            ? "there is no file for parameter '" + name + "'"
                            : "the parameter of " + name + ".obj is '" + parameter_name(name) + "'");
      if (std::find(seen.begin(), seen.end(), name) != seen.end())
        table.fail(row, "parameter '" + name + "' appears twice");
      seen.push_back(name);
      if (row.cells[1] != "identity" && row.cells[1] != "expression")
        table.fail(row, "group '" + row.cells[1] + "' is neither identity nor expression");
      *p = {name, row.cells[1] == "identity" ? Group::identity : Group::expression, table.number(row, 2),
            table.number(row, 3), table.number(row, 4)};
      if (!(p->minimum <= 0 && p->minimum >= -1000 && p->maximum >= 0 && p->maximum <= 1000 &&
            p->sd >= 1e-3f && p->sd <= 1000))
        table.fail(row, "needs -1000 <= minimum <= 0 <= maximum <= 1000 and 0.001 <= sd <= 1000");
    }
  }

  void read_landmarks() {
    const std::string file = folder_ + "/landmarks.csv";
    if (is_one_file_ || !fs::exists(file)) return;
    const CsvTable table(file, read_file(file));
    const std::size_t names = table.column("landmark"), vertices = table.column("vertex");
    for (std::size_t row = 0; row < table.row_count(); ++row) {
      const std::string& name = table.cell(row, names);
      const std::string where = table.where(row);
      check_name(where, 0, name);
      const auto id = first_id_.find(static_cast<int>(table.whole_number(row, vertices)));
      if (id == first_id_.end()) fail_input(where, "there is no vertex " + table.cell(row, vertices) + " on a face");
      if (!landmark_vertex_.insert({name, id->second}).second)
        fail_input(where, "the landmark '" + name + "' appears twice");
      source_.landmarks.push_back({name, source_.uv[at(id->second)]});
    }
  }

  void set_origin() {
    const auto right = landmark_vertex_.find("ibug36"), left = landmark_vertex_.find("ibug45");
    if (right == landmark_vertex_.end() || left == landmark_vertex_.end()) return;
    const Vec3 origin = 0.5f * (source_.neutral[at(right->second)] + source_.neutral[at(left->second)]);
    for (Vec3& p : source_.neutral) p = p - origin;
  }

  struct IbugCurve {
    const char* name;
    CurveKind kind;
    int first, last, close;  // from landmark to landmark, then to `close` unless it is negative
  };

  void add_curves() {
    constexpr IbugCurve kCurves[] = {
        {"outline", CurveKind::boundary, 0, 16, -1},     {"brow_right", CurveKind::brow, 17, 21, -1},
        {"brow_left", CurveKind::brow, 22, 26, -1},      {"lid_upper_right", CurveKind::lid, 36, 39, -1},
        {"lid_lower_right", CurveKind::lid, 39, 41, 36}, {"lid_upper_left", CurveKind::lid, 42, 45, -1},
        {"lid_lower_left", CurveKind::lid, 45, 47, 42},  {"lip_outer_upper", CurveKind::lip, 48, 54, -1},
        {"lip_outer_lower", CurveKind::lip, 54, 59, 48}, {"lip_inner_upper", CurveKind::lip, 60, 64, -1},
        {"lip_inner_lower", CurveKind::lip, 64, 67, 60}};
    for (const IbugCurve& c : kCurves) {
      SourceCurve curve{c.name, c.kind, {}};
      bool complete = true;
      const auto append = [&](int k) {
        const auto vertex = landmark_vertex_.find(ibug_name(k));
        complete &= vertex != landmark_vertex_.end();
        if (complete) curve.points.push_back(source_.uv[at(vertex->second)]);
      };
      for (int k = c.first; k <= c.last; ++k) append(k);
      if (c.close >= 0) append(c.close);
      if (complete) source_.curves.push_back(std::move(curve));
    }
  }

  const std::string folder_;
  const ObjOptions& options_;
  const std::vector<std::string> files_;
  const bool is_one_file_;  // the source is a file, and no folder
  ObjMesh rest_;
  PaintedSurface painted_;
  std::vector<int> id_of_corner_;  // ours, of each corner of rest_
  std::vector<int> vertex_of_;     // the file's, of each of our vertices
  std::map<int, int> first_id_;    // ours, of each of the file's
  std::map<std::string, int> landmark_vertex_;
  Source source_;
};

}  // namespace

Source read_obj_source(const std::string& source, const ObjOptions& options) {
  return FolderReader(source, options).run();
}

bool is_obj_source(const std::string& source) {
  return !obj_files(source).empty();
}

}  // namespace pliant::host::bake
