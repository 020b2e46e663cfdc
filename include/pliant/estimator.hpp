#pragma once
/// \file estimator.hpp
/// Estimation of one model's pose and parameters over time (the paper, section 8 and Appendix A). It predicts
/// surface points, receives observations of them, and never sees a pixel. A frame is `begin`, optionally
/// `solve_first_pass`, one or more rounds of `predict`, matching by the platform and `solve`, and `end`.
#include <cstddef>
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/camera.hpp"
#include "pliant/estimator_options.hpp"
#include "pliant/filter.hpp"
#include "pliant/frame_work.hpp"
#include "pliant/lens.hpp"
#include "pliant/mesh.hpp"
#include "pliant/model.hpp"
#include "pliant/observation.hpp"
#include "pliant/solver.hpp"
#include "pliant/visibility.hpp"

namespace pliant {

/// What a frame of a track is worth.
enum class TrackState : std::uint8_t {
  tracking = 0,  ///< pose and parameters are those of this frame
  /// Either the frame was bad, and pose and parameters are those of the last good one; or they are this
  /// frame's but less exact: a large landmark error is expected, the head is turned by more than 50 degrees,
  /// a part was covered or the face overexposed at the start, or too little of a print is seen.
  degraded = 1,
  lost = 2,  ///< several bad frames in a row, or no track
};

/// Result of one frame.
struct FrameResult {
  TrackState state = TrackState::lost;  ///< what the frame is worth
  Pose pose;  ///< of this frame, after a bad one of the last good frame; without a track frontal, 1000 mm away
  std::uint16_t tracked = 0;            ///< points with a usable observation
  std::uint16_t inliers = 0;            ///< points with weight at the solve's end, also if it failed (7.15)
  float rms_px = 0;                     ///< of the inliers; of an edge, across it
  std::uint16_t iterations = 0;         ///< of all solves of the frame
  std::uint16_t vertices = 0;           ///< of the mesh
  float score = 0;                      ///< mean correlation of the inliers of cue patch
  Pose smoothed_pose = {};              ///< if options.smooths; parameters in Estimator::smoothed_parameters
  bool pose_is_observed = false;        ///< the observations determine the whole pose without the priors
  /// Of a Tracker with learnt tables: expected mean landmark error over the distance of the outer eye corners. 0: unknown. A frame
  /// is degraded above 0.08, with the head turned beyond 50 degrees, and after a doubtful start (docs/algorithms.md, 7.15).
  float landmark_error = 0;
  /// Of a Tracker with readers of the eyes: the common direction of both eyes relative to the head, a unit vector in the model's
  /// axes (x to the subject's left, y up, z straight ahead). 0: not seen (lids closed, turned by more than 40 degrees, an eye cut
  /// off, no good track). Off by some degrees, which are a person's own and constant; and by 2 degrees to the sides, 3 up and down.
  Vec3 gaze = {};
  bool is_searching = false;  ///< of a Tracker: there is no track; the next frame is searched for the face or print
};

/// A state to save and restore. The arrays are the caller's and hold one value for each of the model's parameters.
struct State {
  Pose pose;                          ///< of the model
  float pose_sd[kPoseUnknowns] = {};  ///< standard deviations, in PoseUnknown's order and units
  float* q = nullptr;                 ///< all parameters
  float* sd = nullptr;  ///< standard deviations; 0 for parameters that are not free; may be null
};

/// One tracked model. Image positions are distorted (as seen through the lens); internally they are undistorted.
///
/// Lives in an arena: `lay_out` comes before every other call (create_in, measured_bytes). Until `start`,
/// calls that return a status return not_started, and the others must not be made, except `is_started`.
class Estimator {
 public:
  Estimator() = default;
  Estimator(const Estimator&) = delete;
  Estimator& operator=(const Estimator&) = delete;

  /// Takes its memory from the arena; called by create_in and measured_bytes (arena.hpp).
  void lay_out(Arena& arena, const Model& model, const EstimatorLimits& limits);

