#pragma once
/// \file estimator.hpp
/// One tracked model over time: predicts where its surface points will be seen, and estimates pose and parameters from
/// what was (the paper, section 8 and Appendix A). Never sees a pixel.
///
/// A frame is `begin(t)`, one or more rounds of predict -> (the platform looks) -> `solve`, and `end()`.
#include <cstddef>
#include <cstdint>

#include "pliant/adapt.hpp"
#include "pliant/arena.hpp"
#include "pliant/camera.hpp"
#include "pliant/field.hpp"
#include "pliant/mesh.hpp"
#include "pliant/model.hpp"
#include "pliant/observation.hpp"
#include "pliant/solver.hpp"

namespace pliant {

/// Capacities. The defaults track a face at 320 x 240 on a Cortex-M7.
struct EstimatorLimits {
  std::uint16_t points = 128;     ///< surface points followed at once (anchors and markers); ids are below this
  std::uint16_t vertices = 512;   ///< of the mesh; faces are twice as many
};

struct EstimatorOptions {
  int iterations = 5;               ///< Gauss-Newton steps a solve, at most
  float mesh_error_mm = 0.5f;       ///< the mesh is refined by the contour criterion to this mean error, or to its limit
  float noise_floor_px = 0.3f;      ///< smallest scale of the robust loss
  float expression_rate = 4.0f;     ///< ranges of a parameter it may cross in a second (one sd of the temporal prior)
  float prior_strength = 1.0f;      ///< weight of the parameters' own prior
  float lost_rms_px = 4.0f;         ///< scaled by image width / 320
  float lost_share = 0.15f;         ///< of the predicted visible points that must be inliers
  std::uint16_t lost_points = 8;
  std::uint8_t lost_frames = 3;     ///< bad frames in a row before the state is `lost`
};

enum class TrackState : std::uint8_t { tracking = 0, degraded = 1, lost = 2 };

struct FrameResult {
  TrackState state = TrackState::lost;
  Pose pose;                     ///< meaningful unless lost
  std::uint16_t tracked = 0;     ///< observations found
  std::uint16_t inliers = 0;     ///< those with weight at the end
  float rms_px = 0;              ///< of the inliers
  int iterations = 0;
  std::uint16_t vertices = 0;    ///< of the mesh
};

class Estimator {
 public:
  void lay_out(Arena& arena, const Model& model, const EstimatorLimits& limits);

  /// Starts from a known state in a picture of width x height pixels. `q` holds all parameters; identity is frozen from
  /// here on. Forgets all surface points. \return bad_argument for a pose, camera, size or q that is not finite.
  Status start(const Camera& camera, int width, int height, const Pose& pose, const float* q,
               const EstimatorOptions& options);
  bool is_started() const { return started_; }

  /// Takes on a surface point. Its id is the lowest free one. \return capacity, bad_argument.
  Status add_point(Vec2 uv, std::uint16_t* id);
  void remove_point(std::uint16_t id);
  bool has_point(std::uint16_t id) const { return id < limits_.points && in_use_[id] != 0; }
  Vec2 point_uv(std::uint16_t id) const { return uv_[id]; }

  /// Predicts the state at time t (ns). A time that does not grow counts as one nominal frame.
  Status begin(std::int64_t time_ns);
  /// One prediction a point in use, in order of id, at the state as it is now. Valid until the next call.
  Span<const Prediction> predict();
  /// Moves the state to fit the observations; may be called more than once a frame. Marks each observation that the
  /// robust loss gave no weight as `rejected`.
  Status solve(Span<Observation> observations, SolverReport* report);
  /// Decides the state and returns the result. While lost the pose is the last one that was trusted.
  FrameResult end();

  const Model& model() const { return cascade_.model(); }
  const Camera& camera() const { return camera_; }
  const View& view() const { return view_; }
  /// All parameters.
  Span<const float> parameters() const { return {q_, cascade_.parameter_count()}; }
  /// Standard deviations of the free parameters by Gauss-Newton; 0 for frozen ones.
  Span<const float> deviations() const { return {sd_, cascade_.parameter_count()}; }

  /// Image position of any (u,v) at the present state; false behind the camera.
  bool project(Vec2 uv, Vec2* x);
  /// (u,v) on the visible surface under an image position: by the mesh, then refined on the surface itself. Where the
  /// image position misses the surface, the nearest visible projected surface point, and false.
  bool surface_at(Vec2 x, Vec2* uv);
  /// True when the surface itself hides the point p (model coordinates) from the camera.
  bool is_hidden(Vec3 p) const;

  const Mesh& mesh() const { return mesh_; }
  /// Positions of the mesh's vertices at the present state, by vertex id: model millimetres and image pixels.
  const Vec3* vertex_positions() const { return vertex_; }
  const Vec2* vertex_images() const { return vertex_image_; }

 private:
  friend struct EstimatorProblem;
  // (laid out in estimator.cpp)
  Cascade cascade_;
  Mesh mesh_;
  NormalEquations equations_;
  EstimatorLimits limits_;
  EstimatorOptions options_;
  Camera camera_;
  View view_;
  bool started_ = false;
  int width_ = 0, height_ = 0;
  std::uint8_t* in_use_ = nullptr;
  Vec2* uv_ = nullptr;
  float *q_ = nullptr, *sd_ = nullptr;
  Vec3* vertex_ = nullptr;
  Vec2* vertex_image_ = nullptr;
};

}  // namespace pliant
