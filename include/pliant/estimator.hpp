#pragma once
/// \file estimator.hpp
/// One tracked model over time: predicts where its surface points will be seen, and estimates pose and parameters from
/// what was (the paper, section 8 and Appendix A). Never sees a pixel.
///
/// A frame is `begin(t)`, perhaps an `approach` by a few points, one or more rounds of predict -> (the platform looks) ->
/// `solve`, and `end()`.
#include <cstddef>
#include <cstdint>

#include "pliant/adapt.hpp"
#include "pliant/arena.hpp"
#include "pliant/camera.hpp"
#include "pliant/criteria.hpp"
#include "pliant/cascade.hpp"
#include "pliant/filter.hpp"
#include "pliant/image_forces.hpp"
#include "pliant/lens.hpp"
#include "pliant/mesh.hpp"
#include "pliant/model.hpp"
#include "pliant/observation.hpp"
#include "pliant/silhouette.hpp"
#include "pliant/robust.hpp"
#include "pliant/solver.hpp"
#include "pliant/visibility.hpp"

namespace pliant {

struct EstimatorProblem;

/// The rejection of false image forces (image_forces.hpp), apart from the estimator: its code comes into a program by
/// limits that name it, and only so.
struct ForceRejection {
  void (*lay_out)(Arena& arena, ForceRejector& rejector, std::size_t sample);
  void (*reject)(EstimatorProblem& problem);
};
extern const ForceRejection kForceRejection;

/// Capacities. The defaults track a face at 320 x 240 on a Cortex-M7.
struct EstimatorLimits {
  std::uint16_t points =
      128;  ///< surface points followed at once (anchors, markers, edge points); ids are below this
  std::uint16_t silhouette_points = 0;  ///< of those, that slide along the outline; 304 bytes each, 16 a vertex
  /// Observations that the rejection of image forces looks at: of more, a sample. 0: none, and no memory for it (else 25
  /// kB and 200 bytes each).
  std::uint16_t rejection_sample = 256;
  /// Null does as a sample of 0 does, and saves 15 kB of code where no other limits name it.
  const ForceRejection* rejection = &kForceRejection;
  std::uint16_t vertices =
      512;  ///< of the mesh, at least those of the model's base mesh; faces are twice as many
  std::uint16_t free_parameters = 0;  ///< estimated at once, at most; 0: all that the model has
  /// Samples kept a surface point (Cascade::samples_per_point under the free parameters chosen), 12 bytes each; 0: as many as
  /// any choice needs. `start` gives capacity when they do not suffice.
  std::uint16_t samples_per_point = 0;
  /// Whether the vertices keep theirs too (12 bytes times samples times vertices). If not, their positions come
  /// from the tables, which takes a few times longer.
  bool samples_vertices = true;
  /// Of the field that `start` folds the person into (Cascade::fold), 6 bytes a sample; none: no such field. Points taken
  /// on while tracking, tangents and adaptation then cost the expressions alone: for many identity parameters.
  PersonalFieldLimits personal_field;
};

/// The same limits, without rejection of image forces.
template <class Limits>
constexpr Limits without_rejection(Limits limits) {
  limits.rejection_sample = 0;
  limits.rejection = nullptr;
  return limits;
}

/// What is done about observations that are false (ALGORITHMS: section 6.5).
enum class Rejection : std::uint8_t {
  none = 0,     ///< least squares
  weights = 1,  ///< robust weights on residuals: Huber, then Tukey
  forces =
      2,  ///< and before, in a frame's first solve, by image forces in parameter space (image_forces.hpp)
  forces_readmitted = 3,  ///< and after it, what fits the result is taken back
  /// Weights; where they leave doubt (large residuals, much without weight) the solve is done again with
  /// forces_readmitted, and the one that explains more is kept.
  on_doubt = 4,
};

struct EstimatorOptions {
  int iterations = 4;  ///< Gauss-Newton steps in each of the two stages (Huber, Tukey) of a solve, at most
  float relative_decrease = 1e-3f;  ///< a stage ends when a step would lower the cost by less than this share
  Rejection rejection = Rejection::on_doubt;
  float doubt_scale = 1.2f;       ///< residuals over those that the cues usually have
  float doubt_fraction = 0.15f;      ///< of the observations, without weight
  float alternative_margin = 0.8f;  ///< what the second solve may cost at most, of the first
  float readmission = 3.5f;       ///< scales of the residuals kept within which an observation is taken back
  std::uint8_t cues = 0x0f;       ///< bit k: cue k takes part
  bool uses(Cue cue) const { return (cues >> static_cast<unsigned>(cue) & 1u) != 0; }
  float cue_scale_rate =
      0.1f;  ///< how fast the scale of a cue's errors follows the residuals, a frame; 0: never
  float mesh_error_mm =
      0.3f;  ///< the mesh is refined by the contour criterion to this mean error, or to its limit
  /// Splits and welds a good frame may end with, to keep the mesh to what the view needs; 0: the mesh of the start
  /// stays. What is tracked does not depend on it: pose and parameters are the observations'.
  std::uint16_t mesh_operations = 0;
  std::uint16_t vertex_budget = 0;  ///< hard limit while it adapts; 0: the limits' vertices
  float mesh_error_px = 0.5f;       ///< tolerance across the line of sight (criteria.hpp: ViewOptions)
  TextureOptions texture;           ///< with a score: vertices where there is something to track, as well
  std::uint8_t rank_interval_frames = 32;     ///< one face and vertex in so many is ranked anew a frame
  /// How far the real surface is from the model's at its best, mm: added to every observation, at the scale at which the
  /// model is seen. Neighbours err alike, so that many points are no better a word than a few: on a real face residuals
  /// are a millimetre, where the picture would allow a tenth of that.
  float model_error_mm = 1.0f;
  float edge_error_mm = 1.7f;    ///< the same of edges
  float expression_rate = 3.0f;  ///< ranges a parameter may cross in a second (one sd of the temporal prior)
  float prior_strength = 1.0f;   ///< weight of the parameters' own prior
  bool predicts_motion =
      false;             ///< begins a frame where the motion filter expects it, not where the last one was
  MotionOptions motion;  ///< of that filter; the covariance of predictions is its own either way
  bool smooths = false;  ///< gives a smoothed output besides
  OneEuroOptions smoothing;
  std::uint8_t tangent_interval_frames =
      4;  ///< the tangents of one point in so many are computed anew each frame; they turn with
          ///< the pose in every frame, and lag the expression by so many frames at most
  std::uint8_t vertex_interval_frames = 4;  ///< so for the mesh's vertices, which only tell what hides what
  float min_facing =
      0.3f;  ///< cosine of surface normal and viewing direction below which a point is not visible
  float lost_rms_px = 4.0f;  ///< at 320 px of image width
  float lost_fraction = 0.15f;  ///< of the points looked for that must be inliers; and of those of cue patch
  float lost_score = 0.5f;   ///< mean correlation of the inliers of cue patch
  float lost_scale_change = 0.2f;  ///< of the image scale, from one frame to the next
  std::uint16_t lost_points = 8;   ///< inliers needed
  std::uint8_t lost_frames = 3;    ///< bad frames in a row until the state is `lost`
};

enum class TrackState : std::uint8_t { tracking = 0, degraded = 1, lost = 2 };

struct FrameResult {
  TrackState state = TrackState::lost;
  Pose pose;                  ///< meaningful unless lost
  std::uint16_t tracked = 0;  ///< observations found
  std::uint16_t inliers = 0;  ///< those with weight at the end
  float rms_px = 0;           ///< of the inliers; of an edge, across it
  std::uint16_t iterations = 0;
  std::uint16_t vertices = 0;  ///< of the mesh
  float score = 0;             ///< mean of the inliers of cue patch: correlation
  Pose smoothed_pose =
      {};  ///< One-Euro, where options ask for it; parameters in Estimator::smoothed_parameters
  bool pose_is_observed = false;  ///< the observations alone determine all of the pose
};

/// A state on its own: of a key frame, of a session. The arrays are the caller's, a value for each of the model's
/// parameters.
struct State {
  Pose pose;
  float pose_sd[kPoseUnknowns] = {};  ///< of the last solve, in PoseUnknown's order and units
  float* q = nullptr;
  float* sd = nullptr;  ///< 0 where a parameter is not estimated; may be null
};

class Estimator {
 public:
  Estimator() = default;
  Estimator(const Estimator&) = delete;
  Estimator& operator=(const Estimator&) = delete;

