#pragma once
/// \file view_rays.hpp
/// Where a photograph shows each part of a fitted model's surface.
#include <vector>

#include "host/io/fit_file.hpp"
#include "host/io/image.hpp"
#include "host/render/raster.hpp"
#include "host/render/surface_sheet.hpp"
#include "pliant/lens.hpp"

namespace pliant::host {

struct Sight {
  Vec2 x;            ///< in the photograph, px
  float weight = 0;  ///< 0: not seen; 1: seen well
  float facing = 0;  ///< cosine of normal and line of sight
};

/// The surface as a grid over the chart, and where each of its points is seen.
class Sights {
 public:
  /// \param fit  the view, in a photograph of width x height pixels. \param q  all parameters of the model in it.
  Sights(const Model& model, const FitFile& fit, const std::vector<float>& q, int width, int height);

  /// Gives up what turns aside, has another colour than the rest of the face, and is joined to the outline: background,
  /// where the model is wider than the person. Hair over the forehead stays.
  void reject_background(const Image& photo);

  /// Interpolated at (u,v).
  Sight at(Vec2 uv) const;

 private:
  std::vector<std::uint8_t> reached_from_rim(const std::vector<std::uint8_t>& passable) const;
  void fade_around(const std::vector<std::uint8_t>& given_up);
  void draw_depth();
  Sight sight_of(std::size_t k, int width, int height) const;
  Vec2 to_depth(Vec2 x) const { return scale_ * x; }

  ChartTexture texture_;
  SurfaceSheet sheet_;
  Projector projector_;
  Lens lens_;
  float scale_;    // from the photograph to the picture of depths
  Raster raster_;  // of depths
  std::vector<Sight> sights_;
};

/// Colour of a photograph at a position within it, bilinear.
Vec3 photo_colour(const Image& photo, Vec2 x);

}  // namespace pliant::host
