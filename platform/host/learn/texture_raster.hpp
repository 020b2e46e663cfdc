#pragma once
/// \file texture_raster.hpp
/// Draws textured triangles with a depth buffer, several samples a pixel, and tells what each sample shows.
#include <cstdint>
#include <vector>

#include "host/learn/face_sheet.hpp"

namespace pliant::host::learn {

/// A vertex in the picture with the values that are interpolated.
struct TextureVertex {
  Vec2 x;                   ///< px, pixel centres at integers
  float inverse_depth = 0;  ///< 1/mm; 0: behind the camera
  Vec2 texture;             ///< px of the photograph, moving with the surface
  Vec2 fixed;               ///< px of the photograph, moving with the skull
  float light = 1;          ///< factor on the brightness
  float cover = 1;          ///< 0: the background shows instead
  Vec2 second;              ///< px of a second photograph
  float second_weight = 0;  ///< of it
};

/// The same values at a sample.
struct TextureFragment {
  Vec2 texture, fixed, second;
  float light, cover, second_weight;
  FacePart part;
};

class TextureRaster {
 public:
  /// \param samples  along each side of a pixel.
  TextureRaster(int width, int height, int samples);

  /// Removes what was drawn.
  void clear();
  void draw(const std::vector<TextureVertex>& vertices, const std::vector<FaceTriangle>& triangles);

  int columns() const { return columns_; }
  int rows() const { return rows_; }
  int samples() const { return samples_; }
  /// Depth at a position of the picture, mm; 0 outside or where nothing was drawn.
  float depth(Vec2 x) const;
  /// What the sample shows. \return false: nothing was drawn.
  bool fragment(int column, int row, TextureFragment* out) const;

 private:
  struct Sample {
    float inverse_depth;
    std::uint32_t triangle;
    float b, c;  // perspective weights of the second and third corner
  };
  struct Corners {
    TextureVertex v[3];
    FacePart part;
  };
  void draw(const Corners& corners);

  int samples_, columns_, rows_;
  std::vector<Sample> buffer_;
  std::vector<Corners> drawn_;
};

}  // namespace pliant::host::learn
