#pragma once
// The landmarks of a face model as an aligner moves them: projection, upright crop, and one regularised
// Gauss-Newton step of pose and parameters towards displaced landmarks (docs/algorithms.md, sections 4.3 and
// 5.2).
#include <cstdint>

#include "face/face_picture.hpp"
#include "optim/point_row.hpp"
#include "pliant/camera.hpp"
#include "pliant/cascade.hpp"
#include "pliant/lens.hpp"

namespace pliant {

/// Tuning of the steps of alignment. Each constant: unit, reason, experiment.
struct FaceShapeTuning {
  /// Largest step of an iteration: turn, rad, and log of scale. The projection is far from linear beyond. Round values.
  float max_turn_rad = 0.5f, max_log_step = 0.4f;
  /// Damping of the step, a fraction of the diagonal. Not tuned.
  float damping = 1e-3f;
  /// Centre of the head, mm: a landmark faces the camera where the direction from here does. From anatomy.
  Vec3 head_centre{0, -35, -75};
  /// Cosine of that direction with the view below which a landmark is hidden, and above which it is seen in
  /// full. Not tuned.
  float hidden_cosine = 0.15f, seen_cosine = 0.45f;
  /// Weight of a hidden landmark. Not tuned.
  float hidden_weight = 0.1f;
};
inline constexpr FaceShapeTuning kFaceShapeTuning{};

/// What an aligner is laid out for. A spread alignment takes what only one frame needs from scratch memory. That of a known person
/// has equations for expressions alone, and room for the samples of one landmark.
enum class AlignerUse : std::uint8_t { alignment, spread_alignment, known_person };

/// Pose and parameters of one face. A step: `begin`, then `evaluate` and `add` for each landmark, then
/// `finish`.
class FaceShape {
 public:
  /// \param landmarks  at most that many, up to 96.
  void lay_out(Arena& arena, const Model& model, std::size_t landmarks,
               AlignerUse use = AlignerUse::alignment);
  /// The samples of the fields at each landmark, which `evaluate` takes once. They are forgotten if they are laid out again, and at
  /// `start`.
  void lay_out_samples(Arena& arena);

  /// The landmarks by their (u,v). \param corners  outer eye corners and mouth corners.
  void set_landmark(std::size_t k, Vec2 uv) { uv_[k] = uv; }
  void set_landmark_count(std::size_t count) { count_ = count; }
  void set_corners(const Vec2 (&corners)[4]);
  std::size_t landmark_count() const { return count_; }

  /// \param q  all parameters, finite; they are clamped to their limits. \param is_free  as AlignOptions.
  void start(const View& view, const float* q, const std::uint8_t* is_free, const Lens& lens);

  /// Whether there is room for the equations of all that is free.
  bool has_room() const { return kPoseUnknowns + cascade_.column_count() <= equations_.capacity(); }

  /// The upright crop at the present pose, around the middle of the corners.
  CropMap crop_map(float mm_per_px, int side);

  /// Starts the equations of a step at the present pose and parameters.
  void begin();
  /// A landmark.
  struct Seen {
    Vec2 x;            ///< px of the frame
    float weight = 0;  ///< in [0, 1]: less where it is turned away; 0: not before the camera
  };
  /// With the derivatives that `add` needs.
  Seen evaluate(std::size_t k);
  /// Without; after `select`.
  Seen locate(std::size_t k);
  /// Prepares `locate` at the present parameters.
  void select() { cascade_.select(q_); }
  /// Adds the landmark of the last `evaluate`.
  /// \param target  px of the frame. \param information  1/px^2.
  void add(Vec2 target, const Sym2& information);
  /// Moves pose and free parameters by one Gauss-Newton step. \param prior  weight of the parameters' prior.
  void finish(float prior);

  /// Moves the face in the image. \param by  px of the frame, finite.
  void move(Vec2 by) { view_.tau = view_.tau + (1.0f / view_.s) * by; }

  /// Image position of any point of the surface. \return false if it is not before the camera.
  bool project(Vec2 uv, Vec2* x);

  const View& view() const { return view_; }
  const float* q() const { return q_; }
  float mean_square_parameter() const;  ///< mean of (q / sd)^2
  bool is_usable() const;               ///< pose, scale and parameters are finite and within bounds
  Cascade& cascade() { return cascade_; }

 private:
  void add_priors(float prior);
  Vec3* samples_of(std::size_t k) {
    return samples_ + (keeps_samples_ ? k * cascade_.model().cascade().count : 0);
  }
  void forget_samples() {
    for (std::uint32_t& word : sampled_) word = 0;
  }
  bool is_sampled(std::size_t k) const { return (sampled_[k / 32] >> (k % 32) & 1) != 0; }
  static float weight_of(const Projector& projector, Vec3 p);

  Cascade cascade_;
  NormalEquations equations_;
  View view_;
  Lens lens_;
  float *q_ = nullptr, *step_ = nullptr;
  static constexpr std::size_t kMostLandmarks = 96;
  bool keeps_samples_ = true;  // of each landmark, else there is room for those of one
  Vec3* samples_ = nullptr;
  std::uint32_t sampled_[kMostLandmarks / 32] = {};  // a bit each: whether they are there
  PointRow row_;
  Vec2* uv_ = nullptr;
  std::size_t count_ = 0;
  Vec2 corners_[4];
  // The landmark of the last `evaluate`.
  Jacobian jacobian_;
  Projector::Derivatives derivatives_;
  Vec2 ideal_;  // px, without lens
  float weight_ = 0;
};

}  // namespace pliant
