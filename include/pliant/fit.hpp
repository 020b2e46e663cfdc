#pragma once
/// \file fit.hpp
/// Pose and shape from correspondences between surface points and one image (the paper, section 6, Eq. 8;
/// docs/algorithms.md, sections 4.4, 5.2 and 5.6).
#include <cstddef>
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/camera.hpp"
#include "pliant/cascade.hpp"
#include "pliant/euler.hpp"
#include "pliant/model.hpp"

namespace pliant {

/// No position in an image is farther away, px: sums of squares stay finite.
constexpr float kFarthestPx = 1e6f;

/// Points that a fit needs: eight coordinates for the seven unknowns of pose and focal length.
constexpr std::size_t kLeastFitPoints = 4;

/// A surface point and its position in the image.
struct Correspondence {
  Vec2 uv;             ///< in [0,1]^2
  Vec2 x;              ///< px
  float sd_px = 1.0f;  ///< standard deviation of x, px, > 0
  /// The point is annotated on the silhouette: x lies on the edge of the face in the image, where the surface
  /// near (u,v) turns away from the camera. Landmarks of jaw and cheeks are annotated so. Needs
  /// FitLimits::silhouette.
  bool is_silhouette = false;
};

/// Capacities of a Fitter. They fix its memory.
struct FitLimits {
  std::uint16_t points = 160;  ///< correspondences at most
  /// Room for silhouette points: about 95 bytes a vertex of the base mesh, 8 a point, and 9 KiB.
  bool silhouette = false;
  /// Room for samples of the base mesh, 12 bytes a vertex and record: fits of silhouette points that have turned away, or that fold
  /// the surface over, take two thirds of the time. The last bits may differ.
  bool samples_base_mesh = false;
};

/// How the cost is minimised: by Levenberg-Marquardt (solver.hpp) or by the paper's dynamics (euler.hpp).
enum class FitMethod : std::uint8_t { gauss_newton, euler };

/// Options of one fit.
struct FitOptions {
  int width = 0, height = 0;  ///< image size, px, > 0; its middle is the principal point
  /// Focal length, px. 0: unknown; it is estimated around kDefaultFocalRatio times the larger side.
  float focal_px = 0;
  /// Known intrinsics, with the lens of the image. Null: `focal_px`, and no lens.
  const Camera* camera = nullptr;
  /// Initial view, `is_possible` (camera.hpp): what view_of gives for a pose and the image's camera. Its principal point stays, and
  /// with a known focal length its s / rho does; they are to be the camera's. Null: found from the points.
  const View* start = nullptr;
  /// One flag a parameter. Null: all are free. Frozen parameters keep their value in q.
  const std::uint8_t* is_free = nullptr;
  /// Residual that neither noise nor prior explains, mm on the model: the distance of an annotated landmark
  /// from the model's, >= 0. The robust loss rejects only what is several times larger. Round value, not tuned.
  float misfit_mm = 3.0f;
  bool robust = true;  ///< true: Huber's, then Tukey's loss of the residual's length; false: its square
  /// Steps of Gauss-Newton, count. They are divided equally among the stages: three, or nine with silhouette points. A stage
  /// has at least one step. If the surface is folded over at the end, all are made again, and each stage that folds it over gets
  /// the same number once more, to fit the pose again.
  int iterations = 30;
  /// Weight of the parameters' prior, >= 0. The stiffness of Eq. 12 is K = -stiffness / sd^2. 0: Eq. 8 alone.
  float stiffness = 1;
  FitMethod method = FitMethod::gauss_newton;  ///< how the cost is brought down
  /// Of FitMethod::euler, for each stage. The initial view is found by Gauss-Newton all the same.
  EulerOptions euler;
};

/// Result of one fit.
struct FitReport {
  View view;                     ///< pose and camera
  float rms_px = 0;              ///< over the points used
  std::size_t used = 0;          ///< points with a weight above 0 at the end (inliers)
  int iterations = 0;            ///< over all stages, also those that are made again
  std::size_t undetermined = 0;  ///< unknowns that the points and priors left open
  /// A-posteriori standard deviations of the view in the order of PoseUnknown: turn (rad), log s, offset
  /// (mm), log rho. The last is 0 with a known focal length. Those of a robust fit include FitOptions::misfit_mm, or what the
  /// residuals say if that is more.
  float pose_sd[kPoseUnknownsWithFocal] = {};
};

/// Further results of a fit. Null: not wanted.
struct FitDetails {
  /// A-posteriori standard deviation of each parameter, as FitReport::pose_sd. A frozen one gets 0, one that no point moves its
  /// prior's.
  float* sd = nullptr;
  /// Projected minus observed position of each point, px; of a matched silhouette point the part across the silhouette.
  Vec2* residuals = nullptr;
  float* weights = nullptr;  ///< robust weight in [0,1], a point
  /// As sd, from the points' deviations alone, as the fit weighs them: 1 - (point_sd / sd of the prior)^2 is the part of a
  /// parameter's degree of freedom that the fit has used.
  float* point_sd = nullptr;
};

/// Fits one model to one image at a time.
///
/// A result that folds the surface over (fold_over.hpp) is not kept: the fit is made again, each stage that leads to a fold-over is
/// moved back towards where it began, and the pose is fitted again. The test takes positions as linear in the parameters: where a
/// rotation is large, a fold-over may remain. Silhouette points are matched to the model's silhouette (silhouette.hpp) at the
/// present pose: a point stays at its own (u,v) while that faces the camera; afterwards it takes the nearest point of the
/// silhouette within reach, and only its distance across the silhouette counts.
/// Bytes: 12 for each point and record of the cascade, 40 a point, 4 n^2 + 130 n for n unknowns (all parameters, and 7 of
/// the view), 36 a vertex and 12 a face of the base mesh, and a Cascade: 210 kB with the default limits and the built-in face.
class Fitter {
 public:
  /// Arena layout (create_in, measured_bytes).
  void lay_out(Arena& arena, const Model& model, const FitLimits& limits);

