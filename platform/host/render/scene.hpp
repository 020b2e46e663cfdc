#pragma once
/// \file scene.hpp
/// A lit picture of a model: surface, camera, pose, background and sensor noise.
#include <cstdint>

#include "host/io/image.hpp"
#include "host/render/raster.hpp"
#include "host/render/surface_sheet.hpp"
#include "pliant/camera.hpp"

namespace pliant::host {

/// Draws one model into pictures of one size.
class Scene {
 public:
  /// \param cells    of the surface's grid along each side of the chart.
  /// \param samples  a pixel and side.
  Scene(const Model& model, int width, int height, int cells = 224, int samples = 2);

  /// A grey picture of the model with the parameters q, over `background` (grey, of the same size). The light
  /// stands still beside the camera: a soft key from the upper left, a weak fill from the right.
  /// \param tone  brightness of the surface.
  Image draw(const float* q, const Pose& pose, const Camera& camera, const Image& background, float tone = 1);

  /// Takes the texture from the half of the chart with u below 0.5: its albedo comes in steps of so many grey levels,
  /// so that only the outlines of what is darker or lighter are left. 0: none of it.
  void flatten_half(float step_grey) { flat_step_ = step_grey; }
  /// Sprays blotches of a few millimetres on the skin, as an actor's for motion capture: there are corners everywhere.
  /// \param share  of the albedo that they add or take away, 0 to 1.
  void speckle(float share) { speckle_ = share; }

 private:
  float albedo(Vec2 uv) const;

  float flat_step_ = 0, speckle_ = 0;
  Model model_;
  ChartTexture texture_;
  SurfaceSheet sheet_;
  Raster raster_;
  std::vector<RasterVertex> corners_;
};

/// A soft, blotchy backdrop, different for each seed: texture behind the face that must not mislead a
/// tracker.
Image make_background(int width, int height, std::uint32_t seed);

/// Adds normally distributed noise of `sd` grey levels; equal seeds give equal noise.
void add_noise(Image& image, float sd, std::uint32_t seed);

/// The frontal pose that puts the model into the middle of the picture, filling `share` of its height.
Pose frontal_pose(const Model& model, const float* q, const Camera& camera, int height, float share);

}  // namespace pliant::host
