#pragma once
// The tracked points of the surface: patches and markers at fixed (u,v), edges on curves of the model, and points on the
// silhouette.
#include <cstdint>

#include "base/prefetch.hpp"
#include "estimate/motion_model.hpp"
#include "pliant/cascade.hpp"
#include "pliant/observation.hpp"
#include "pliant/silhouette.hpp"

namespace pliant {

/// Image position assumed for a point behind the camera, px: far from all observations.
inline constexpr Vec2 kBehind{-1e6f, -1e6f};

/// Tuning of surface points.
struct SurfacePointsTuning {
  /// mm. Vectors that move a point by less are left out of its samples. A hundredth of the model's own error: it saves a
  /// quarter of the samples of a face. Chosen on the
  /// rendered film with 500 points (docs/experiments.md, section Tuning).
  float sample_slack_mm = 0.01f;
  /// mm. Vectors smaller than this are left out of tangents. A tangent only warps a template, which tolerates more. Chosen
  /// likewise.
  float tangent_slack_mm = 0.03f;
  /// Cosine of surface normal and viewing direction below which a point is not visible. A template seen flatter than 70
  /// degrees has too few pixels. Round value, not tuned.
  float least_facing = 0.3f;
  /// A segment of a curve is divided into pieces of this length to measure it on the surface, mm, and into this many at most,
  /// count. The curves of the built-in face have segments of a millimetre. Round values, not tuned.
  float piece_mm = 0.5f;
  int most_pieces = 8;
};
inline constexpr SurfacePointsTuning kSurfacePointsTuning{};

enum class PointKind : std::uint8_t { none, surface, curve, silhouette };

/// Inputs of a prediction.
struct PredictionInput {
  Cascade& cascade;
  const ExpectedState& expected;  ///< the covariance of the predictions follows from its pose variance
  const ModelState& state;
  const Projector& projector;  ///< of state.view
};

/// Ids, places and cached samples of the surface points, and their predictions in the pinhole image.
/// Ids are below the capacity; a removed id is used again. Bytes: about 100 a point, and 12 a sample.
class SurfacePoints {
 public:
  void lay_out(Arena& arena, std::size_t points, std::size_t silhouette_points,
               std::size_t samples_per_point);
  /// Removes all points. `samples_per_point` is what the cascade needs now. Precondition: at most that of `lay_out`.
  void clear(std::size_t samples_per_point);

  /// Adds a point under the lowest free id.
  /// \param along  of a curve point, the direction of the curve in (u,v), of any length but zero. Ignored otherwise.
  /// \return capacity; bad_argument for a null id, (u,v) outside the chart or a curve point without direction.
  Status add(PointKind kind, Vec2 uv, Vec2 along, Cascade& cascade, const float* q, std::uint16_t* id);
  /// Adds curve points along a polyline in (u,v), `spacing_mm` apart on the surface, the first after half of that.
  /// \param count  out: points added; with capacity, those for which there was room.
  Status add_curve(Span<const Vec2> polyline, float spacing_mm, Cascade& cascade, const float* q,
                   Span<std::uint16_t> ids, std::size_t* count);
  /// Moves a point to (u,v), where `sample_again` samples it.
  void slide_to(std::uint16_t id, Vec2 uv) { uv_[id] = uv; }
  /// After parameters that are not free have changed, and the model has turned: q becomes q * turn. The tangents
  /// turn with it.
  void sample_again(std::uint16_t id, Quat turn, Cascade& cascade, const float* q);
  void remove(std::uint16_t id);
  bool has(std::uint16_t id) const { return id < capacity_ && kind_[id] != PointKind::none; }
  PointKind kind(std::uint16_t id) const { return kind_[id]; }
  Vec2 uv(std::uint16_t id) const { return uv_[id]; }
  const Vec3* samples(std::uint16_t id) const { return samples_ + id * stride_; }
  /// Announces that the samples of a point are read soon. `id` may be that of no point.
  void announce(std::size_t id) const {
    if (id < capacity_) prefetch_samples(samples_ + id * stride_);
  }
  std::size_t capacity() const { return capacity_; }
  std::size_t silhouette_count() const { return silhouette_count_; }

  /// Computes the tangents of one point in `interval` at q.
  void update_tangents(Cascade& cascade, const float* q, std::uint32_t frame, std::uint32_t interval);
  /// Moves the silhouette points to the contour. Each point has its own sector of directions from the middle of the contour, so
  /// that it moves little from frame to frame. A point without contour in its sector gets a zero normal.
  void place_silhouette(Span<const SilhouettePoint> contour, Cascade& cascade, const float* q);

  /// Predicts one point in the pinhole image: all but `visible`.
  /// \param position  the point in the model's axes, mm.
  /// \return false behind the camera; then x is kBehind.
  bool predict(std::uint16_t id, const PredictionInput& input, Prediction* prediction, Vec3* position) const;
  /// True if a predicted point is turned to the camera; for a silhouette point, if it has a place.
  bool is_turned_to_camera(const Prediction& prediction) const;

  /// The point at q, mm, model axes, and its tangents of the last `update_tangents`; a silhouette point has none.
  SurfaceFrame frame(std::uint16_t id, Cascade& cascade, const float* q) const;

  /// Storage for predictions, capacity() of them.
  Prediction* predictions() { return predictions_; }

 private:
  void place(std::uint16_t id, Vec2 uv, Cascade& cascade, const float* q);
  void set_tangents(std::uint16_t id, const SurfaceFrame& frame);

  std::size_t capacity_ = 0, stride_ = 0, sample_capacity_ = 0;
  std::size_t silhouette_count_ = 0, silhouette_capacity_ = 0;
  PointKind* kind_ = nullptr;
  Vec2 *uv_ = nullptr,
       *along_ = nullptr;  // along: a curve's direction in (u,v), or a silhouette's image normal
  Vec3 *tangent_u_ = nullptr, *tangent_v_ = nullptr;  // in the model's axes, mm per unit of u and v
  Vec3* samples_ = nullptr;
  Prediction* predictions_ = nullptr;
};

}  // namespace pliant