  void lay_out(Arena& arena, const Model& model, const EstimatorLimits& limits);

  /// Starts from a known state in a picture of width x height pixels. `q` holds all parameters; those whose flag in
  /// `is_free` is set are estimated, the others stay (null: expressions are free). The mesh is adapted to the person.
  /// Forgets all surface points.
  /// The camera's lens stays at the door: predictions and image positions are as seen through it, observations are taken
  /// to be, and inside there is only the pinhole.
  /// \return bad_argument for a pose, camera, size or q that is not finite, or a lens that Lens::make refuses;
  ///         capacity for more free parameters or samples
  ///         than the limits allow; the statuses of Mesh::set_base.
  Status start(const Camera& camera, int width, int height, const Pose& pose, const float* q,
               const std::uint8_t* is_free, const EstimatorOptions& options);
  bool is_started() const { return started_; }

  /// Takes on a surface point. Its id is the lowest free one. \return not_started, bad_argument, capacity.
  Status add_point(Vec2 uv, std::uint16_t* id);
  /// The same for a point of a curve on the surface where the image has an edge: `along` is the curve's direction in
  /// (u,v), of any length but zero. The normal of its predictions is that direction's in the image, a quarter turn on
  /// (clockwise as one sees it).
  Status add_edge_point(Vec2 uv, Vec2 along, std::uint16_t* id);
  /// Edge points along one of the model's curves (model().curves(): lids, lips, brows), `spacing_mm` apart on the
  /// surface as it is now, the first after half of that. `count` is how many there are: with the status capacity those
  /// that ids and points had room for.
  Status add_curve(std::size_t curve, float spacing_mm, Span<std::uint16_t> ids, std::size_t* count);
  /// A point that is put on the outline of the predicted view in each `begin` (and `propose`, `restore`), within its own
  /// sector of it as seen from the middle; all such points share the full turn evenly. Its normals point away from
  /// the surface. Not visible where its sector has no outline. Statuses: not_started, bad_argument, capacity.
  Status add_silhouette_point(std::uint16_t* id);
  void remove_point(std::uint16_t id);
  bool has_point(std::uint16_t id) const { return id < limits_.points && kind_[id] != PointKind::none; }
  Vec2 point_uv(std::uint16_t id) const { return uv_[id]; }