  /// Estimates pose, camera and the free parameters. Cost: at most options.iterations linearisations of all points, three times
  /// that where the surface folds over; without a start also 50 of the pose alone, and about 50 of all more where the result is in
  /// doubt.
  /// \param points  at least kLeastFitPoints.
  /// \param q       all parameters: initial values, of free ones clamped to their ranges, and result. Null only for a model
  ///                without parameters.
  /// \return ok, or with nothing changed:
  ///   - bad_argument: null points, q or report; NaN; a point beyond a million px; sd_px <= 0; uv outside [0,1]^2; no image
  ///     size; focal length, stiffness, misfit, steps or decrease of the dynamics < 0, or their delta not above 0; a start that
  ///     is no view; silhouette points without room for them; a camera that Lens::make refuses
  ///   - capacity: more points than the limits, or the fitter was never laid out
  ///   - too_few_points
  ///   - underdetermined: all points are on one line of the image, or the pose stays open
  ///   - with FitLimits::silhouette, the statuses of Mesh::set_base for the model's base mesh
  Status fit(Span<const Correspondence> points, const FitOptions& options, float* q, FitReport* report,
             const FitDetails& details = {});

  /// Whether the last fit matched a silhouette point elsewhere than at its own (u,v).
  /// \pre point < FitLimits::points; laid out.
  bool has_slid(std::size_t point) const;

  /// The cascade that fits run on. Its choice of free parameters is the last fit's. \pre laid out.
  Cascade& cascade();

 private:
  struct State;  // in the arena
  State* state_ = nullptr;
};

/// A frontal view in which the model's landmarks fill a box of the image, brows to chin and ear to ear: the
/// initial view for the box of a face detector. The landmarks are all those named ibugNN, or the base mesh's
/// vertices when there are fewer than four.
/// \param q     all parameters.
/// \param size  of the box, px, > 0.
/// \return bad_argument (NaN, an empty box, f <= 0, a view that is not `is_possible` (camera.hpp), or a flat model); `view` is then
///         as before.
Status view_from_box(Cascade& cascade, const float* q, Vec2 corner, Vec2 size, const Camera& camera,
                     View* view);

}  // namespace pliant
