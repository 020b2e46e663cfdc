#pragma once
/// \file estimator_options.hpp
/// Limits and options of the estimator.
#include <cstddef>
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/cascade.hpp"
#include "pliant/criteria.hpp"
#include "pliant/observation.hpp"
#include "pliant/status.hpp"
#include "pliant/stretch_prior.hpp"

namespace pliant {

struct ForceRejection;
/// The rejection of outlying image forces (image_forces.hpp). A program that does not name it does not link it.
extern const ForceRejection kForceRejection;

struct MeshFollowing;
/// The mesh that follows the view (EstimatorOptions::mesh_operations). A program that does not name it does not link it.
extern const MeshFollowing kMeshFollowing;

/// Capacities: they fix the memory. Defaults are for 320 x 240 on a Linux board; profile_s()
/// (tracker_profiles.hpp) shows limits for a microcontroller.
struct EstimatorLimits {
  /// Surface points at once: patches, markers and edge points, count. Ids are below this.
  std::uint16_t points = 128;
  /// Of those, points that slide along the silhouette, count. 256 bytes each, and 16 bytes a vertex if there are any.
  std::uint16_t silhouette_points = 0;
  /// Observations from which the rejection of image forces estimates, count; of more observations it takes a sample.
  /// 35 kB and 150 bytes each, of which no more count than there are points, and 4,096. 0: no rejection and no memory for it.
  std::uint16_t rejection_sample = 256;
  /// If null, image forces are not rejected, and 15 kB of code are not linked. With Rejection::on_doubt a doubtful frame is
  /// then solved a second time from the expected state, with robust weights alone.
  const ForceRejection* rejection = &kForceRejection;
  /// If null, the springs of the model's table are ignored and their code is not linked.
  const StretchPrior* stretch = &kStretchPrior;
  /// If null, the mesh adapts to the surface at the start alone, `start` returns capacity for options with mesh_operations, and
  /// 2 kB of code are not linked.
  const MeshFollowing* mesh_following = &kMeshFollowing;
  /// Vertices of the mesh, count: at least those of the model's base mesh. There are twice as many faces.
  std::uint16_t vertices = 512;
  /// Free parameters at once, count. 0: all parameters of the model.
  std::uint16_t free_parameters = 0;
  /// Samples kept for a surface point (Cascade::samples_per_point), 12 bytes each, count. 0: enough for any
  /// choice of free parameters. `start` returns capacity if they do not suffice.
  std::uint16_t samples_per_point = 0;
  /// If true, samples are kept for the vertices as well: 12 bytes times samples times vertices. If false,
  /// vertex positions are read from the tables, which takes a few times longer.
  bool samples_vertices = true;
  /// Size of the field into which `start` personalises the model (Cascade::personalise), 6 bytes a sample. With it,
  /// new points, tangents and adaptation cost as much as the expressions alone.
  PersonalFieldLimits personal_field;
  /// How it is filled. If null, there is no such field, and 2 kB of code are not linked.
  Status (Cascade::*personalise)(const float* q) = &Cascade::personalise;
  /// If not empty, at least adaptation_bytes at an address that is a multiple of Arena::kAlignment: memory in which `start`
  /// adapts the mesh, and which others may use between starts. `start` then returns capacity for options with mesh_operations.
  /// Empty: the estimator has memory of its own for that.
  Span<unsigned char> adaptation_memory;
  /// If not empty, at least solve_bytes at an address that is a multiple of Arena::kAlignment: memory of the solves, which others
  /// may use from an `end` to the next solve. Empty: the estimator has memory of its own for that.
  Span<unsigned char> solve_memory;
};

/// Bytes that the adaptation of a mesh takes at most (EstimatorLimits::vertices).
constexpr std::size_t adaptation_bytes(std::uint16_t vertices) {
  return std::size_t{48} * vertices + 128;  // Adapter, and the alignment of its arrays
}

/// Whether memory that the caller lends has room for so many bytes, and is aligned; or none is lent.
inline bool is_usable_for(std::size_t bytes, Span<unsigned char> memory) {
  return memory.empty() ||
         (memory.data != nullptr && memory.count >= bytes && Arena(memory.data, memory.count).is_aligned());
}

/// create_in refuses limits whose memory for adaptation is too small or not aligned (arena.hpp).
inline bool is_usable(const EstimatorLimits& limits) {
  return is_usable_for(adaptation_bytes(limits.vertices), limits.adaptation_memory);
}

/// Bytes of the solves of an estimator with these limits (EstimatorLimits::solve_memory).
std::size_t solve_bytes(const Model& model, const EstimatorLimits& limits);

/// create_in also refuses limits whose memory for solves is too small or not aligned (arena.hpp).
inline bool are_usable(const Model& model, const EstimatorLimits& limits) {
  return is_usable(model) && is_usable(limits) &&
         is_usable_for(solve_bytes(model, limits), limits.solve_memory);
}

/// The same limits without a mesh that follows the view.
template <class Limits>
constexpr Limits without_mesh_following(Limits limits) {
  limits.mesh_following = nullptr;
  return limits;
}

/// The same limits without a field of the person.
template <class Limits>
constexpr Limits without_personal_field(Limits limits) {
  limits.personal_field = {};
  limits.personalise = nullptr;
  return limits;
}

/// The same limits without rejection of image forces.
template <class Limits>
constexpr Limits without_rejection(Limits limits) {
  limits.rejection_sample = 0;
  limits.rejection = nullptr;
  return limits;
}

/// How outliers are rejected (docs/algorithms.md, section 6.5).
enum class Rejection : std::uint8_t {
  none = 0,               ///< least squares
  weights = 1,            ///< robust weights on residuals: Huber's loss, then Tukey's
  forces = 2,             ///< in the first solve of a frame, image forces (image_forces.hpp), then weights
  forces_readmitted = 3,  ///< the same; then rejected observations that fit the result are taken back
  /// Weights. If their result is doubtful, the solve is repeated with forces_readmitted; that result is taken if its cost is
  /// below 0.8 of the first one's.
  on_doubt = 4,
};

/// A time that is not known.
inline constexpr std::int64_t kNoTime = INT64_MIN;

/// Options: they do not change the memory. Those out of their bounds are refused (check).
struct EstimatorOptions {
  /// Time of the frame that the start describes, ns, with the origin of Estimator::begin. A tracker sets it itself. kNoTime: the
  /// first frame counts as 1/30 s later.
  std::int64_t time_ns = kNoTime;
  /// Trial steps of each minimisation, at most, count, 0 to 1,000. A solve minimises with Huber's loss and then with
  /// Tukey's. Round value, not tuned.
  int iterations = 4;
  Rejection rejection = Rejection::on_doubt;  ///< what is done about outliers
  /// Bit k: observations of cue k take part. Cue::flow is the fallback of templates: a tracker has none without Cue::patch.
  std::uint8_t cues = 0x07;
  /// Whether a cue takes part.
  bool uses(Cue cue) const { return (cues >> static_cast<unsigned>(cue) & 1u) != 0; }
  /// Fraction by which a cue's noise scale follows its residuals, a frame, 0 to 1. 0: never. Round value, not
  /// tuned.
  float cue_scale_rate = 0.1f;
  /// Standard deviation of the distance between the real surface and the model at its best, mm, 0 to 1,000. It is added
  /// to the noise of every observation but edges. Model errors are spatially correlated: more points do not
  /// reduce them. On a real face the residuals are about 1 mm, ten times the noise of the image.
  float model_error_mm = 1.0f;
  /// Mean error to which the mesh is refined at the start (contour criterion), mm, finite. 0, and mesh_operations 0:
  /// it stays the model's base mesh. Negative: an estimator that has started keeps its mesh, for a start at nearly the same shape.
  /// Refining it takes as long as two frames. The vertices of a mesh that is kept move to the surface within 8 good frames.
  float mesh_error_mm = 0.3f;
  /// Splits and welds after a good frame, at most, count, with which the mesh follows the view. 0: the mesh
  /// of the start stays. The mesh changes pose and parameters only by what it takes as visible.
  std::uint16_t mesh_operations = 0;
  /// Vertices while the mesh follows the view, count. 0: those of the limits.
  std::uint16_t vertex_budget = 0;
  /// Tolerance of the view criterion (ViewOptions), px.
  float mesh_error_px = 0.5f;
  /// If its score is not null, the mesh is also refined where there is texture.
  TextureOptions texture;
  /// If true, a frame starts from the state that the motion filter predicts; if false, from the state of the
  /// last frame. The covariance of predictions, and the values at which the parameters are expected, come
  /// from the filter in both cases.
  bool predicts_motion = false;
  /// If true, smoothed results are computed as well.
  bool smooths = false;
  /// The tangents of one point in this many are computed in a frame, count. Tangents follow the pose in every
  /// frame; their change by expressions lags by this many frames at most.
  std::uint8_t tangent_interval_frames = 4;
  /// One vertex in this many follows the expression in a frame, count. On fast motion all vertices are
  /// updated. Vertices serve visibility only.
  std::uint8_t vertex_interval_frames = 4;
};

/// `ok`, or `bad_argument` for an option out of its bounds.
Status check(const EstimatorOptions& options);

}  // namespace pliant
