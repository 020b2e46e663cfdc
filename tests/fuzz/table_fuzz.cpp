// Fuzzes model tables: a good table with changes and a right checksum, or any bytes. A table is refused by a status; one that
// is opened is tracked with through frames that show the good model, and all that the tracker tells is finite.
//
// option: --table=FILE.plm, the good table (otherwise a small one that is made here)
// input: a byte; if it is odd, a table, else changes of eight bytes each: kind, position (3), value (4)
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>

#include "aligned_block.hpp"
#include "model_table.hpp"
#include "renderer.hpp"
#include "told_results.hpp"

using namespace pliant;
using fuzz::require;

namespace {

constexpr int kSide = 128;

/// The good table, and frames of its model.
struct Film {
  std::vector<std::uint8_t> table = fuzz::small_table();
  Camera camera = centred_camera(kSide, kSide, 180);
  Pose pose;
  std::vector<Picture> frames;

  void draw() {
    const fuzz::Table words(table);
    Model model;
    require(Model::open(words.data(), words.size(), &model) == Status::ok);
    AlignedBlock block(measured_bytes<Cascade>(model));
    Arena arena(block.data(), block.size());
    Cascade cascade;
    require(create_in(arena, cascade, model) == Status::ok);
    const std::vector<float> rest(model.parameters().count, 0.0f);
    pose = frontal_pose(cascade, rest.data(), camera, kSide, 0.7f);
    Renderer renderer(cascade);
    for (int k = 0; k < 3; ++k) {
      Pose moved = pose;
      moved.t.x += static_cast<float>(k);
      frames.push_back(renderer.draw(rest.data(), moved, camera, make_backdrop(kSide, kSide, 5)));
    }
  }
};

Film& film() {
  static Film one;
  return one;
}

void track(const Model& model) {
  TrackerLimits limits = profile_s();
  limits.width = limits.height = kSide;
  limits.region_width = limits.region_height = 0;
  limits.search_work = 2000;
  static AlignedBlock block(std::size_t{1} << 23);
  Arena arena(block.data(), block.size());
  Tracker tracker;
  if (create_in(arena, tracker, model, limits) != Status::ok) return;
  const Film& f = film();
  std::vector<float> rest;
  for (const Parameter& p : model.parameters()) rest.push_back(clamp(0, p.minimum, p.maximum));
  if (tracker.start_from_pose(f.frames[0].view(0), f.camera, f.pose, rest.data()) != Status::ok)
    (void)tracker.start_from_box(f.frames[0].view(0), {30, 20}, {70, 90});
  for (std::size_t k = 1; k < f.frames.size(); ++k) {
    FrameResult result;
    const Status status = tracker.update(f.frames[k].view(k), &result);
    if (status == Status::ok) fuzz::check_result(tracker, result);
    for (const Landmark& l : model.landmarks()) {
      Vec2 x;
      if (status == Status::ok && tracker.is_started() && tracker.landmark(l.name, &x) == Status::ok)
        require(is_finite(x));
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  const std::string option = "--table=";
  for (int i = 1; i < *argc; ++i) {
    const std::string word = (*argv)[i];
    if (word.rfind(option, 0) != 0) continue;
    std::ifstream in(word.substr(option.size()), std::ios::binary);
    film().table.assign(std::istreambuf_iterator<char>(in), {});
  }
  film().draw();
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 1) return 0;
  const bool is_whole = data[0] % 2 == 1;
  fuzz::Table table(is_whole ? std::vector<std::uint8_t>(data + 1, data + size) : film().table);
  for (std::size_t at = 1; !is_whole && at + 8 <= size; at += 8) fuzz::change({table.bytes(), table.size()}, 4096, data + at);
  table.seal();
  Model model;
  if (Model::open(table.data(), table.size(), &model) == Status::ok) track(model);
  return 0;
}
