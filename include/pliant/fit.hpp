#pragma once
/// \file fit.hpp
/// Shape and pose from correspondences between surface points and one image (the paper, section 6, Eq. 8).
#include <cstddef>
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/camera.hpp"
#include "pliant/field.hpp"
#include "pliant/model.hpp"
#include "pliant/solver.hpp"

namespace pliant {

/// One surface point seen in the image.
struct Correspondence {
  Vec2 uv;
  Vec2 x;              ///< px
  float sd_px = 1.0f;  ///< standard deviation of x, > 0
};

struct FitLimits {
  std::uint16_t points = 160;
};

struct FitOptions {
  int width = 0, height = 0;  ///< of the picture; sets the principal point
  float focal_px = 0;         ///< 0: unknown, estimated around `default_focal_ratio` of the larger side
  float default_focal_ratio = 1.4f;
  float focal_log_sd = 0.3f;    ///< prior of log f when unknown
  const View* start = nullptr;  ///< a rough pose; null: found from the points
  const std::uint8_t* is_free =
      nullptr;  ///< flag a parameter; null: all free. The others keep their value in q
  float misfit_mm =
      3.0f;  ///< what neither noise nor prior explains (a landmark annotated elsewhere than the model
             ///< has it): the robust loss lets go only of what is several times further off
  bool robust = true;   ///< Huber, then Tukey on the residual length; false: plain squares
  int iterations = 30;  ///< at most, over all stages
};

struct FitReport {
  View view;             ///< pose and camera
  float rms_px = 0;      ///< over the points used
  std::size_t used = 0;  ///< points with weight at the end (inliers)
  int iterations = 0;
  std::size_t undetermined = 0;
};

/// Fits one model. Lives in an arena; bytes grow with points x cascade records (baked points) and the square of the
/// free unknowns.
class Fitter {
 public:
  void lay_out(Arena& arena, const Model& model, const FitLimits& limits);

  /// Estimates pose, camera and the free parameters from `points`; with no start given the pose is found
  /// from the points themselves. At least four points. `q` (all parameters) is start and result. Null `sd` or `residuals` are allowed.
  /// \param sd         a-posteriori standard deviation a parameter; a frozen one gets 0, an unseen one its prior's.
  /// \param residuals  projected minus observed (px), a point.
  /// \param weights    robust weight in [0,1], a point.
  /// \return bad_argument (NaN, sd <= 0, uv outside [0,1], no size), capacity, too_few_points, underdetermined.
  Status fit(Span<const Correspondence> points, const FitOptions& options, float* q, FitReport* report,
             float* sd, Vec2* residuals, float* weights);

  Cascade& cascade() { return cascade_; }

 private:
  friend struct FitProblem;
  Vec3* baked_at(std::size_t point) { return baked_ + point * cascade_.model().cascade().count; }
  Status conclude(struct FitProblem& problem, float* q, FitReport* report, float* sd, Vec2* residuals,
                  float* weights, int iterations);

  Cascade cascade_;
  NormalEquations equations_;
  FitLimits limits_;
  Vec3 *baked_ = nullptr, *position_ = nullptr;
  float *sorted_ = nullptr, *step_ = nullptr, *trial_q_ = nullptr, *start_q_ = nullptr;
  std::uint16_t* unknown_ = nullptr;
  Vec2* column_ = nullptr;
};

/// A frontal view that puts the model's landmarks (all that the model names ibugNN, else its base mesh) into the box
/// (px): brows to chin, ear to ear. The start for a face detector's box.
Status view_from_box(const Model& model, Cascade& cascade, const float* q, Vec2 corner, Vec2 size,
                     const Camera& camera, View* view);

}  // namespace pliant
