#pragma once
/// \file experiment.hpp
/// What one validation run sees: pictures, a start in the first of them, and where its markers really are.
#include <optional>
#include <string>
#include <vector>

#include "host/io/image.hpp"
#include "pliant/camera.hpp"
#include "pliant/model.hpp"

namespace pliant::figure9 {

struct Experiment {
  std::string name;
  double frames_per_second = 15;
  std::vector<host::Image> frames;
  Camera camera;
  Pose pose;             ///< in frame 0
  std::vector<float> q;  ///< all parameters, in frame 0
  /// Frame, marker: where it is; nothing where it is not seen. Frame 0 has them all.
  std::vector<std::vector<std::optional<Vec2>>> truth;
  std::vector<std::uint8_t> is_hidden;  ///< a flag a frame: something passes before the face
};

/// A person who turns the head, talks, smiles and blinks, rendered at 60 Hz with every fourth frame used: 320 x 240
/// pixels, noise, motion blur, light that changes, and a foreign texture that passes before the face. Started by a fit
/// to 68 landmarks of frame 0 with 0.5 px noise, identity and focal length unknown.
Experiment make_rendered(const Model& model, const std::string& model_path, int frames);

/// A recorded sequence.
struct Recording {
  std::string video;    ///< Y4M
  std::string init;     ///< points CSV of frame 0 for the fit
  std::string markers;  ///< points CSV of frame 0
  std::string truth;    ///< frame,landmark,x,y; the markers' names
  int every = 1;        ///< frame used
  int frames = 0;       ///< at most; 0: all
};
Experiment read_recorded(const Model& model, const std::string& model_path, const Recording& recording);

}  // namespace pliant::figure9