  /// Predicts the state at time t (ns). A time that grows by less than 1 ms is a frame delivered twice: nothing moves
  /// meanwhile. One that runs backwards or jumps by 2 s or more forgets all velocities. Both count as 1/30 s otherwise.
  void begin(std::int64_t time_ns);
  /// Moves the predicted view so that the model moves by about `px` in the image: a motion the platform has seen.
  void translate(Vec2 px);
  /// Makes `view` the predicted one, with the parameters of the last trusted frame: a place to look for a lost model.
  void propose(const View& view);
  /// Copies the present state out; arrays that are null are left out.
  void save(State* state) const;
  /// Makes a saved one the predicted state. Parameters that are not free keep their value.
  /// \return not_started, bad_argument (no q, or not finite): nothing has changed.
  Status restore(const State& state);
  /// One prediction a point in use, in order of id, at the state as it is now. Valid until the next call.
  Span<const Prediction> predict();
  /// That of one point in use.
  Prediction predict(std::uint16_t id);
  /// A look ahead: moves the state to fit observations of a few points, so that the others are predicted nearer to where
  /// they are. Call it between `begin` and the first `solve`. By weights alone (Rejection); \return false, and nothing has
  /// moved, where those leave doubt, or with too few to determine the pose. Cost: as `solve`.
  bool solve_first_pass(Span<Observation> observations);
  /// Whether the solve after an approach began with more than a few points far from where they were expected: by the state
  /// that it gives they are worth another look.
  bool needs_another_round() const { return needs_another_round_; }
  /// Moves the state to fit the observations; may be called more than once a frame. Those that the robust loss gives no
  /// weight in the end are marked `rejected`. Observations of points not in use, or not finite, are marked
  /// `not_visible` and ignored. With too few to determine the pose nothing moves.
  SolverReport solve(Span<Observation> observations);
  /// Decides the state from the last `solve` and returns the result. While lost the pose is the last one trusted.
  FrameResult end();

