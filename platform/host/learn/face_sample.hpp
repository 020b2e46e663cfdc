#pragma once
/// \file face_sample.hpp
/// A training picture of a face with its truth.
#include <cstdint>
#include <vector>

#include "host/io/image.hpp"
#include "host/learn/photographs.hpp"
#include "pliant/face_box.hpp"

namespace pliant::host::learn {

/// A picture with one face and everything about it.
struct FaceSample {
  Image picture;                    ///< grey
  std::vector<Vec2> landmarks;      ///< px, one for each landmark of the model
  std::vector<std::uint8_t> trust;  ///< LandmarkTrust of each
  Pupils pupils;
  Camera camera;
  Pose pose;
  std::vector<float> q;  ///< all parameters
  FaceBox box;
  int person = 0;  ///< the same number for the same person
};

}  // namespace pliant::host::learn
