#pragma once
/// \file overlay.hpp
/// What is drawn over a picture so that a person sees how a model lies on it.
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "host/render/draw.hpp"
#include "host/io/fit_file.hpp"
#include "pliant/estimator.hpp"

namespace pliant::host {

/// Triangles over a picture: projected vertices (px), and the corners of the faces that turn to the camera.
struct WireMesh {
  std::vector<Vec2> x;
  std::vector<std::array<std::uint16_t, 3>> faces;
};

/// The base mesh of a model at the state of a fit, and the tracker's mesh at its present state.
WireMesh wire_of(const Model& model, const FitFile& fit, const std::vector<float>& q);
WireMesh wire_of(const Estimator& estimator);

/// Projected landmarks, in the model's order; nothing for one behind the camera.
std::vector<std::optional<Vec2>> project_landmarks(const Model& model, Cascade& cascade, const Pose& pose,
                                                   const Camera& camera, const ImageSize& size,
                                                   const float* q);

/// A grey picture in colour and large enough to draw on: doubled when it is less than 480 pixels wide.
class Overlay {
 public:
  explicit Overlay(const Image& grey);

  /// Its edges, each once.
  void draw_mesh(const WireMesh& mesh);
  void draw_landmark(Vec2 x);
  void draw_marker(Vec2 x);
  /// A given point, and a line to where the model has it.
  void draw_residual(Vec2 given, Vec2 residual, bool used);
  /// A line of text in the lower left corner.
  void draw_caption(const std::string& text);
  /// A border that tells the state: green, amber or red.
  void draw_state(TrackState state);

  const Image& image() const { return image_; }

 private:
  Vec2 scaled(Vec2 x) const;
  /// Width of a thin line: a pixel in a picture of 640.
  float unit() const { return static_cast<float>(image_.width) / 640; }
  int scale_;
  Image image_;
};

}  // namespace pliant::host
