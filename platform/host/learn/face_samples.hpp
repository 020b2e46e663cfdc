#pragma once
/// \file face_samples.hpp
/// Pictures of faces with their truth, for training: photographs varied at random, reproducibly.
#include <cstdint>
#include <memory>
#include <vector>

#include "host/learn/other_pictures.hpp"
#include "host/learn/photographs.hpp"
#include "host/learn/picture_variation.hpp"
#include "pliant/face_box.hpp"

namespace pliant::host::learn {

/// A picture with one face and everything about it.
struct FaceSample {
  Image picture;                    ///< grey
  std::vector<Vec2> landmarks;      ///< px, one for each landmark of the model
  std::vector<std::uint8_t> trust;  ///< LandmarkTrust of each
  Camera camera;
  Pose pose;
  std::vector<float> q;  ///< all parameters
  FaceBox box;
  int person = 0;  ///< the same number for the same person
};

/// Which samples are drawn, and how varied they are. Angles in degrees.
struct FaceSampleTuning {
  int side_px = 160;                         ///< width and height of a sample
  float box_low_px = 48, box_high_px = 110;  ///< side of the face box
  float margin_px = 6;                       ///< of the face box to the border, at least
  float roll_degrees = 30;                   ///< turn in the picture, at most
  float smear_chance =
      0.4f;  ///< a photograph that does not fill the sample is continued by its border, else by another picture
  PictureVariationTuning variation;
};

/// Draws samples. The sample of an index depends on the seed and the index alone.
class FaceSamples {
 public:
  /// \param model        outlives this object; needs iBUG landmarks.
  /// \param photographs  at least one; outlive this object, as do `others`, which may be empty.
  FaceSamples(const Model& model, const std::vector<Photograph>& photographs, const OtherPictures& others,
              std::uint64_t seed, const FaceSampleTuning& tuning = {});
  ~FaceSamples();
  FaceSamples(const FaceSamples&) = delete;
  FaceSamples& operator=(const FaceSamples&) = delete;

  /// Several threads may draw at once. Cost: some 5 ms.
  FaceSample draw(std::uint64_t index) const;

  const FaceSampleTuning& tuning() const { return tuning_; }

 private:
  FaceSample draw_in_plane(SampleRandom& random) const;
  Image surroundings(SampleRandom& random) const;

  FaceSampleTuning tuning_;
  std::uint64_t seed_;
  Model model_;
  const std::vector<Photograph>& photographs_;
  const OtherPictures& others_;
  std::vector<Mipmap> mipmaps_;
};

/// The face box of landmarks in a view. \return a side of 0 if the model lacks one of the four landmarks it needs.
FaceBox face_box_in(const Model& model, const std::vector<Vec2>& landmarks, const Pose& pose,
                    const Camera& camera);

}  // namespace pliant::host::learn
