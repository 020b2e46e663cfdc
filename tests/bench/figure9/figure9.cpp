// Re-creates the paper's Figures 8 and 9: how well markers are tracked with meshes adapted by different criteria, from
// observations at mesh vertices only and with anchors beside them.
#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iostream>

#include "../program.hpp"
#include "error_plot.hpp"
#include "host/io/files.hpp"
#include "mesh_tracker.hpp"
#include "statistics.hpp"

namespace pliant::figure9 {
namespace {

struct Run {
  std::string name;
  MeshKind kind = MeshKind::base;
  int vertices = 0, tracked = 0, failures = 0;
  std::vector<double> error, milliseconds;
  std::vector<double> clear;  // error of the frames in which nothing passes before the face
};

void track(Run& run, const Model& model, const Experiment& e, int budget, bool has_anchors) {
  MeshTracker tracker(model, e, {run.kind, budget}, has_anchors);
  run.tracked = tracker.tracked();
  for (std::size_t k = 1; k < e.frames.size(); ++k) {
    const Outcome o = tracker.update(k);
    run.error.push_back(o.error_px);
    if (e.is_hidden[k] == 0) run.clear.push_back(o.error_px);
    run.milliseconds.push_back(o.milliseconds);
    run.failures += o.state != TrackState::tracking;
  }
  run.vertices = tracker.vertices();
}

void print_table(const std::vector<Run>& runs) {
  std::cout << "mesh,vertices,followed,mean_px,median_px,p95_px,last_100_px,clear_px,failures,median_ms\n";
  for (const Run& r : runs) {
    const Summary s = summarise(r.error);
    std::cout << r.name << "," << r.vertices << "," << r.tracked << "," << s.mean << "," << s.median << ","
              << s.p95 << "," << s.last_100 << "," << summarise(r.clear).mean << "," << r.failures << ","
              << summarise(r.milliseconds).median << "\n";
  }
}

void print_difference(const char* claim, const Run& a, const Run& b) {
  std::cout << claim << "," << a.name << " - " << b.name;
  for (const Difference& d : {paired_difference(a.error, b.error), paired_difference(a.clear, b.clear)})
    std::cout << "," << d.mean << "," << d.low << "," << d.high;
  std::cout << "\n";
}

void compare(const std::vector<Run>& r) {
  const Run &base = r[0], &normals = r[1], &contour = r[2], &uniform = r[3], &budgeted = r[4],
            &adaptive = r[5];
  std::cout << "claim,difference,mean_px,low_px,high_px,clear_mean_px,clear_low_px,clear_high_px\n";
  for (std::size_t k = 1; k < r.size(); ++k) print_difference("base is worst (> 0)", base, r[k]);
  print_difference("contour no worse than normals (<= 0)", contour, normals);
  print_difference("contour within 5 % of unconditional", contour, uniform);
  std::cout << "contour / unconditional: error "
            << summarise(contour.error).mean / summarise(uniform.error).mean << ", in clear frames "
            << summarise(contour.clear).mean / summarise(uniform.clear).mean << ", vertices "
            << static_cast<double>(contour.vertices) / uniform.vertices << "\n";
  print_difference("budgeted no worse than contour (<= 0)", budgeted, contour);
  print_difference("adaptive across frames better than contour (< 0)", adaptive, contour);
}

/// Vertex budget of a mesh: the paper's fractions (normals 1200, others 1900 of 4400) of three unconditional levels.
int budget_of(MeshKind kind) {
  constexpr int kUnconditional = 3502;
  if (kind == MeshKind::base || kind == MeshKind::unconditional) return 0;
  return kUnconditional * (kind == MeshKind::normals ? 1200 : 1900) / 4400;
}

void run_setting(const Model& model, const Experiment& e, bool has_anchors, const std::string& folder) {
  constexpr std::pair<const char*, MeshKind> kKinds[] = {
      {"base", MeshKind::base},         {"normals", MeshKind::normals},
      {"contour", MeshKind::contour},   {"unconditional", MeshKind::unconditional},
      {"budgeted", MeshKind::budgeted}, {"adaptive", MeshKind::adaptive}};
  std::vector<Run> runs;
  const std::string setting = has_anchors ? "vertices and anchors" : "vertices only";
  std::vector<Curve> curves;
  for (const auto& [name, kind] : kKinds) {
    Run run;
    run.name = name;
    run.kind = kind;
    track(run, model, e, budget_of(kind), has_anchors);
    curves.push_back({run.name, run.error});
    std::cerr << e.name << ", " << setting << ": " << run.name << " done\n";
    runs.push_back(std::move(run));
  }
  std::cout << "\n# " << e.name << ", " << setting << ": " << e.frames.size() << " frames, "
            << e.truth[0].size() << " markers\n";
  print_table(runs);
  compare(runs);
  host::write_file(folder + "/figure9_" + e.name + (has_anchors ? "_anchors" : "_vertices") + ".svg",
                   error_plot("Marker error, " + e.name + " sequence, " + setting, curves, e.is_hidden,
                              e.frames_per_second));
}

int usage() {
  std::cerr << "usage: figure9 face.plm FOLDER FRAMES\n"
               "       figure9 face.plm FOLDER FRAMES VIDEO.y4m EVERY INIT.csv MARKERS.csv TRUTH.csv\n"
               "Tables on standard output, error plots in FOLDER. FRAMES: of the rendered sequence (900), or "
               "most used\n"
               "of the video, every EVERYth; points as landmark,x,y, truth as frame,landmark,x,y.\n";
  return 2;
}

int run(int count, char** words) {
  if (count != 4 && count != 9) return usage();
  const int frames = std::atoi(words[3]);
  if (frames < 2) return usage();
  const host::ModelFile file(words[1]);
  Recording recording;
  if (count == 9) {
    recording = {words[4], words[6], words[7], words[8], std::atoi(words[5]), frames};
    if (recording.every < 1) return usage();
  }
  const Experiment e = count == 4 ? make_rendered(file.model(), words[1], frames)
                                  : read_recorded(file.model(), words[1], recording);
  for (const bool has_anchors : {false, true}) run_setting(file.model(), e, has_anchors, words[2]);
  return 0;
}

}  // namespace
}  // namespace pliant::figure9

int main(int count, char** words) {
  return pliant::run_program("figure9", pliant::figure9::run, count, words);
}
