#pragma once
// Rendered pictures of the built-in face, whose pose, expression and landmarks are known.
#include <doctest/doctest.h>

#include <functional>
#include <string>
#include <vector>

#include "baked_face.hpp"
#include "pliant/tracker.hpp"
#include "renderer.hpp"

struct FaceFilm {
  /// Changes the pose at rest and the parameters for s from 0 to 1.
  using Motion = std::function<void(float s, pliant::Pose& pose, std::vector<float>& q)>;

  int width, height;
  pliant::Camera camera;
  std::vector<std::vector<std::uint8_t>> frames;
  std::vector<pliant::Pose> poses;
  std::vector<std::vector<float>> parameters;

  /// \param fraction        of the picture's height that the face fills.
  /// \param flat_step_grey  of Renderer::flatten_half.
  /// \param cells           of Renderer.
  /// \param seed            of the noise.
  FaceFilm(int w, int h, std::size_t count, const Motion& motion, float fraction = 0.7f,
           float flat_step_grey = 0, int cells = 160, std::uint32_t seed = 0);

  FaceFilm(const FaceFilm&);
  ~FaceFilm();

  static void set(std::vector<float>& q, const char* name, float value);
  std::size_t count() const { return frames.size(); }
  pliant::FrameView view(std::size_t k) const;
  /// Starts a tracker at frame k, with its pose and parameters. Inline: the library of this film links no tracker.
  pliant::Status start_at_truth(pliant::Tracker& tracker, std::size_t k = 0,
                                const pliant::TrackerOptions& options = {},
                                pliant::Span<const pliant::Vec2> markers = {}) const {
    return tracker.start_from_pose(view(k), camera, poses[k], parameters[k].data(), options, markers);
  }
  /// The same with the pose alone: the parameters are unknown.
  pliant::Status start_at_pose(pliant::Tracker& tracker, std::size_t k = 0,
                               const pliant::TrackerOptions& options = {}) const {
    return tracker.start_from_pose(view(k), camera, poses[k], nullptr, options);
  }
  /// Image position of a landmark in frame k.
  pliant::Vec2 truth(const std::string& landmark, std::size_t k) const;
  /// Angle between a pose and that of frame k, in degrees.
  float turn_error(const pliant::Pose& pose, std::size_t k) const;
  /// Mean distance of the 51 inner landmarks from the truth of frame k, in pixels.
  template <class Tracker>
  float landmark_error(Tracker& tracker, std::size_t k) const {
    float sum = 0;
    for (int l = 17; l < 68; ++l) {
      const std::string name = "ibug" + std::to_string(l);
      pliant::Vec2 x;
      REQUIRE(tracker.estimator().project(baked_face().uv(name), &x));
      sum += pliant::length(x - truth(name, k));
    }
    return sum / 51;
  }
};