  /// Starts from a known state in an image of width x height pixels. All surface points are removed. The mesh is
  /// adapted to the surface at `q`.
  /// \param q        all parameters; values outside a parameter's range are clamped. Null only for a model without parameters.
  /// \param is_free  a flag for each parameter: the free ones are estimated. Null: the expressions are free.
  /// \return bad_argument if pose and camera are not `is_possible` (camera.hpp), q is not finite, or the
  ///         lens (Lens::make) or an option is refused; then nothing has changed. capacity for more free parameters or
  ///         samples than the limits allow; bad_table for damaged springs; the statuses of Mesh::set_base and
  ///         Cascade::personalise; then the estimator is not started.
  Status start(const Camera& camera, int width, int height, const Pose& pose, const float* q,
               const std::uint8_t* is_free, const EstimatorOptions& options);
  bool is_started() const;  ///< True after a successful start.

  /// Adds a surface point under the lowest free id.
  /// \return not_started, bad_argument (no id, or (u,v) outside the chart), capacity.
  Status add_point(Vec2 uv, std::uint16_t* id);
  /// Adds a point of a curve where the image has an edge. The normal of a prediction is perpendicular to the image of the curve,
  /// clockwise on the screen. \param along  direction of the curve in (u,v), of any length but zero. \return as add_point.
  Status add_edge_point(Vec2 uv, Vec2 along, std::uint16_t* id);
  /// Adds edge points along a curve of the model, `spacing_mm` apart on the present surface; the first half as far from its start.
  /// \param count  out: points added; with capacity, those for which there was room.
  /// \return not_started, bad_argument (no count, no such curve, spacing <= 0), capacity.
  Status add_curve(std::size_t curve, float spacing_mm, Span<std::uint16_t> ids, std::size_t* count);
  /// Adds a point that slides along the silhouette. `begin`, `propose` and `restore` place it within its own
  /// sector of directions from the middle of the silhouette; all such points divide the full turn evenly. Its
  /// normal points away from the surface. It is not visible while its sector has no silhouette.
  /// \return as add_point.
  Status add_silhouette_point(std::uint16_t* id);
  void remove_point(std::uint16_t id);  ///< Gives the id back. Nothing happens for an id that is not in use.
  bool has_point(std::uint16_t id) const;  ///< True where the id is in use.
  Vec2 point_uv(std::uint16_t id) const;   ///< (u,v) of a point. \pre has_point(id).
  /// A point (mm, model axes) now, and its tangents of the last few frames; a silhouette point has none. \pre has_point(id).
  SurfaceFrame point_frame(std::uint16_t id);

  /// Starts a frame at time `time_ns` (ns). A time that grows by less than 1 ms repeats the last frame: no
  /// motion is predicted. One that runs backwards or grows by 2 s or more resets all velocities, and counts
  /// as 1/30 s.
  void begin(std::int64_t time_ns);
  /// Predicts a measured motion, not that of `begin`: about `px` in the image since the last good frame, or the proposed view.
  void translate(Vec2 px);
  /// Makes `view` (finite, s > 0) the predicted view, with the parameters of the last good frame, to search for a lost model.
  void propose(const View& view);
  /// Replaces what is expected of a free parameter in this frame by a measurement of the platform: value and standard
  /// deviation, both finite, sd > 0. The state moves there. Nothing happens for a parameter that is not free.
  void expect(std::size_t parameter, float value, float sd);
  void save(State* state) const;  ///< Copies the present state out. Null arrays are left out.
  /// Makes a saved state the predicted one, but for pose_sd, sd and the parameters that are not free. With predicted motion
  /// (EstimatorOptions) only between `begin` and `end`, since `begin` predicts from what was measured.
  /// \return not_started, bad_argument (no q, not finite, or not `is_possible`); then nothing has changed.
  Status restore(const State& state);

