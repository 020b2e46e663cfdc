#pragma once
/// \file overlay.hpp
/// Draws a model's mesh, landmarks and residuals over a picture.
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "host/io/fit_file.hpp"
#include "host/render/draw.hpp"
#include "pliant/estimator.hpp"

namespace pliant::host {

/// Projected vertices (px) and the corners of the faces that face the camera.
struct WireMesh {
  std::vector<Vec2> x;
  std::vector<std::array<std::uint16_t, 3>> faces;
};

/// The base mesh of a model at the state of a fit; the mesh of a tracker's current state.
WireMesh wire_of(const Model& model, const FitFile& fit, const std::vector<float>& q);
/// The mesh of an estimate. The estimate stays as it is: what is drawn must not change what is tracked.
WireMesh wire_of(Estimator& estimator);

/// Image positions of the landmarks in the model's order; nothing for a landmark behind the camera.
std::vector<std::optional<Vec2>> project_landmarks(const Model& model, Cascade& cascade, const Pose& pose,
                                                   const Camera& camera, const ImageSize& size,
                                                   const float* q);

/// A picture to draw on. It is enlarged twice if it is less than 480 pixels wide. Lines and dots on a face whose mesh or box is
/// narrower than about a fifth of the picture are finer, so that the face is still seen below them.
class Overlay {
 public:
  explicit Overlay(const Image& picture);

  /// Draws each edge of the mesh once.
  void draw_mesh(const WireMesh& mesh);
  void draw_landmark(Vec2 x);
  /// Draws an upright square.
  void draw_box(Vec2 centre, float side);
  void draw_marker(Vec2 x);
  /// Draws a ring around a given point and a line to the model's landmark.
  void draw_residual(Vec2 given, Vec2 residual, bool used);
  /// Draws a line of text in the lower left corner.
  void draw_caption(const std::string& text);
  /// Draws a border in the colour of the state: green, amber or red.
  void draw_state(TrackState state);

  const Image& image() const { return image_; }

 private:
  Vec2 scaled(Vec2 x) const;
  /// What is drawn next lies on a face of this side, px of the overlay.
  void set_face(float side);
  /// Width of a thin line: one pixel in a picture 640 pixels wide.
  float unit() const { return static_cast<float>(image_.width) / 640; }
  int scale_;
  Image image_;
  float face_unit_;  // unit() on the face that was drawn last, or less
};

}  // namespace pliant::host
