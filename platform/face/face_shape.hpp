#pragma once
// The landmarks of a face model as an aligner moves them: projection, upright crop, and one regularised Gauss-Newton step of
// pose and parameters towards displaced landmarks (docs/algorithms.md, sections 4.3 and 5.2).
#include <cstdint>

#include "face/face_picture.hpp"
#include "pliant/camera.hpp"
#include "pliant/cascade.hpp"
#include "pliant/lens.hpp"
#include "pliant/normal_equations.hpp"

namespace pliant {

/// Tuning of the steps of alignment. Each constant: unit, reason, experiment.
struct FaceShapeTuning {
  /// A displacement that is this many standard deviations from what the model can follow counts less (Huber). Not tuned.
  float huber_sds = 2;
  /// Largest step of an iteration: turn, rad, and log of scale. The projection is far from linear beyond. Round values.
  float max_turn_rad = 0.5f, max_log_step = 0.4f;
  /// Damping of the step, a fraction of the diagonal. Not tuned.
  float damping = 1e-3f;
  /// Centre of the head, mm: a landmark faces the camera where the direction from here does. From anatomy.
  Vec3 head_centre{0, -35, -75};
  /// Cosine of that direction with the view below which a landmark is hidden, and above which it is seen in full. Not tuned.
  float hidden_cosine = 0.15f, seen_cosine = 0.45f;
  /// Weight of a hidden landmark. Not tuned.
  float hidden_weight = 0.1f;
};
inline constexpr FaceShapeTuning kFaceShapeTuning{};

/// Where a landmark is wanted.
struct LandmarkTarget {
  Vec2 x;            ///< px of the frame
  Sym2 information;  ///< 1/px^2
};

/// Pose and parameters of one face.
class FaceShape {
 public:
  /// \param uv  of the landmarks, at most that many.
  void lay_out(Arena& arena, const Model& model, std::size_t landmarks);

  /// \param is_free  as AlignOptions. \param q  all parameters, finite; they are clamped to their limits.
  void start(const View& view, const float* q, const std::uint8_t* is_free, const Lens& lens);

  void set_landmark(std::size_t k, Vec2 uv) { uv_[k] = uv; }
  std::size_t landmark_count() const { return landmarks_; }
  void set_landmark_count(std::size_t count) { landmarks_ = count; }

  /// Projects all landmarks at the present pose and parameters.
  void project();
  Vec2 image(std::size_t k) const { return image_[k]; }  ///< px of the frame, after `project`
  float weight(std::size_t k) const {
    return weight_[k];
  }  ///< in (0, 1]: less for a landmark that is turned away
  /// Image position of any point of the surface. \return false if it is not before the camera.
  bool project(Vec2 uv, Vec2* x);

  /// The upright crop at the present pose, centred on the landmarks. After `project`.
  CropMap crop_map(float mm_per_px, int side) const;

  /// Steps of pose and free parameters towards the targets, one a landmark.
  /// \param prior  weight of the parameters' prior.
  void step(const LandmarkTarget* targets, float prior, int iterations);

  const View& view() const { return view_; }
  const float* q() const { return q_; }
  /// Mean of (q / sd)^2 over the free parameters.
  float mean_square_parameter() const;
  Cascade& cascade() { return cascade_; }
  bool is_usable() const;  ///< pose and scale are finite and within bounds

 private:
  void add_landmark(std::size_t k, const Projector& projector, const LandmarkTarget& target);
  void add_priors(float prior);
  void move(const float* step);
  Vec3 position(std::size_t k, Jacobian* jacobian);

  Cascade cascade_;
  NormalEquations equations_;
  View view_;
  Lens lens_;
  float* q_ = nullptr;
  float* step_ = nullptr;
  Vec3* samples_ = nullptr;  // of one point
  std::uint16_t* unknown_ = nullptr;
  Vec2* column_ = nullptr;
  std::size_t landmarks_ = 0;
  Vec2 *uv_ = nullptr, *image_ = nullptr;
  float* weight_ = nullptr;
};

}  // namespace pliant
