#include "host/bake/obj_source.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>

#include "host/bake/at.hpp"
#include "host/bake/chart_raster.hpp"
#include "host/bake/chart_relaxation.hpp"
#include "host/bake/obj_file.hpp"
#include "host/bake/principal_components.hpp"
#include "host/bake/source_error.hpp"
#include "host/io/words.hpp"

namespace pliant::host::bake {

namespace {

namespace fs = std::filesystem;
/// Names of the OBJ files, sorted, without their ending.
std::vector<std::string> obj_names(const std::string& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error))
    if (entry.path().extension() == ".obj") names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
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
  FolderReader(const std::string& folder, const ObjOptions& options)
      : folder_(folder), options_(options), names_(obj_names(folder)) {}

  Source run() {
    const bool scans = options_.components > 0;
    const bool has_neutral = std::find(names_.begin(), names_.end(), "neutral") != names_.end();
    if (!scans && !has_neutral) throw SourceError(folder_ + "/neutral.obj", 0, "cannot be read");
    rest_ = read_obj(path(scans ? names_[0] : "neutral"));
    make_vertices();
    make_triangles();
    if (scans)
      read_scans();
    else
      read_shapes();
    if (options_.relaxes_chart) relax_chart(source_.uv, source_.neutral, source_.triangles);
    read_landmarks();
    set_origin();
    add_curves();
    return std::move(source_);
  }

 private:
  std::string path(const std::string& name) const { return folder_ + "/" + name + ".obj"; }
  void report_progress(std::size_t done) const {
    if (options_.progress) options_.progress("files", done, names_.size());
  }

  /// Makes one vertex for each pair of position and texture coordinate. A position on a cut of the chart has several.
  void make_vertices() {
    std::map<std::pair<int, int>, int> ids;
    for (std::size_t polygon = 0, k = 0; polygon < rest_.polygon_end.size(); ++polygon)
      for (; k < at(rest_.polygon_end[polygon]); ++k) {
        const ObjCorner c = rest_.corners[k];
        if (c.texture < 0)
          throw SourceError(rest_.path, rest_.polygon_line[polygon], "the face has no texture coordinates");
        const auto [entry, fresh] = ids.insert({{c.vertex, c.texture}, static_cast<int>(ids.size())});
        if (fresh) {
          const Vec2 t = rest_.texture[at(c.texture)];
          if (!(t.x >= 0 && t.x <= 1 && t.y >= 0 && t.y <= 1))
            throw SourceError(rest_.path, rest_.polygon_line[polygon],
                              "a texture coordinate of the face is outside 0 to 1");
          source_.uv.push_back({t.x, 1 - t.y});
          vertex_of_.push_back(c.vertex);
          first_id_.insert({c.vertex, entry->second});
        }
        id_of_corner_.push_back(entry->second);
      }
    source_.neutral = placed(rest_.vertices);
  }

  std::vector<Vec3> placed(const std::vector<Vec3>& positions) const {
    std::vector<Vec3> result;
    for (int v : vertex_of_) result.push_back(options_.unit_mm * positions[at(v)]);
    return result;
  }

  /// Splits polygons into fans, and mirrors the chart if necessary: seen from outside, u points right and v points down.
  void make_triangles() {
    std::vector<int> line;
    for (std::size_t polygon = 0, k = 0; polygon < rest_.polygon_end.size();
         k = at(rest_.polygon_end[polygon++]))
      for (std::size_t c = k + 2; c < at(rest_.polygon_end[polygon]); ++c) {
        source_.triangles.push_back({id_of_corner_[k], id_of_corner_[c - 1], id_of_corner_[c]});
        line.push_back(rest_.polygon_line[polygon]);
      }
    if (source_.triangles.empty()) throw SourceError(rest_.path, 0, "holds no faces");
    source_.is_hole.assign(source_.triangles.size(), 0);
    double sum = 0;
    for (float area : chart_areas(source_.uv, source_.triangles)) sum += static_cast<double>(area);
    if (sum > 0)
      for (Vec2& uv : source_.uv) uv.x = 1 - uv.x;
    const auto areas = chart_areas(source_.uv, source_.triangles);
    for (std::size_t f = 0; f < areas.size(); ++f)
      if (areas[f] > 1e-9f) throw SourceError(rest_.path, line[f], "the chart has a fold-over at this face");
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
      for (const std::string& name : names_) {
        if (name == "neutral" || (name.compare(0, 8, "identity") == 0) != identity) continue;
        auto moved = placed(read_obj_positions(path(name), rest_));
        for (std::size_t v = 0; v < moved.size(); ++v) moved[v] = moved[v] - source_.neutral[v];
        add_parameter(path(name), parameter_name(name), identity ? Group::identity : Group::expression,
                      std::move(moved));
        report_progress(++done);
      }
  }

  void read_scans() {
    std::vector<std::vector<Vec3>> scans;
    for (const std::string& name : names_) {
      scans.push_back(placed(read_obj_positions(path(name), rest_)));
      report_progress(scans.size());
    }
    if (scans.size() < 2 || at(options_.components) >= scans.size())
      throw SourceError(folder_, 0,
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

  void read_landmarks() {
    const std::string file = folder_ + "/landmarks.csv";
    if (!fs::exists(file)) return;
    std::ifstream in(file);
    std::string line;
    int number = 0;
    while (std::getline(in, line)) {
      ++number;
      if (!line.empty() && line.back() == '\r') line.pop_back();
      if (number == 1) {
        if (line != "landmark,vertex") throw SourceError(file, 1, "expected the columns landmark,vertex");
        continue;
      }
      if (line.empty()) continue;
      const std::size_t comma = line.find(',');
      char* end = nullptr;
      const long vertex = comma == std::string::npos ? -1 : std::strtol(line.c_str() + comma + 1, &end, 10);
      if (vertex < 0 || *end != 0 || end == line.c_str() + comma + 1 || comma == 0)
        throw SourceError(file, number, "'" + line + "' is not a landmark and a vertex");
      check_name(file, number, line.substr(0, comma));
      const auto id = first_id_.find(static_cast<int>(std::min(vertex, 1L << 30)));
      if (id == first_id_.end())
        throw SourceError(file, number, "there is no vertex " + line.substr(comma + 1) + " on a face");
      source_.landmarks.push_back({line.substr(0, comma), source_.uv[at(id->second)]});
      landmark_vertex_[line.substr(0, comma)] = id->second;
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
        const auto vertex =
            landmark_vertex_.find(std::string("ibug") + (k < 10 ? "0" : "") + std::to_string(k));
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
  const std::vector<std::string> names_;
  ObjMesh rest_;
  std::vector<int> id_of_corner_;  // ours, of each corner of rest_
  std::vector<int> vertex_of_;     // the file's, of each of our vertices
  std::map<int, int> first_id_;    // ours, of each of the file's
  std::map<std::string, int> landmark_vertex_;
  Source source_;
};

}  // namespace

Source read_obj_folder(const std::string& folder, const ObjOptions& options) {
  return FolderReader(folder, options).run();
}

bool is_obj_folder(const std::string& folder) {
  return !obj_names(folder).empty();
}

}  // namespace pliant::host::bake
