#pragma once
// Rendered pictures of the built-in face, whose pose, expression and landmarks are known.
#include <functional>
#include <string>
#include <vector>

#include "baked_face.hpp"
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
           float flat_step_grey = 0, int cells = 160, std::uint32_t seed = 0)
      : width(w), height(h), camera(pliant::centred_camera(w, h, 1.25f * static_cast<float>(w))) {
    using namespace pliant;
    BakedModel& face = baked_face();
    Renderer renderer(face.cascade, cells);
    renderer.flatten_half(flat_step_grey);
    const Picture backdrop = make_backdrop(w, h, 5);
    const Pose rest = frontal_pose(face.cascade, face.rest().data(), camera, h, fraction);
    for (std::size_t k = 0; k < count; ++k) {
      Pose pose = rest;
      std::vector<float> q = face.rest();
      motion(count > 1 ? static_cast<float>(k) / static_cast<float>(count - 1) : 0.0f, pose, q);
      Picture picture = renderer.draw(q.data(), pose, camera, backdrop);
      add_noise(picture, 2, 1000 * seed + static_cast<std::uint32_t>(k));
      frames.push_back(picture.pixels);
      poses.push_back(pose);
      parameters.push_back(q);
    }
  }

  static void set(std::vector<float>& q, const char* name, float value) {
    q[baked_face().model.find_parameter(name)] = value;
  }
  std::size_t count() const { return frames.size(); }
  pliant::FrameView view(std::size_t k) const { return view_of_pixels(frames[k], width, height, k); }
  /// Image position of a landmark in frame k.
  pliant::Vec2 truth(const std::string& landmark, std::size_t k) const {
    pliant::Vec2 x;
    REQUIRE(pliant::Projector(pliant::view_of(poses[k], camera), true)
                .project(baked_face().at(landmark, parameters[k]), &x));
    return x;
  }
  /// Angle between a pose and that of frame k, in degrees.
  float turn_error(const pliant::Pose& pose, std::size_t k) const {
    return 57.29578f *
           pliant::length(pliant::log_rotation(pose.q * pliant::conjugate(pliant::normalised(poses[k].q))));
  }
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
