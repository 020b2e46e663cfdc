#pragma once
/// \file face_samples.hpp
/// Pictures of faces with their truth, for training: photographs varied at random, reproducibly.
#include <cstdint>
#include <memory>
#include <vector>

#include "host/learn/drawn_portraits.hpp"
#include "host/learn/expression_variation.hpp"
#include "host/learn/face_sample.hpp"
#include "host/learn/occluders.hpp"
#include "host/learn/other_pictures.hpp"
#include "host/learn/picture_variation.hpp"
#include "host/learn/sample_view.hpp"

namespace pliant::host::learn {

class TextureRaster;
struct PhotoTurn;

/// Persons are mixed only with those whose number has the same remainder, so that persons with different remainders by a
/// divisor of it stay apart.
constexpr int kPersonClasses = 12;

/// Which samples are drawn, and how varied they are. Angles in degrees. Fractions and `mixed_chance`: docs/experiments.md, Samples.
struct FaceSampleTuning {
  int side_px = 160;                         ///< width and height of a sample
  float box_low_px = 48, box_high_px = 110;  ///< side of the face box
  float margin_px = 6;                       ///< of the face box to the border, at least
  float roll_degrees = 30;                   ///< turn in the picture, at most
  /// Of the samples: of drawn portraits; the others are of photographs. Alignment has a fraction of its own. A few keep hats and
  /// odd skins in.
  float drawn_fraction = 0.04f;
  std::size_t drawn_people = 40;
  DrawnTurn drawn_turn;
  /// Drawn people where there is no photograph: as many as photographs and their mirror images in the usual training.
  std::size_t drawn_people_alone = 350;
  /// Photographs turned in depth; the others are varied in the plane only.
  float turned_fraction = 0.7f;
  float yaw_degrees = 55, pitch_degrees = 28;  ///< of turned ones, at most
  float tilt_degrees = 8;                      ///< of the head against the body, at most
  float most_turned_degrees = 45;              ///< from the photograph's own pose
  float near_mm = 300, far_mm = 2500;          ///< range of the distance to the camera
  /// Of turned ones: with the skin and shape of a second person.
  float mixed_chance = 0.4f;
  float hidden_mm = 7;        ///< a landmark is hidden if something is nearer to the camera by this
  float relit_chance = 0.4f;  ///< of turned ones: with another light
  float smear_chance =
      0.4f;  ///< a photograph that does not fill the sample is continued by its border, else by another picture
  /// Of turned ones: with the irises moved, by up to so much to the side and up or down, mm.
  float gaze_chance = 0, gaze_x_mm = 6, gaze_y_mm = 3;
  ExpressionVariationTuning expressions;
  OccluderTuning occluders;
  PictureVariationTuning variation;
};

/// Draws samples. The sample of an index depends on the seed and the index alone.
class FaceSamples {
 public:
  /// \param model        outlives this object; needs iBUG landmarks.
  /// \param photographs  may be empty: then all samples are of drawn portraits; outlive this object, as do `others`, which may be
  ///                     empty.
  FaceSamples(const Model& model, const std::vector<Photograph>& photographs, const OtherPictures& others,
              std::uint64_t seed, const FaceSampleTuning& tuning = {});
  ~FaceSamples();
  FaceSamples(const FaceSamples&) = delete;
  FaceSamples& operator=(const FaceSamples&) = delete;

  /// Several threads may draw at once. Cost: some 5 ms.
  FaceSample draw(std::uint64_t index) const;

  const FaceSampleTuning& tuning() const { return tuning_; }

 private:
  struct Workspace;
  struct Parts;
  FaceSample draw_in_plane(SampleRandom& random) const;
  FaceSample draw_turned(SampleRandom& random, Workspace& workspace) const;
  const Photograph& photograph(std::size_t k) const {
    return k < photographs_.size() ? photographs_[k] : drawn_[k - photographs_.size()];
  }
  /// Number of a photograph or drawn portrait.
  std::size_t random_photograph(SampleRandom& random) const;
  std::size_t random_second(std::size_t k, SampleRandom& random) const;
  float random_yaw(SampleRandom& random) const;
  FacePlacement random_placement(SampleRandom& random) const;
  void mix_people(std::size_t second, SampleRandom& random, PhotoTurn& turn) const;
  void turn_head(const Photograph& photograph, const std::vector<Vec3>& points, SampleRandom& random,
                 PhotoTurn& turn) const;
  void hide_pupils(FaceSample& sample) const;
  void set_truth(const std::vector<Vec3>& points, const TextureRaster& raster, FaceSample& sample) const;
  Image surroundings(SampleRandom& random) const;

  FaceSampleTuning tuning_;
  std::uint64_t seed_;
  Model model_;
  const std::vector<Photograph>& photographs_;
  std::vector<Photograph> drawn_;
  const OtherPictures& others_;
  std::vector<Mipmap> mipmaps_;  // of photographs, then of drawn portraits
  std::unique_ptr<Parts> parts_;
};

}  // namespace pliant::host::learn
