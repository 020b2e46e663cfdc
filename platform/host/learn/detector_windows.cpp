#include "host/learn/detector_windows.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "face/cell_strip.hpp"
#include "face/search_place.hpp"
#include "host/io/owned.hpp"

namespace pliant::host::learn {

namespace {

constexpr int kApronCells = kWindowCells + 2 * kDetectorReach, kApronPx = kApronCells * kDetectorCellPx + 2;

// A part that is laid out in an arena, in memory of the size that it measures.
template <class Part>
class LaidOut {
 public:
  explicit LaidOut(int size) {
    Arena measuring;
    part_.lay_out(measuring, size);
    lines_.resize(measuring.used_bytes() / sizeof(ArenaLine));
    Arena arena(lines_.data(), lines_.size() * sizeof(ArenaLine));
    part_.lay_out(arena, size);
    PLIANT_ASSERT(!arena.exhausted());
  }
  Part* operator->() { return &part_; }

 private:
  std::vector<ArenaLine> lines_;
  Part part_;
};

Window copy_of(const std::uint8_t* cells, int stride) {
  Window window;
  constexpr std::size_t kRow = kWindowCells * kCellChannels;
  for (int j = 0; j < kWindowCells; ++j)
    std::memcpy(window.data() + static_cast<std::size_t>(j) * kRow, cells + j * stride, kRow);
  return window;
}

}  // namespace

Window window_of(const Image& picture, const FaceBox& box) {
  const int ratio =
      std::max(static_cast<int>(std::lround(box.side * ScaledLines::kUnit / kWindowPx)), ScaledLines::kUnit);
  const ScaledLines lines(frame_of(picture), ratio);
  const float by = ScaledLines::kUnit / static_cast<float>(ratio);
  const auto first = [by](float middle) {
    return static_cast<int>(std::lround((middle + 0.5f) * by)) - kWindowPx / 2 -
           kDetectorReach * kDetectorCellPx - 1;
  };
  std::array<std::uint8_t, kApronPx * kApronPx> pixels;
  std::array<std::uint32_t, kApronPx> scratch;
  for (int y = 0; y < kApronPx; ++y)
    lines.read(first(box.center.x), first(box.center.y) + y, kApronPx, scratch.data(),
               pixels.data() + y * kApronPx);
  std::array<std::uint8_t, kApronCells * kApronCells * kCellChannels> cells;
  LaidOut<GradientCells> gradient(kApronCells * kApronCells);
  gradient->compute({pixels.data(), kApronPx, kApronPx, kApronPx}, kApronCells, kApronCells, kDetectorCellPx,
                    kDetectorReach, cells.data());
  return copy_of(cells.data() + kDetectorReach * (kApronCells + 1) * kCellChannels,
                 kApronCells * kCellChannels);
}

std::vector<WindowHit> find_hits(const Image& picture, const std::vector<DetectorTree>& trees) {
  std::vector<WindowHit> hits;
  LaidOut<CellStrip> strip(SearchPlace::most_columns(picture.width));
  SearchPlace at;
  for (at.begin(picture.width, picture.height, kWindowPx); !at.is_complete(); at.advance()) {
    if (at.begins_strip()) strip->begin(at.first_column(), at.columns(), at.row());
    strip->add_row(ScaledLines(frame_of(picture), at.ratio()));
    if (strip->rows() < kWindowCells) continue;
    for (int k = 0; k + kWindowCells <= at.columns(); ++k) {
      const int sum = sum_of_trees({trees.data(), trees.size()}, strip->window(k), strip->stride());
      if (sum != kRejected)
        hits.push_back(
            {at.box(k, strip->next_row() - kWindowCells), sum, copy_of(strip->window(k), strip->stride())});
    }
  }
  return hits;
}

int full_sum(const std::vector<DetectorTree>& trees, const Window& window, std::vector<int>* partial) {
  int sum = 0;
  if (partial != nullptr) partial->clear();
  for (const DetectorTree& tree : trees) {
    int node = 0;
    for (int level = 0; level < kTreeDepth; ++level)
      node = 2 * node + 1 +
             (window[static_cast<std::size_t>(place_of(tree.feature[node]))] >= tree.threshold[node] ? 1 : 0);
    sum += tree.leaf[node - kTreeNodes];
    if (partial != nullptr) partial->push_back(sum);
  }
  return sum;
}

}  // namespace pliant::host::learn