  const Model& model() const { return cascade_.model(); }
  const Camera& camera() const { return camera_; }
  const View& view() const { return view_; }
  /// All parameters.
  Span<const float> parameters() const { return {q_, cascade_.parameter_count()}; }

  /// The parameters smoothed, where options ask for it.
  Span<const float> smoothed_parameters() const {
    return {smoother_.parameters(), cascade_.parameter_count()};
  }
  const MotionFilter& motion() const { return motion_; }

  /// How far residuals of a cue have been from the deviations that its observations claim, at least 1.
  float cue_scale(Cue cue) const { return cue_scale_[static_cast<std::size_t>(cue)]; }

  /// Position of any (u,v) at the present parameters, mm.
  Vec3 surface_point(Vec2 uv) { return cascade_.surface_point(uv, q_); }
  /// What is between `view`'s pinhole and the picture.
  const Lens& lens() const { return lens_; }
  /// Image position of any (u,v) at the present state; false behind the camera.
  bool project(Vec2 uv, Vec2* x);
  /// (u,v) on the visible surface under an image position: by the mesh, then on the surface itself. Where the position
  /// misses the surface it is the nearest visible point's, and the distance is not 0.
  /// \return distance in the image between x and the mesh (px); negative when nothing is visible.
  float surface_at(Vec2 x, Vec2* uv);

  const Mesh& mesh() const { return mesh_; }
  /// The mesh's vertices, by vertex id: in the model's axes (mm) and in the image (px). Those of the last `start` or `end`;
  /// between `begin` and `end`, perhaps of a prediction.
  /// A vertex in options.vertex_interval_frames follows the expression in each frame, all where one of them goes far; those that are not
  /// baked to a millimetre or so. `refresh_vertices` brings up all, exactly.
  /// The images are the pinhole's; `vertex_seen` is where the lens puts one.
  const Vec3* vertex_positions() const { return vertex_; }
  const Vec2* vertex_images() const { return vertex_image_; }
  Vec2 vertex_seen(VertexId v) const { return lens_.distort(vertex_image_[v]); }
  void refresh_vertices();

 private:
  friend struct EstimatorProblem;
  enum class PointKind : std::uint8_t { none, surface, curve, silhouette };
  Status take_id(PointKind kind, std::uint16_t* id);
  void place(std::uint16_t id, Vec2 uv);
  void place_silhouette();
  void expect_motion(float seconds);
  void note_motion();
  static constexpr float kSampleSlackMm = 0.01f;  // a hundredth of what a model is off at its best
  Vec3* samples_of_point(std::size_t id) { return point_samples_ + id * sample_stride_; }
  Vec3* samples_of_vertex(std::size_t v) { return vertex_samples_ + v * sample_stride_; }
  void adapt_mesh();
  void follow_view();
  void place_vertex(VertexId v);
  Status choose_free(const std::uint8_t* is_free);
  float move_vertices(std::uint32_t share);
  void update_vertices(std::uint32_t share);
  void project_vertices();
  void draw_depth();
  void update_tangents(std::uint16_t id);
  Prediction prediction(std::uint16_t id, const Projector& projector);
  bool is_predicted() const;
  void see_through_lens(Prediction* p) const;
  bool solve_first_pass_ideal(Span<Observation> observations);
  SolverReport solve_ideal(Span<Observation> observations);
  void undistort(Span<Observation> observations) const;
  void distort(Span<Observation> observations) const;
  /// The observations of one point: one, or alternatives.
  struct Row {
    std::uint16_t id, first;     // first observation
    std::uint8_t count, chosen;  // neighbours from there on, some perhaps not usable; the one that counts
    Cue cue;
    bool is_kept, is_line;
  };
  void gather(Span<Observation> observations);
  bool is_usable(const Observation& o) const;
  Sym2 informed(const Observation& o) const;
  void settle_by_weights(struct EstimatorProblem& problem, SolverReport* report);
  void solve_robustly(EstimatorProblem& problem, SolverReport* report);
  void solve_by_forces(EstimatorProblem& problem, SolverReport* report);
  float far_fraction(const EstimatorProblem& problem) const;
  bool is_doubtful(const EstimatorProblem& problem) const;
  void keep_as_before(EstimatorProblem& problem);
  void conclude(const EstimatorProblem& problem);
  float squared_px(std::size_t row) const;
  bool pose_is_observed();
  void update_cue_scales();
  bool is_good() const;

