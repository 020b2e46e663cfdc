#pragma once
/// \file scene.hpp
/// Renders a model: surface, light, camera, pose, background and sensor noise.
#include <cstdint>

#include "host/io/image.hpp"
#include "host/render/raster.hpp"
#include "host/render/surface_sheet.hpp"
#include "pliant/camera.hpp"

namespace pliant::host {

/// Renders one model into pictures of one size.
class Scene {
 public:
  /// \param cells    cells of the surface's grid along each side of the chart.
  /// \param samples  samples along each side of a pixel.
  Scene(const Model& model, int width, int height, int cells = 224, int samples = 2);

  /// Draws the model with the parameters q over `background` (of the same size), in grey, as its albedo is. The picture has the
  /// background's channels. The light is fixed to the camera: a soft key light from the upper left and a weak fill light from
  /// the right.
  /// \param tone  factor on the brightness of the surface.
  Image draw(const float* q, const Pose& pose, const Camera& camera, const Image& background, float tone = 1);

  /// Removes the texture from the half of the chart with u below 0.5: its albedo is rounded to multiples of this many grey
  /// levels, which leaves only edges. 0: the texture stays.
  void flatten_half(float step_grey) { flat_step_ = step_grey; }
  /// Adds blotches of a few millimetres to the surface, like make-up for motion capture, so that there are corners everywhere.
  /// \param fraction  of the albedo that they add or remove, 0 to 1.
  void speckle(float fraction) { speckle_ = fraction; }

 private:
  float albedo(Vec2 uv) const;

  float flat_step_ = 0, speckle_ = 0;
  Model model_;
  ChartTexture texture_;
  SurfaceSheet sheet_;
  Raster raster_;
  std::vector<RasterVertex> corners_;
};

/// A soft, blotchy background, different for each seed.
Image make_background(int width, int height, std::uint32_t seed);

/// Adds normal noise with a standard deviation of `sd` grey levels, the same to all channels of a pixel; equal seeds give equal
/// noise.
void add_noise(Image& image, float sd, std::uint32_t seed);

/// The frontal pose with the model in the middle of the picture, as high as this fraction of it, or as near to that as the range of
/// distances allows.
Pose frontal_pose(const Model& model, const float* q, const Camera& camera, int height, float fraction);

}  // namespace pliant::host
