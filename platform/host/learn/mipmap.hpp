#pragma once
/// \file mipmap.hpp
/// A grey picture at sizes that halve, for sampling without aliasing where it is shrunk.
#include <vector>

#include "host/io/image.hpp"
#include "pliant/geometry.hpp"

namespace pliant::host::learn {

/// The picture, half of it, a quarter, and so on. Outside it is continued by its border.
class Mipmap {
 public:
  Mipmap() = default;
  /// \param picture  grey, at least 1 x 1.
  explicit Mipmap(const Image& picture);

  int width() const { return levels_.front().width; }
  int height() const { return levels_.front().height; }

  /// How to sample where one output pixel steps by `px_per_px` source pixels: the level above, and the weight of the next.
  struct Detail {
    int level = 0;
    float next = 0;  ///< 0 to 1
  };
  Detail detail_for(float px_per_px) const;
  /// Grey value at a position of the full picture, bilinear in one or two levels. Outside: of the nearest position of the
  /// border, from a coarser level the farther away.
  float at(Vec2 x, const Detail& detail) const;

 private:
  float bilinear(Vec2 x, int level) const;
  std::vector<Image> levels_;
};

}  // namespace pliant::host::learn