  Cascade cascade_;
  Mesh mesh_;
  Adapter adapter_;
  ContourOptions contour_;
  ViewOptions view_criterion_;
  EitherOf view_and_texture_;
  float* mesh_q_ = nullptr;    // parameters of the surface that the mesh is adapted to: those of the start
  Vec2* vertex_uv_ = nullptr;  // where each vertex was placed: ids are used again
  DepthBuffer depth_;
  NormalEquations equations_;
  EstimatorLimits limits_ =
      without_rejection(EstimatorLimits{});  // nothing that needs linking, until laid out
  EstimatorOptions options_;
  Camera camera_;
  Lens lens_;
  int width_ = 0, height_ = 0;
  bool started_ = false;

  MotionFilter motion_;
  Smoother smoother_;
  float* range_ = nullptr;  // of the free parameters; 0 for the others
  View view_, trusted_view_, expected_view_;
  float pose_variance_[kPoseUnknowns] = {};  // of the expected view
  std::int64_t time_ns_ = 0;
  float seconds_ = 0;  // since the last frame
  int bad_frames_ = 0;
  FrameResult result_;
  // Of the last solve: points that the platform looked for, those by a patch, and patches among the inliers.
  std::size_t looked_for_ = 0, patches_looked_for_ = 0, patch_inliers_ = 0;
  int solves_ = 0;                // in this frame
  bool had_first_pass_ = false;   // before the first of them
  bool needs_another_round_ = false;    // the one after it, by what it began with
  bool rejected_forces_ = false;  // in its first solve
  static constexpr std::size_t kCueCount = 4;
  float cue_scale_[kCueCount] = {1, 1, 1, 1};

  std::size_t sample_stride_ = 0, sample_capacity_points_ = 0;
  PointKind* kind_ = nullptr;
  Vec2 *uv_ = nullptr,
       *along_ = nullptr;  // along: a curve's direction in (u,v), or the outline's image normal
  SilhouetteFinder finder_;
  SilhouettePoint* silhouette_ = nullptr;
  std::size_t silhouette_count_ = 0;
  Vec3 *tangent_u_ = nullptr, *tangent_v_ = nullptr;  // of the surface points, in the model's axes
  std::uint32_t frame_ = 0;
  Vec3 *point_samples_ = nullptr, *vertex_samples_ = nullptr, *vertex_ = nullptr;
  Vec2* vertex_image_ = nullptr;
  float* vertex_depth_ = nullptr;
  Prediction* predictions_ = nullptr;
  std::size_t prediction_count_ = 0;
  View predicted_view_;  // of these, with predicted_q_
  float *q_ = nullptr, *expected_q_ = nullptr, *trial_q_ = nullptr, *alternative_q_ = nullptr, *sd_ = nullptr,
        *trusted_q_ = nullptr, *predicted_q_ = nullptr;
  float *step_ = nullptr, *variance_ = nullptr;
  std::uint16_t* unknown_ = nullptr;
  Vec2* column_ = nullptr;

  Row* rows_ = nullptr;
  std::size_t row_count_ = 0;
  bool has_enough_ = false;
  Sym2* information_ = nullptr;  // of the rows, with the cue's own error added
  Vec2* residuals_ = nullptr;    // px
  float *lengths_ = nullptr, *sorted_ = nullptr;
  std::uint8_t* was_rejected_ = nullptr;  // by id: in the last solve
  ForceRejector rejector_;
  std::size_t sample_capacity_ = 0;
  float* sample_ = nullptr;
  Vec2* sample_force_ = nullptr;
  std::uint8_t* sample_keep_ = nullptr;
  bool vertices_are_current_ = false, depth_is_drawn_ = false;
  View depth_view_;  // for which it is
  std::uint32_t depth_frame_ = 0;
};

}  // namespace pliant
