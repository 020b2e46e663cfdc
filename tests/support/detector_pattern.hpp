#pragma once
// A drawing, and a detector's table that finds it, made by hand.
#include <algorithm>
#include <cstring>
#include <vector>

#include "face/detector_table.hpp"
#include "pliant/model.hpp"
#include "texture.hpp"

namespace detector_pattern {

/// Bytes aligned as a table must be.
struct Bytes {
  std::vector<std::uint32_t> words;
  std::size_t size = 0;
  pliant::Span<const std::uint8_t> span() const {
    return {reinterpret_cast<const std::uint8_t*>(words.data()), size};
  }
};

/// A bright disc with two dark dots and a dark bar, in a square of a side around (x, y).
inline void draw(texture::Picture* picture, double x, double y, double side) {
  const auto inside = [](double dx, double dy, double rx, double ry) {
    return dx * dx / (rx * rx) + dy * dy / (ry * ry) < 1;
  };
  const auto grey = [&](double u, double v) {  // in -0.5 .. 0.5
    if (inside(u + 0.18, v + 0.12, 0.09, 0.06) || inside(u - 0.18, v + 0.12, 0.09, 0.06) ||
        inside(u, v - 0.24, 0.16, 0.05))
      return 40;
    return inside(u, v, 0.42, 0.46) ? 210 : -1;
  };
  const int reach = static_cast<int>(0.5 * side) + 1;
  for (int j = static_cast<int>(y) - reach; j <= y + reach; ++j)
    for (int i = static_cast<int>(x) - reach; i <= x + reach; ++i) {
      if (i < 0 || j < 0 || i >= picture->width || j >= picture->height) continue;
      double sum = 0;
      for (int k = 0; k < 16; ++k) {
        const int g = grey((i + (k % 4) / 4.0 - 0.375 - x) / side, (j + (k / 4) / 4.0 - 0.375 - y) / side);
        sum += g < 0 ? picture->at(i, j) : g;
      }
      picture->at(i, j) = static_cast<std::uint8_t>(sum / 16);
    }
}

/// The cells of the drawing in the middle of a grey picture.
inline std::vector<std::uint8_t> window() {
  using namespace pliant;
  constexpr int kCells = kWindowCells + 2, kSide = kCells * kDetectorCellPx + 2;
  texture::Picture p(kSide, kSide, 120);
  draw(&p, 0.5 * (kSide - 1), 0.5 * (kSide - 1), kWindowPx);
  std::vector<std::uint8_t> cells(kCells * kCells * kCellChannels);
  alignas(16) unsigned char room[sizeof(CellSums) * kCells * kCells + 16];
  Arena arena(room, sizeof room);
  GradientCells gradient;
  gradient.lay_out(arena, kCells * kCells);
  gradient.compute(p.view(), kCells, kCells, kDetectorCellPx, kDetectorReach, cells.data());
  return cells;
}

/// Writes length and checksum of a table.
inline void seal(Bytes* bytes) {
  using namespace pliant;
  auto* const header = reinterpret_cast<DetectorHeader*>(bytes->words.data());
  header->total_bytes = static_cast<std::uint32_t>(bytes->size);
  const auto from = offsetof(DetectorHeader, tree_count);
  header->crc32 = crc32(bytes->span().data + from, bytes->size - from);
}

/// A table whose trees each ask whether one of the drawing's strongest directions is there.
inline Bytes table(std::size_t tree_count = 60) {
  using namespace pliant;
  struct Feature {
    int value;
    std::uint16_t feature;
  };
  const std::vector<std::uint8_t> cells = window();
  std::vector<Feature> features;
  for (int row = 0; row < kWindowCells; ++row)
    for (int column = 0; column < kWindowCells; ++column)
      for (int channel = 0; channel < 8; ++channel) {
        const int at = ((row + 1) * (kWindowCells + 2) + column + 1) * kCellChannels + channel;
        features.push_back({cells[static_cast<std::size_t>(at)], detector_feature(row, column, channel)});
      }
  std::stable_sort(features.begin(), features.end(), [](Feature a, Feature b) { return a.value > b.value; });
  Bytes bytes;
  bytes.size = sizeof(DetectorHeader) + tree_count * sizeof(DetectorTree);
  bytes.words.resize(bytes.size / 4 + 1);
  auto* const header = reinterpret_cast<DetectorHeader*>(bytes.words.data());
  header->magic = kDetectorMagic;
  header->tree_count = static_cast<std::uint16_t>(tree_count);
  header->tree_depth = kTreeDepth;
  const int all = 8 * static_cast<int>(tree_count), least = all / 8;
  for (int k = 0; k < kScoreKnots; ++k) {
    header->knot_sum[k] = static_cast<std::int16_t>(least + k * (all - least) / (kScoreKnots - 1));
    header->knot_probability[k] = static_cast<std::uint16_t>(60000 + 700 * k);
  }
  for (std::size_t t = 0; t < tree_count; ++t) {
    DetectorTree tree{};
    for (int node = 0; node < kTreeNodes; ++node) {
      tree.feature[node] = features[t].feature;
      tree.threshold[node] = static_cast<std::uint8_t>(features[t].value / 4);
    }
    for (int leaf = 0; leaf < kTreeLeaves; ++leaf) tree.leaf[leaf] = leaf == kTreeLeaves - 1 ? 8 : -8;
    tree.rejection = static_cast<std::int16_t>(t + 1 == tree_count ? least : -60);
    std::memcpy(reinterpret_cast<char*>(bytes.words.data()) + sizeof(DetectorHeader) + t * sizeof tree, &tree,
                sizeof tree);
  }
  seal(&bytes);
  return bytes;
}

}  // namespace detector_pattern