  /// Predicts all points at the present state, in order of id. Valid until the next call. Cost: O(points x samples of a point).
  Span<const Prediction> predict();
  /// Predicts one point. Precondition: has_point(id).
  Prediction predict(std::uint16_t id);
  /// Fits the state to observations of a few points, so that the others are predicted more accurately. To be
  /// called between `begin` and the first `solve`. Outliers are weighted only (Rejection::weights).
  /// Cost: as `solve`.
  /// \return false if the result is doubtful or does not determine the pose; then the state is unchanged.
  bool solve_first_pass(Span<Observation> observations);
  /// True if, in the solve after a first pass, more than a few points were far from their prediction.
  /// Predicting and matching them again at the state of that solve finds more of them.
  bool needs_another_round() const;
  /// Fits the state to the observations. May be called several times a frame. Outliers are marked `rejected`;
  /// observations of unknown points, and those that are not finite, are marked `not_visible`. If the
  /// observations are too few to determine the pose, the state is unchanged.
  SolverReport solve(Span<Observation> observations);
  /// Ends the frame: decides the track's state from the last `solve`. After a bad frame pose and parameters
  /// are those of the last good one.
  FrameResult end();
  /// After an `end` that told a bad frame: makes a state that the platform has measured that of the last good frame, at rest, but
  /// for parameters that are not free. \param result  becomes tracking, with the new poses. \return as `restore`.
  Status accept(const State& measured, FrameResult* result);

  const Model& model() const;                     ///< The model of the layout.
  const Camera& camera() const;                   ///< The camera of the start.
  const Lens& lens() const;                       ///< The lens of the start's camera.
  const View& view() const;                       ///< The present view.
  Span<const float> parameters() const;           ///< All parameters.
  Span<const float> smoothed_parameters() const;  ///< The smoothed parameters, if options.smooths.
  const MotionFilter& motion() const;             ///< The filter over pose and parameters.
  /// Ratio of a cue's residuals to the standard deviations of its observations, followed over time, at least 1.
  float cue_scale(Cue cue) const;

  /// Of the last frame: rows and factorisations.
  FrameWork work() const;
  /// Ends the solves of every frame early once they have taken so much work; a frame's state is then less exact.
  /// \param most  in the unit of WorkCosts; 0 or less: nothing is left. A start ends the limit.
  void limit_work(const WorkCosts& costs, float most);
  /// Costs of this model's loops with templates of `window` px a side. To be called after a start.
  WorkCosts work_costs(int window) const;

  Vec3 surface_point(Vec2 uv);  ///< Position of any (u,v) at the present parameters, mm, model axes.
  void surface_points(Span<const Vec2> uv, Vec3* positions);  ///< The same of several, which takes less time.
  bool project(Vec2 uv, Vec2* x);  ///< Image position of any (u,v) at the present state. False behind the camera.
  /// Finds (u,v) of the visible surface under an image position (finite), or of the visible point nearest to it.
  /// \return distance in the image between x and that point, px; 0 on the surface; negative when nothing is visible.
  float surface_at(Vec2 x, Vec2* uv);
  /// Moves `uv`, the point of the mesh under x, to the point of the surface there: the second half of
  /// `surface_at`, for callers that already have the point on the mesh. Unchanged if it does not converge.
  void refine_uv(Vec2 x, Vec2* uv);

  const Mesh& mesh() const;  ///< The adapted mesh.
  /// Positions of the mesh's vertices (mm, model axes), by vertex id, as of the last `start` or `end`.
  /// Vertices follow the expression a few at a time (options.vertex_interval_frames), on fast motion all.
  /// Those without cached samples are accurate to about 1 mm. `refresh_vertices` makes all exact.
  const Vec3* vertex_positions() const;
  const Vec2* vertex_images() const;   ///< Their pinhole images, px: of the last `end`, or of a later `predict` that drew depth.
  Vec2 vertex_seen(VertexId v) const;  ///< Image of one vertex as seen through the lens, px.
  void refresh_vertices();             ///< Updates all vertices to the present state.

  /// Corrects what the start assumed: the parameters that are not free, and the model's rotation. Points are sampled
  /// anew, vertices in the frames that follow; a personal field is given up. Earlier frames keep their poses.
  /// \param q  all parameters, finite. \param turn  of unit length; the pose becomes q * turn. \return not_started, bad_argument.
  Status revise(const float* q, Quat turn);
  /// Moves a point over the surface in the `revise` that follows. \pre has_point(id); uv within 0..1.
  void slide_point(std::uint16_t id, Vec2 uv);
  void forget_person();  ///< Gives up the personal field, so that `surface_frame` reads every parameter.
  SurfaceFrame surface_frame(Vec2 uv, const float* q);  ///< Surface point (mm) and tangents at parameters q.

 private:
  struct Impl;
  Impl* impl_ = nullptr;
};

}  // namespace pliant
