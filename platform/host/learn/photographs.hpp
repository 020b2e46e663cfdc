#pragma once
/// \file photographs.hpp
/// Photographs of faces with annotated landmarks, and the model fitted to each.
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "host/io/image.hpp"
#include "pliant/camera.hpp"
#include "pliant/model.hpp"

namespace pliant::host::learn {

/// How much the position of a landmark can be trusted.
enum LandmarkTrust : std::uint8_t {
  kTrustNone = 0,       ///< hidden; the position is where the landmark is behind what hides it
  kTrustFitted = 1,     ///< from the fitted model
  kTrustAnnotated = 2,  ///< annotated, or exact
};

/// Where the middles of the pupils are seen: right, left; px.
struct Pupils {
  Vec2 x[2];
  std::uint8_t trust[2] = {kTrustNone, kTrustNone};  ///< LandmarkTrust of each
};

/// A photograph with one face. The view is that of the fitted model.
struct Photograph {
  std::string name;
  int person = 0;                   ///< the same for a photograph and its mirror image
  Image picture;                    ///< grey
  std::vector<Vec2> landmarks;      ///< px, one for each landmark of the model
  std::vector<std::uint8_t> trust;  ///< LandmarkTrust of each
  Camera camera;                    ///< of the fit; the focal length is assumed
  Pose pose;                        ///< of the fit
  std::vector<float> q;             ///< of the fit, all parameters
  Pupils pupils;
};

/// Which photographs are read.
enum class Portion { training, held_out };

/// Whether a photograph is held out of training: FNV-1a (32 bits) of its name without extension is a multiple of 3.
bool is_held_out(std::string_view name);

/// Reads those of read_annotated and fits the model to them. Each photograph is followed by its mirror image, which is fitted
/// anew. A photograph to which the model cannot be fitted is left out.
std::vector<Photograph> read_photographs(const Model& model, const std::string& folder, Portion portion,
                                         int threads = 2);

/// Names of FOLDER/landmarks.csv that are neither landmarks of the model nor pupils, in the order of the file. Training ignores
/// their points.
std::vector<std::string> unknown_landmarks(const Model& model, const std::string& folder);

/// The name of the landmark at the same place in the mirror image: ibug36 for ibug45, mouth_left for mouth_right. The
/// name itself for a landmark in the middle, or of another scheme.
std::string mirrored_landmark(const std::string& name);

/// An annotated landmark.
struct AnnotatedLandmark {
  std::string name;
  Vec2 x;  ///< px
};
/// A grey picture with its annotated landmarks; names that the model does not have are ignored.
struct AnnotatedPicture {
  std::string name;
  Image picture;
  std::vector<AnnotatedLandmark> landmarks;
};
/// Reads FOLDER/landmarks.csv (columns name, landmark, x, y) and FOLDER/NAME.jpg. Names in the order of the file. Bad input: no
/// such file, or a picture that cannot be read.
std::vector<AnnotatedPicture> read_annotated(const std::string& folder, Portion portion);
/// The mirror image, left and right landmarks exchanged.
AnnotatedPicture mirror_image(const AnnotatedPicture& annotated);
/// Fits the model. \return false: too few landmarks, or they do not determine the pose.
bool fit_photograph(const Model& model, const AnnotatedPicture& annotated, Photograph* photograph);

}  // namespace pliant::host::learn
