#pragma once
/// \file fit.hpp
/// Shape and pose from correspondences between surface points and one image (the paper, section 6, Eq. 8).
#include <cstddef>
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/camera.hpp"
#include "pliant/cascade.hpp"
#include "pliant/fold_over.hpp"
#include "pliant/mesh.hpp"
#include "pliant/model.hpp"
#include "pliant/silhouette.hpp"
#include "pliant/solver.hpp"
#include "pliant/visibility.hpp"

namespace pliant {

/// One surface point seen in the image.
struct Correspondence {
  Vec2 uv;
  Vec2 x;              ///< px
  float sd_px = 1.0f;  ///< standard deviation of x, > 0
  /// x lies on the edge of the face in the picture, near where (u,v) was before it turned away: a landmark of the jaw or
  /// cheek as people and detectors annotate it. Needs FitLimits::silhouette.
  bool is_silhouette = false;
};

struct FitLimits {
  std::uint16_t points = 160;
  bool silhouette = false;  ///< room to match outline points: the base mesh and 16 bytes a vertex more, 9 KiB
};

/// How the cost is brought down: damped Gauss-Newton, or the published dynamics (solver.hpp).
enum class FitMethod : std::uint8_t { gauss_newton, euler };

struct FitOptions {
  int width = 0, height = 0;  ///< of the picture; sets the principal point
  float focal_px = 0;         ///< 0: unknown, estimated around `default_focal_ratio` of the larger side
  /// Known intrinsics, with the lens that the points were seen through; null: `focal_px` and the middle of the picture.
  const Camera* camera = nullptr;
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
  /// Weight of the parameters' prior; the stiffness of Eq. 12 is K = -stiffness / sd^2. 0: Eq. 8 alone.
  float stiffness = 1;
  FitMethod method = FitMethod::gauss_newton;
  EulerOptions euler;  ///< of FitMethod::euler, a stage; the start is found by Gauss-Newton all the same
};

struct FitReport {
  View view;             ///< pose and camera
  float rms_px = 0;      ///< over the points used
  std::size_t used = 0;  ///< points with weight at the end (inliers)
  int iterations = 0;
  std::size_t undetermined = 0;
  /// A-posteriori standard deviations of the view in the order of PoseUnknown: turn (rad), log s, shift (mm), log rho; the
  /// last is 0 with a known focal length.
  float pose_sd[kPoseUnknownsWithFocal] = {};
};

/// Fits one model. The result never folds the surface over (folding.hpp): where a stage leads beyond, the parameters go
/// back towards where it began, and the pose follows. Outline points are matched to the model's silhouette
/// (outline.hpp) at the present pose, three times a stage: while the own place of one faces the camera it stays there;
/// once that turns away it becomes the nearest point of the apparent contour within reach on the chart, and only its
/// distance across the contour counts. Lives in an arena; bytes grow with points x cascade records (baked points) and
/// the square of the free unknowns.
class Fitter {
 public:
  void lay_out(Arena& arena, const Model& model, const FitLimits& limits);

  /// Estimates pose, camera and the free parameters from `points`; with no start given the pose is found from the
  /// points themselves. At least four points. `q` (all parameters) is start and result. Null `sd` or `residuals` are
  /// allowed.
  /// \param sd         a-posteriori standard deviation a parameter; a frozen one gets 0, an unseen one its prior's.
  /// \param residuals  projected minus observed (px), a point; of a matched outline point the part across the outline.
  /// \param weights    robust weight in [0,1], a point.
  /// \return bad_argument (NaN, sd <= 0, uv outside [0,1], no size, stiffness < 0, outline
  /// points without room for them), capacity, too_few_points, underdetermined
  /// (all points on one line or spot of the picture, or a pose that they leave open).
  Status fit(Span<const Correspondence> points, const FitOptions& options, float* q, FitReport* report,
             float* sd, Vec2* residuals, float* weights);

  /// Whether the last fit has slid an outline point away from its own place, to the silhouette.
  bool has_slid(std::size_t point) const {
    return silhouette_normal_ != nullptr && dot(silhouette_normal_[point], silhouette_normal_[point]) > 0;
  }

  Cascade& cascade() { return cascade_; }

 private:
  friend struct FitProblem;
  Vec3* samples_at(std::size_t point) { return baked_ + point * cascade_.model().cascade().count; }
  void lay_out_silhouette(Arena& arena, const Model& model);
  Status start_silhouette();
  std::size_t find_contour(const float* q, const Projector& projector);
  void match(const struct FitProblem& problem, std::size_t point, const Projector& projector,
             std::size_t found);
  void match_silhouette(const struct FitProblem& problem);
  Status fit_ideal(Span<const Correspondence> points, const FitOptions& options, float* q, FitReport* report,
                   float* sd, Vec2* residuals, float* weights);
  bool undo_fold_over(struct FitProblem& problem);
  int minimise_in_stages(struct FitProblem& problem, bool has_silhouette);
  Status conclude(struct FitProblem& problem, float* q, FitReport* report, float* sd, Vec2* residuals,
                  float* weights, int iterations);

  Cascade cascade_;
  NormalEquations equations_;
  FitLimits limits_;
  Vec3 *baked_ = nullptr, *position_ = nullptr;
  Correspondence* ideal_ = nullptr;  // the points as a pinhole would have seen them
  float *sorted_ = nullptr, *step_ = nullptr, *trial_q_ = nullptr, *start_q_ = nullptr;
  std::uint16_t* unknown_ = nullptr;
  Vec2* column_ = nullptr;

  FoldOverTest fold_over_;
  Vec3 *valid_ = nullptr, *trial_ = nullptr;  // the base mesh at valid_q_ and at a trial
  float* valid_q_ = nullptr;

  // With FitLimits::silhouette:
  Mesh mesh_;
  DepthBuffer depth_;
  SilhouetteFinder finder_;
  Vec3* vertex_ = nullptr;  // of the base mesh, and its image
  Vec2* vertex_image_ = nullptr;
  float* vertex_depth_ = nullptr;
  Span<SilhouettePoint> contour_;
  Vec2* silhouette_normal_ = nullptr;  // a point: across the outline where it is matched to it, else 0
};

/// A frontal view that puts the model's landmarks (all that the model names ibugNN, else its base mesh) into the box
/// (px): brows to chin, ear to ear. The start for a face detector's box.
Status view_from_box(const Model& model, Cascade& cascade, const float* q, Vec2 corner, Vec2 size,
                     const Camera& camera, View* view);

}  // namespace pliant
