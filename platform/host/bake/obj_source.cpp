#include "host/bake/obj_source.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>

#include "host/bake/albedo_picture.hpp"
#include "host/bake/at.hpp"
#include "host/bake/chart_raster.hpp"
#include "host/bake/chart_relaxation.hpp"
#include "host/bake/ibug_curves.hpp"
#include "host/bake/material_pictures.hpp"
#include "host/bake/obj_file.hpp"
#include "host/bake/polygon_triangles.hpp"
#include "host/bake/principal_components.hpp"
#include "host/bake/source_error.hpp"
#include "host/bake/surface_check.hpp"
#include "host/bake/surface_modes.hpp"
#include "host/bake/text_table.hpp"
#include "host/io/csv.hpp"
#include "host/io/failure.hpp"
#include "host/io/files.hpp"
#include "host/io/sources.hpp"
#include "host/io/words.hpp"
#include "model/chart.hpp"

namespace pliant::host::bake {

namespace {

namespace fs = std::filesystem;

bool is_obj_file(const std::string& source) {
  std::error_code error;  // as of a link that leads to itself: reading it then says so
  return ends_with(in_lower_case(source), ".obj") && !fs::is_directory(source, error);
}

/// Vertices of a mesh, count, at most: about four samples of the largest rest shape each. Bounds the time.
constexpr std::size_t kMostVertices = 250000;
/// Largest distance of a vertex from the origin, millimetres: a tenth of what a table can hold.
constexpr float kFarthestMm = 1e5f;
/// Fraction of the variance of scans below which a component is what rounding leaves: it moves them by less than a table resolves.
constexpr float kLeastExplained = 1e-9f;

/// Name of a file without its folder and ending.
std::string name_of(const std::string& path) {
  return fs::path(path).stem().string();
}

/// The OBJ files, sorted by their names.
std::vector<std::string> obj_files(const std::string& source) {
  if (is_obj_file(source)) return {source};
  std::vector<std::string> files;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(source, error))
    if (is_obj_file(entry.path().string()) && is_file_of_folder(entry))
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

/// The albedo from the picture `texture` or, if that is empty, from the pictures of the mesh's materials. Empty without pictures.
/// \param painted  has each triangle's material as its picture, and no pictures
GreyImage albedo_from_pictures(const Source& source, const ObjMesh& mesh, PaintedSurface painted,
                               const std::string& texture, int most_side,
                               std::vector<std::string>* warnings) {
  std::vector<int> picture_of(mesh.materials.size(), 0);
  if (texture.empty())
    painted.pictures = read_material_pictures(mesh, most_side, &picture_of, warnings);
  else
    painted.pictures.push_back(read_image(texture));
  if (painted.pictures.empty()) return {};
  for (int& picture : painted.picture) picture = picture_of[at(picture)];
  return albedo_of(source, painted, most_side);
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
    source_.curves = ibug_curves(source_.landmarks);
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
          if (!is_in_chart(t))
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

  /// Splits polygons into triangles, and mirrors the chart if necessary: seen from outside, u points right and v points down.
  void make_triangles() {
    std::vector<int> line;
    for (std::size_t polygon = 0, k = 0; polygon < rest_.polygon_end.size();
         k = at(rest_.polygon_end[polygon++])) {
      const std::vector<int> corners(id_of_corner_.begin() + static_cast<std::ptrdiff_t>(k),
                                     id_of_corner_.begin() + rest_.polygon_end[polygon]);
      for (const auto& t : triangles_of(corners, source_.uv, source_.neutral)) source_.triangles.push_back(t);
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
    const std::string& source = is_one_file_ ? files_.front() : folder_;
    if (scans.size() < 2) throw SourceError(source, 0, "has one scan, and --pca needs at least two");
    if (at(options_.components) >= scans.size())
      throw SourceError(source, 0,
                        std::to_string(scans.size()) + " scans have at most " +
                            std::to_string(scans.size() - 1) + " components");
    PrincipalComponents pca = find_components(scans, options_.components);
    source_.neutral = std::move(pca.mean);
    for (std::size_t k = 0; k < pca.components.size(); ++k) {
      const std::string digits = std::to_string(k);
      add_parameter(folder_,
                    "identity" + std::string(3 - std::min<std::size_t>(3, digits.size()), '0') + digits,
                    Group::identity, std::move(pca.components[k]));
      if (pca.explained[k] < kLeastExplained)
        source_.warnings.push_back("the scans differ in fewer ways than " + std::to_string(options_.components) +
                                   ": the parameter '" + source_.parameters.back().name + "' moves nothing");
    }
  }

  /// Adds the bending modes of the rest shape.
  void add_modes() {
    if (options_.modes == 0) return;
    std::vector<char> is_fixed(source_.neutral.size(), 0);
    for (std::size_t polygon = 0, k = 0; polygon < rest_.polygon_end.size(); ++polygon)
      for (; k < at(rest_.polygon_end[polygon]); ++k)
        if (rest_.is_fixed[polygon]) is_fixed[at(id_of_corner_[k])] = 1;
    BendingModes modes = surface_modes(source_, is_fixed, options_.modes, options_.stiffness, rest_.path);
    const std::size_t first = source_.parameters.size();
    for (std::size_t k = 0; k < modes.displacement.size(); ++k) {
      add_parameter(rest_.path, (k < 10 ? "mode0" : "mode") + std::to_string(k), Group::expression,
                    std::move(modes.displacement[k]));
      SourceParameter& p = source_.parameters.back();
      p.minimum = -3, p.maximum = 3, p.sd = 1;
    }
    for (ModeCorrection& c : modes.corrections)
      source_.shapes.push_back(
          {first + c.first, std::move(c.displacement), {}, {}, {}, -1, static_cast<int>(first + c.second)});
  }

  void read_albedo() {
    if (options_.texture == "none") return;
    source_.albedo = albedo_from_pictures(source_, rest_, painted_, options_.texture,
                                          options_.most_texture_side, &source_.warnings);
    if (source_.albedo.pixels.empty()) return;
    source_.has_print = true;
    source_.paint = [mesh = rest_, painted = painted_, texture = options_.texture](const Source& source,
                                                                                   int most_side) {
      std::vector<std::string> told_before;
      return albedo_from_pictures(source, mesh, painted, texture, most_side, &told_before);
    };
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
      if (p->minimum == p->maximum)
        source_.warnings.push_back("parameters.txt limits '" + name + "' to 0 and 0: the parameter moves nothing");
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

  const std::string folder_;
  const ObjOptions& options_;
  const std::vector<std::string> files_;
  const bool is_one_file_;  // the source is a file, and no folder
  ObjMesh rest_;
  PaintedSurface painted_;         // so far without pictures, and with materials in their place
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
