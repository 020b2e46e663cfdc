#pragma once
/// \file view_rays.hpp
/// The view rays from a photograph's camera to the surface of a fitted model.
#include <vector>

#include "host/io/fit_file.hpp"
#include "host/io/image.hpp"
#include "host/render/raster.hpp"
#include "host/render/surface_sheet.hpp"
#include "pliant/lens.hpp"

namespace pliant::host {

/// The ray to one point of the surface.
struct ViewRay {
  Vec2 x;            ///< in the photograph, px
  float weight = 0;  ///< 0: not visible; 1: visible at a good angle
  float facing = 0;  ///< cosine of the angle between the normal and the ray
};

/// The surface as a grid over the chart, with the ray to each point of the grid.
class ViewRays {
 public:
  /// \param fit  the view, in a photograph of width x height pixels. \param q  all parameters of the model in it.
  ViewRays(const Model& model, const FitFile& fit, const std::vector<float>& q, int width, int height);

  /// Removes background where the model is wider than the person: points at a slant angle whose colour differs from that of
  /// the frontal points, if they are connected to the boundary. Hair over the forehead stays.
  void reject_background(const Image& photo);

  /// The ray to (u,v), interpolated; of weight 0 if a neighbouring point of the grid is not visible.
  ViewRay at(Vec2 uv) const;

 private:
  std::vector<std::uint8_t> reached_from_border(const std::vector<std::uint8_t>& passable) const;
  void fade_around(const std::vector<std::uint8_t>& removed);
  void draw_depth();
  ViewRay ray_of(std::size_t k, int width, int height) const;
  Vec2 to_depth(Vec2 x) const { return scale_ * x; }

  ChartTexture texture_;
  SurfaceSheet sheet_;
  Projector projector_;
  Lens lens_;
  float scale_;    // from the photograph to the depth image
  Raster raster_;  // depth image
  std::vector<ViewRay> rays_;
};

/// Bilinear colour of a photograph at a position inside it.
Vec3 photo_colour(const Image& photo, Vec2 x);

}  // namespace pliant::host
