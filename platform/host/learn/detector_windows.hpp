#pragma once
/// \file detector_windows.hpp
/// The detector's windows of pictures, as training sees them: the same cells that FaceDetector computes.
#include <array>
#include <vector>

#include "face/detector_table.hpp"
#include "host/io/image.hpp"
#include "pliant/face_box.hpp"

namespace pliant::host::learn {

constexpr int kWindowFeatures = kWindowCells * kWindowCells * kCellChannels;
/// All channels of a window, cells by rows.
using Window = std::array<std::uint8_t, kWindowFeatures>;

/// The place of a feature in a Window.
constexpr int place_of(std::uint16_t feature) {
  return feature / 256 * kWindowCells * kCellChannels + feature % 256;
}
/// The feature at a place of a Window.
constexpr std::uint16_t feature_at(int place) {
  constexpr int kRow = kWindowCells * kCellChannels;
  return detector_feature(place / kRow, place % kRow / kCellChannels, place % kCellChannels);
}

/// The window of a box, at the nearest place that whole pixels of the reduced picture allow. A box smaller than the window
/// counts as one of the window's size.
Window window_of(const Image& picture, const FaceBox& box);

/// A window that a cascade takes for a face.
struct WindowHit {
  FaceBox box;
  int sum;
  Window window;
};

/// All hits in a picture, at all sizes, in the order of the search.
std::vector<WindowHit> find_hits(const Image& picture, const std::vector<DetectorTree>& trees);

/// The sum of the trees without rejection; `partial` takes the sums after each tree, if not null.
int full_sum(const std::vector<DetectorTree>& trees, const Window& window,
             std::vector<int>* partial = nullptr);

}  // namespace pliant::host::learn
