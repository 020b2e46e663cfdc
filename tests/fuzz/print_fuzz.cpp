// Fuzzes print tables: a good one with changes, a right length and right checksums. It is refused by a status, or a tracker
// searches with it in frames that show the good print, and starts there or not. All that the tracker tells is finite.
//
// input: changes of eight bytes each: kind, position (3), value (4)
#include <cstddef>

#include "aligned_block.hpp"
#include "host/bake/print_keypoints.hpp"
#include "model_table.hpp"
#include "print/print_table.hpp"
#include "random.hpp"
#include "renderer.hpp"
#include "told_results.hpp"

using namespace pliant;
using fuzz::require;

namespace {

constexpr int kSide = 128;
constexpr std::size_t kFrames = 4;  // a start, and three of its track

/// Boxes of many sizes and greys: corners that differ.
TexturedModel::Paint boxes() {
  constexpr int kCells = 96;
  std::vector<float> grey(kCells * kCells, 128);
  Random random(4);
  for (int k = 0; k < 120; ++k) {
    const int left = random.below(kCells), top = random.below(kCells), side = 4 + random.below(20);
    const auto value = static_cast<float>(random.below(256));
    for (int y = top; y < std::min(kCells, top + side); ++y)
      for (int x = left; x < std::min(kCells, left + side); ++x)
        grey[static_cast<std::size_t>(y * kCells + x)] = value;
  }
  return [grey](float u, float v) {
    const int x = static_cast<int>(u * (kCells - 1)), y = static_cast<int>(v * (kCells - 1));
    return grey[static_cast<std::size_t>(y * kCells + x)];
  };
}

/// A small model with a print.
std::vector<std::uint8_t> printed_table() {
  TexturedModel model;
  model.albedo_side = 192;
  model.paint = boxes();
  const fuzz::Table plain(model.bytes());
  Model opened;
  require(Model::open(plain.data(), plain.size(), &opened) == Status::ok);
  model.print = host::bake::make_print_table(opened);
  require(!model.print.empty());
  return model.bytes();
}

/// The good table, where its print is, and frames of its model.
struct Film {
  std::vector<std::uint8_t> table = printed_table();
  std::size_t print_at = 0, print_bytes = 0;
  std::vector<Picture> frames;

  Film() {
    const fuzz::Table words(table);
    Model model;
    require(Model::open(words.data(), words.size(), &model) == Status::ok);
    print_at = static_cast<std::size_t>(model.print().data - words.span().data);
    print_bytes = model.print().count;
    AlignedBlock block(measured_bytes<Cascade>(model));
    Arena arena(block.data(), block.size());
    Cascade cascade;
    require(create_in(arena, cascade, model) == Status::ok);
    const std::vector<float> rest(model.parameters().count, 0.0f);
    const Camera camera = centred_camera(kSide, kSide, 180);
    Pose pose = frontal_pose(cascade, rest.data(), camera, kSide, 0.9f);
    Renderer renderer(cascade);
    for (std::size_t k = 0; k < kFrames; ++k, pose.t.x += 1)
      frames.push_back(renderer.draw(rest.data(), pose, camera, make_backdrop(kSide, kSide, 5)));
  }
};

Film& film() {
  static Film one;
  return one;
}

/// Makes length and checksum of a print right. A length beyond the section's end stays wrong: the table is refused.
void seal(Span<std::uint8_t> print) {
  auto* const header = reinterpret_cast<PrintHeader*>(print.data);
  const std::size_t total = sizeof(PrintHeader) + sizeof(Quat) * header->view_count +
                            sizeof(float) * header->level_count +
                            sizeof(PrintKeypoint) * header->keypoint_count;
  if (total <= print.count) header->total_bytes = static_cast<std::uint32_t>(total);
  constexpr std::size_t kSummedFrom = offsetof(PrintHeader, keypoint_count);
  if (header->total_bytes >= kSummedFrom && header->total_bytes <= print.count)
    header->crc32 = crc32(print.data + kSummedFrom, header->total_bytes - kSummedFrom);
}

/// \return whether a track has started.
bool track(const Model& model) {
  TrackerLimits limits = profile_s();
  limits.width = limits.height = kSide;
  limits.region_width = limits.region_height = 0;
  limits.detection = &kPrintDetection;
  limits.search_work = 1000000;  // a search takes one frame
  static AlignedBlock block(std::size_t{1} << 23);
  Arena arena(block.data(), block.size());
  Tracker tracker;
  if (create_in(arena, tracker, model, limits) != Status::ok) return false;
  for (std::size_t k = 0; k < kFrames; ++k) {
    FrameResult result;
    const Status status = tracker.update(film().frames[k].view(k), &result);
    if (status == Status::ok) {
      require(result.is_searching != tracker.is_started());
      fuzz::check_result(tracker, result);
    }
    for (const Landmark& l : model.landmarks()) {
      Vec2 x;
      if (status == Status::ok && tracker.is_started() && tracker.landmark(l.name, &x) == Status::ok)
        require(is_finite(x));
    }
  }
  return tracker.is_started();
}

/// Runs the good table with these changes.
bool track_with(const std::uint8_t* data, std::size_t size) {
  const Film& f = film();
  fuzz::Table table(f.table);
  const Span<std::uint8_t> print{table.bytes() + f.print_at, f.print_bytes};
  for (std::size_t at = 0; at + 8 <= size; at += 8) fuzz::change(print, 512, data + at);
  seal(print);
  table.seal();
  Model model;
  return Model::open(table.data(), table.size(), &model) == Status::ok && track(model);
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  require(track_with(nullptr, 0));  // the good table starts
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  track_with(data, size);
  return 0;
}
