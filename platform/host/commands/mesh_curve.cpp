#include "host/commands/mesh_curve.hpp"

#include <cstdio>

namespace pliant::host {

namespace {

class Table {
 public:
  Table(const Model& model, ModelSurface& surface) : model_(model), surface_(surface) {}

  /// \return number of vertices of the mesh.
  int add(const char* criterion, const char* format, double setting, const MeshRequest& request) {
    const ModelMesh mesh(model_, surface_, request);
    const ContourError error = mesh.measure();
    char label[32], line[160];
    std::snprintf(label, sizeof label, format, setting);
    std::snprintf(line, sizeof line, "| %s | %s | %d | %d | %.3f | %.2f |\n", criterion, label,
                  mesh.mesh().vertex_count(), mesh.mesh().face_count(), static_cast<double>(error.mean_mm),
                  static_cast<double>(error.max_mm));
    text_ += line;
    return mesh.mesh().vertex_count();
  }
  const std::string& text() const { return text_; }

 private:
  const Model& model_;
  ModelSurface& surface_;
  std::string text_ =
      "| criterion | setting | vertices | faces | mean mm | max mm |\n"
      "|---|---|---:|---:|---:|---:|\n";
};

}  // namespace

std::string mesh_curve(const Model& model, ModelSurface& surface, const std::vector<float>& tolerances_mm) {
  Table table(model, surface);
  constexpr int kDepth = 12;  // deep enough that tolerances and budgets are what ends refinement
  table.add("base mesh", "", 0, {});
  for (const int depth : {1, 2, 3, 4})
    table.add("unconditional", "depth %.0f", depth, {MeshCriterion::uniform, depth, 0, 0});
  for (const float degrees : {60.0f, 45.0f, 30.0f, 20.0f})
    table.add("normals", "%.0f degrees", static_cast<double>(degrees),
              {MeshCriterion::normals, kDepth, degrees, 0});
  for (const float mm : tolerances_mm) {
    const int vertices =
        table.add("contour", "%.2f mm", static_cast<double>(mm), {MeshCriterion::contour, kDepth, mm, 0});
    table.add("budget", "%.0f vertices", vertices, {MeshCriterion::contour, kDepth, 0, vertices});
  }
  return table.text();
}

}  // namespace pliant::host
