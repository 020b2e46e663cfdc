// Bakes random meshes, one in five with a defect. Each is baked right or refused by one line that says why. Right is: the table
// opens, its rest shape is within 3 % of the surface's diagonal at every vertex and within 0.4 % on average, and the base mesh
// is valid, has the surface's topology and no inverted triangle. A mesh without a defect is never refused.
// One file in eight is damaged byte by byte: it is refused by one line, or its table opens and has a valid base mesh.
//
// usage: any_mesh_fuzz [COUNT [FIRST_SEED]]
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>

#include "host/bake/bake.hpp"
#include "host/bake/opened_table.hpp"
#include "host/io/owned.hpp"
#include "pliant/mesh.hpp"
#include "random_surface.hpp"

using namespace pliant;
using namespace pliant::host;

namespace {

const std::string kDamage = "damaged bytes";

/// Replaces, removes or repeats some bytes.
std::string damaged(std::string text, Random& random) {
  const std::string letters = "0123456789 ./-+eEvtfng\n\r#";
  for (int k = 1 + random.below(6); k > 0; --k) {
    const auto at = static_cast<std::size_t>(random.below(static_cast<int>(text.size())));
    const auto count = std::min(text.size() - at, static_cast<std::size_t>(1 + random.below(20)));
    const int what = random.below(4);
    if (what == 0) text[at] = static_cast<char>(random.below(256));
    if (what == 1)
      text[at] = letters[static_cast<std::size_t>(random.below(static_cast<int>(letters.size())))];
    if (what == 2) text.erase(at, count);
    if (what == 3) text.insert(at, text.substr(at, count));
    if (text.empty()) return "v";
  }
  return text;
}

struct Counts {
  int right = 0, refused = 0, wrong = 0;
  float worst = 0, worst_mean = 0;
};

/// Empty if the base mesh is right, else what is wrong with it.
std::string base_mesh_fault(const Model& model, const RandomSurface& surface) {
  MeshLimits limits;
  limits.vertices = static_cast<std::uint16_t>(model.base_uv().count);
  limits.faces = static_cast<std::uint16_t>(model.base_corners().count / 3);
  Owned<Mesh> mesh(limits);
  if (mesh->set_base(model.base_uv(), model.base_corners()) != Status::ok) return "the base mesh is refused";
  if (mesh->validate().invariant != 0) return "the base mesh is not valid";
  if (surface.defect == kDamage) return "";
  const MeshStatistics s = mesh->compute_statistics();
  if (s.euler != surface.euler()) return "the base mesh has another topology";
  double area = 0;
  for (const FaceId f : mesh->faces()) {
    const Vec2 a = mesh->uv(mesh->corner(f, 0)), b = mesh->uv(mesh->corner(f, 1)),
               c = mesh->uv(mesh->corner(f, 2));
    const float twice = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    if (!(twice < 0)) return "a triangle of the base mesh is inverted";
    area -= 0.5 * static_cast<double>(twice);
  }
  const double wanted = surface.chart_area();
  if (!(area > 0.75 * wanted && area < 1.34 * wanted))
    return "the base mesh covers " + std::to_string(area / wanted) + " of the chart";
  return "";
}

std::string fault_of(const bake::BakeOptions& options, const RandomSurface& surface, Counts& counts) {
  std::vector<std::uint8_t> table;
  std::string error;
  bake::BakeReport report;
  if (!bake::bake(options, table, error, &report)) {
    ++counts.refused;
    if (error.empty() || error.find('\n') != std::string::npos) return "refused without one line";
    return surface.defect.empty() ? "refused: " + error : "";
  }
  const bool is_damaged = surface.defect == kDamage;
  if (!surface.defect.empty() && surface.defect != RandomSurface::kPerhaps && !is_damaged)
    return "not refused";
  const bake::OpenedTable opened(table);
  if (opened.status() != Status::ok) return "the table does not open";
  const float diagonal = surface.diagonal();
  const float worst = report.errors.rest.max_mm / diagonal, mean = report.errors.rest.mean_mm / diagonal;
  if (is_damaged) {
    const std::string fault = base_mesh_fault(opened.model(), surface);
    if (fault.empty()) ++counts.right;
    return fault;
  }
  counts.worst = std::max(counts.worst, worst);
  counts.worst_mean = std::max(counts.worst_mean, mean);
  if (!(worst <= 0.03f) || !(mean <= 0.004f))
    return "off by " + std::to_string(worst) + ", on average " + std::to_string(mean) + " of its diagonal";
  const std::string fault = base_mesh_fault(opened.model(), surface);
  if (fault.empty()) ++counts.right;
  return fault;
}

}  // namespace

int main(int argc, char** argv) {
  const int count = argc > 1 ? std::atoi(argv[1]) : 150;
  const auto first = static_cast<std::uint64_t>(argc > 2 ? std::atoll(argv[2]) : 1);
  const std::string path =
      (std::filesystem::temp_directory_path() /
       ("pliant_any_mesh_" + std::to_string(first) + "_" + std::to_string(getpid()) + ".obj"))
          .string();
  std::map<std::string, Counts> all;
  double slowest = 0;
  int wrong = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    RandomSurface surface = SurfaceMaker(seed).make();
    Random random(seed);
    std::string text = surface.obj();
    if (seed % 8 == 7) {
      surface.kind = surface.defect = kDamage;
      text = damaged(text, random);
    }
    std::ofstream(path, std::ios::binary) << text;
    bake::BakeOptions options;
    options.source = path;
    options.size = 32 << random.below(3);
    options.modes = surface.kind == "tube" || surface.kind == "annulus" ? random.below(4) : 0;
    options.base_vertices = random.below(4) == 0 ? 60 + random.below(1500) : 60 + random.below(300);
    const auto start = std::chrono::steady_clock::now();
    Counts& counts = all[surface.kind];
    // 10,000 take a quarter of an hour: whoever stops it sees how far it came.
    if (seed > first && (seed - first) % 500 == 0) {
      std::printf("%d of %d, %d wrong\n", static_cast<int>(seed - first), count, wrong);
      std::fflush(stdout);
    }
    const std::string fault = fault_of(options, surface, counts);
    slowest =
        std::max(slowest, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    if (fault.empty()) continue;
    ++wrong, ++counts.wrong;
    std::printf("seed %llu, %s%s%s, size %d, %d vertices: %s\n", static_cast<unsigned long long>(seed),
                surface.kind.c_str(), surface.defect.empty() ? "" : ", ", surface.defect.c_str(),
                options.size, options.base_vertices, fault.c_str());
    std::fflush(stdout);
  }
  std::filesystem::remove(path);
  for (const auto& [kind, c] : all)
    std::printf("%-13s right %5d  refused %5d  wrong %3d  worst %.4f  mean %.5f of the diagonal\n",
                kind.c_str(), c.right, c.refused, c.wrong, static_cast<double>(c.worst),
                static_cast<double>(c.worst_mean));
  std::printf("%d meshes, %d wrong, slowest %.2f s\n", count, wrong, slowest);
  return wrong == 0 ? 0 : 1;
}
