#pragma once
// A small software renderer for tests that run on every target: a model's surface with its albedo, lit from beside the
// camera, over a blotchy backdrop, with sensor noise. It needs nothing of the host library but headers.
#include <cstdint>
#include <vector>

#include "host/render/raster.hpp"
#include "moving_surface.hpp"
#include "pliant/camera.hpp"
#include "pliant/cascade.hpp"
#include "pliant/frame.hpp"

/// Grey rows without padding as frame `sequence` of a stream with 30 frames a second.
inline pliant::FrameView view_of_pixels(const std::vector<std::uint8_t>& pixels, int width, int height,
                                        std::size_t sequence) {
  return {pixels.data(),
          width,
          height,
          static_cast<std::size_t>(width),
          1,
          static_cast<std::int64_t>(sequence) * 33'333'333,
          static_cast<std::uint32_t>(sequence)};
}

/// A grey picture, rows without padding.
struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> pixels;

  Picture() = default;
  Picture(int w, int h, std::uint8_t grey = 0)
      : width(w), height(h), pixels(static_cast<std::size_t>(w * h), grey) {}

  std::uint8_t& at(int x, int y) { return pixels[static_cast<std::size_t>(y * width + x)]; }
  std::uint8_t at(int x, int y) const { return pixels[static_cast<std::size_t>(y * width + x)]; }
  pliant::FrameView view(std::size_t sequence = 0) const {
    return view_of_pixels(pixels, width, height, sequence);
  }
};

/// A soft, blotchy backdrop, another for each seed: texture behind the face that must not mislead a tracker.
Picture make_backdrop(int width, int height, std::uint32_t seed);

/// Adds noise of `sd` grey levels; equal seeds give equal noise.
void add_noise(Picture& picture, float sd, std::uint32_t seed);

/// The frontal pose that centres the model in the picture and makes it fill `fraction` of its height.
pliant::Pose frontal_pose(pliant::Cascade& cascade, const float* q, const pliant::Camera& camera, int height,
                          float fraction);

/// Draws one model: a grid of points over the chart, two triangles a cell, perspective-correct, with a depth buffer and
/// 2 x 2 samples a pixel. Holes of the domain mask (eyes, mouth) are drawn, what is beyond its outer border is not.
class Renderer {
 public:
  /// \param cells  of the grid along each side. Below 224, lids and lips lie up to half a pixel off where the model has
  ///               them in a face of 170 px.
  explicit Renderer(pliant::Cascade& cascade, int cells = 160);

  /// Removes the texture from the half of the chart with u < 0.5: its albedo is rounded to steps of `step_grey`, so that
  /// only the borders between dark and bright areas are left. 0 keeps the texture.
  void flatten_half(float step_grey) { flat_step_ = step_grey; }

  /// The model over a backdrop of the picture's size. The light stands still beside the camera.
  /// \param tone  factor on the brightness of the surface.
  Picture draw(const float* q, const pliant::Pose& pose, const pliant::Camera& camera,
               const Picture& backdrop, float tone = 1);

 private:
  struct Corner {
    pliant::Vec3 position;  ///< in the model
    pliant::host::RasterVertex drawn;
    bool is_used = false;
    bool begins_whole_cell = false;  ///< which lies in the surface all over
  };

  std::vector<pliant::Vec2> use_corners();
  bool is_covered_from(pliant::Vec2 uv) const;
  float cover(pliant::Vec2 uv) const;
  float albedo(pliant::Vec2 uv) const;
  Corner& corner(int i, int j) { return corners_[static_cast<std::size_t>(j * (cells_ + 1) + i)]; }
  pliant::Vec3 normal(int i, int j);
  void pose_corners(const float* q, const pliant::Pose& pose, const pliant::Camera& camera, float tone);

  pliant::ChartImage mask_, albedo_;
  int cells_;
  float flat_step_ = 0;
  std::vector<std::uint8_t> cover_;  // of the mask's size: 0 outside, 255 inside
  std::vector<Corner> corners_;
  MovingSurface surface_;  // at the used corners, in their order
  pliant::host::Raster raster_{0, 0, 1};
};
