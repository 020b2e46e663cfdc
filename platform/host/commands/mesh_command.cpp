// `pliant mesh`: adapts a model's mesh at given parameters, writes it and prints its error; or compares all criteria in a
// figure and a table.
#include "host/commands/command.hpp"
#include "host/commands/mesh_curve.hpp"
#include "host/io/failure.hpp"
#include "host/io/files.hpp"
#include "host/io/fit_file.hpp"
#include "host/io/image.hpp"
#include "host/io/mesh_files.hpp"
#include "host/io/numbers.hpp"
#include "host/io/words.hpp"
#include "host/render/mesh_figure.hpp"
#include "host/render/shown_mesh.hpp"

namespace pliant::host {

namespace {

/// Most vertices that can be asked for: half as many as a mesh has faces, and a margin for those of the border.
constexpr int kMostVertices = 11000;
static_assert(kMostVertices > MeshLimits::kMostFaces / 2,
              "a mesh that is full has about half as many vertices as faces");

MeshCriterion criterion_named(const std::string& name) {
  if (name == "none") return MeshCriterion::none;
  if (name == "uniform") return MeshCriterion::uniform;
  if (name == "normals") return MeshCriterion::normals;
  if (name == "contour") return MeshCriterion::contour;
  fail_usage("--criterion must be none, uniform, normals or contour: " + name);
}

MeshRequest request_of(const Args& args) {
  const std::string name = args.text("--criterion").value_or("contour");
  MeshRequest request;
  request.criterion = criterion_named(name);
  const bool is_none = request.criterion == MeshCriterion::none;
  const bool is_uniform = request.criterion == MeshCriterion::uniform;
  const std::string why = "does not apply to the criterion " + name;
  if (is_none || is_uniform) args.refuse({"--threshold"}, why);
  if (is_none) args.refuse({"--depth", "--budget"}, why);
  request.depth = args.integer("--depth", is_uniform ? 3 : request.depth, 0, MeshLimits::kDeepest);
  request.budget = args.integer("--budget", 0, 1, kMostVertices);
  const bool is_contour = request.criterion == MeshCriterion::contour;
  const double otherwise = args.has("--budget") ? 0 : is_contour ? 0.3 : 30;
  request.threshold =
      static_cast<float>(args.number("--threshold", otherwise, 0.001, is_contour ? 1000 : 180));
  return request;
}

std::vector<float> parameters_of(const Args& args, const ModelFile& file) {
  NamedValues values;
  for (const std::string& word : args.texts("--param")) {
    const std::size_t equals = word.find('=');
    const auto value = equals == std::string::npos ? std::nullopt : parse_float(word.substr(equals + 1));
    if (!value) fail_usage("--param must be NAME=VALUE: " + word);
    for (const auto& [name, earlier] : values)
      if (name == word.substr(0, equals)) fail_usage("--param gives " + name + " twice");
    values.push_back({word.substr(0, equals), *value});
  }
  std::vector<float> q(file.model().parameters().count, 0.0f);
  const auto unmatched = apply(values, "--param", file.model(), q.data());
  if (!unmatched.empty()) fail_input(file.path(), "has no parameter '" + unmatched[0] + "'");
  return q;
}

enum class MeshFormat { obj, ply, glb };

MeshFormat format_of(const std::string& path) {
  const std::string name = in_lower_case(path);
  if (ends_with(name, ".obj")) return MeshFormat::obj;
  if (ends_with(name, ".ply")) return MeshFormat::ply;
  if (ends_with(name, ".glb")) return MeshFormat::glb;
  fail_usage("-o must end in .obj, .ply or .glb: " + path);
}

/// With --mirror-u the mesh has the u of a source whose chart was mirrored.
MeshData written_mesh(const Args& args, MeshData data) {
  if (args.has("--mirror-u"))
    for (Vec2& uv : data.uv) uv.x = 1 - uv.x;
  return data;
}

std::string bytes_of(const MeshData& data, MeshFormat format, const Model& model) {
  switch (format) {
    case MeshFormat::obj:
      return obj_text(data);
    case MeshFormat::ply:
      return ply_bytes(data);
    case MeshFormat::glb:
      break;
  }
  return glb_bytes(data, albedo_png(model));
}

const char* reason(const ModelMesh& mesh, MeshCriterion criterion) {
  switch (mesh.report().stop) {
    case AdaptStop::converged:
      if (criterion == MeshCriterion::none) return "the base mesh";
      return criterion != MeshCriterion::uniform && mesh.is_within_tolerance() ? "within tolerance"
                                                                               : "as deep as --depth allows";
    case AdaptStop::no_room:
      return "no room for more";
    case AdaptStop::operations:
      break;
  }
  return "too many operations";
}

void print_report(const ModelMesh& mesh, MeshCriterion criterion, const std::string& path,
                  std::ostream& out) {
  const MeshStatistics size = mesh.mesh().compute_statistics();
  const ContourError error = mesh.measure();
  char line[256];
  std::snprintf(line, sizeof line, ": %d vertices, %d faces, deepest level %d (base: %d vertices, %d faces)\n",
                size.vertices, size.faces, size.deepest, mesh.mesh().base_vertex_count(),
                mesh.mesh().base_face_count());
  out << path << line;
  std::snprintf(line, sizeof line, "error: mean %.4f mm, maximum %.3f mm, over %.0f mm2\n",
                static_cast<double>(error.mean_mm), static_cast<double>(error.max_mm),
                static_cast<double>(error.area_mm2));
  out << line;
  std::snprintf(line, sizeof line, "adapted in %.1f ms: %d splits, %d welds, %s\n", mesh.milliseconds(),
                mesh.report().splits, mesh.report().welds, reason(mesh, criterion));
  out << line;
}

/// Compares all criteria in a picture, a table or both.
int compare_criteria(const Args& args, Console& console) {
  args.refuse({"--criterion", "--depth", "--threshold", "--budget", "-o", "--mirror-u", "--uv-svg"},
              "does not apply to --figure and --curve, which compare all criteria");
  const ModelFile file(args.operand(0));
  ModelSurface surface(file.model(), parameters_of(args, file));
  if (const auto path = args.text("--figure"))
    write_file(*path, encode_png(draw_mesh_figure(file.model(), surface)));
  const std::vector<float> tolerances_mm{1.0f, 0.7f, 0.5f, 0.35f, 0.25f, 0.18f, 0.12f};
  if (args.has("--curve")) console.out << mesh_curve(file.model(), surface, tolerances_mm);
  return 0;
}

int run_mesh(const Args& args, Console& console) {
  if (args.has("--figure") || args.has("--curve")) return compare_criteria(args, console);
  const MeshRequest request = request_of(args);
  const auto output = args.text("-o");
  const MeshFormat format = output ? format_of(*output) : MeshFormat::obj;
  if (args.has("--mirror-u") && (!output || format == MeshFormat::glb))
    fail_usage("--mirror-u needs -o with an OBJ or PLY file: the texture in a GLB is that of the model");
  const ModelFile file(args.operand(0));
  ModelSurface surface(file.model(), parameters_of(args, file));
  const ModelMesh mesh(file.model(), surface, request);
  if (request.budget != 0 && request.budget < mesh.mesh().vertex_count())
    console.err << "note: --budget " << request.budget
                << " is less than the base mesh has; nothing was refined\n";
  const MeshData data = mesh_data(mesh);
  if (output) write_file(*output, bytes_of(written_mesh(args, data), format, file.model()));
  if (const auto chart = args.text("--uv-svg")) write_file(*chart, chart_svg(data));
  print_report(mesh, request.criterion, output.value_or(file.path()), console.out);
  return 0;
}

}  // namespace

Command mesh_command() {
  return {"mesh",
          "Adapts a model's mesh to its surface, writes it and prints its distance from the surface.",
          "face.plm [--criterion none|uniform|normals|contour] [--depth N] [--threshold X] [--budget N] "
          "[--param NAME=VALUE ...] [-o mesh.obj|.ply|.glb] [--mirror-u] [--uv-svg chart.svg] | face.plm "
          "[--figure "
          "figure.png] "
          "[--curve] [--param NAME=VALUE ...]",
          {{"--criterion", "NAME", "where to refine: none, uniform, normals, contour (contour)"},
           {"--depth", "N", "bisections, 0 to 24: those of uniform (3), the most of any other (12)"},
           {"--threshold", "X",
            "normals: degrees between faces (30); contour: mean error of a triangle in mm (0.3)"},
           {"--budget", "N", "most vertices, up to 11000; without a threshold, the best mesh of so many"},
           {"--param", "NAME=VALUE", "a parameter of the model; may be given several times", Takes::texts},
           {"-o", "FILE", "the mesh to write: OBJ, PLY or GLB by its ending", Takes::output},
           {"--mirror-u", nullptr, "OBJ and PLY: write 1 - u, the u of a source whose chart bake mirrored"},
           {"--uv-svg", "SVG", "the mesh over the chart, tinted by level", Takes::output},
           {"--figure", "PNG", "all criteria side by side: chart, surface, texture", Takes::output},
           {"--curve", nullptr, "all criteria as a Markdown table: vertices, faces, errors"}},
          1,
          run_mesh};
}

}  // namespace pliant::host
