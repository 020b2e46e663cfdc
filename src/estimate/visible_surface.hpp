#pragma once
// The model's surface as the camera sees it: an adaptive mesh, its posed vertices, and a depth buffer.
#include <cstdint>

#include "base/prefetch.hpp"
#include "estimate/model_state.hpp"
#include "pliant/adapt.hpp"
#include "pliant/cascade.hpp"
#include "pliant/criteria.hpp"
#include "pliant/mesh.hpp"
#include "pliant/silhouette.hpp"
#include "pliant/visibility.hpp"

namespace pliant {

/// Tuning of the visible surface. The experiments are those of docs/experiments.md, section Tuning: the rendered film
/// with 500 points for slacks and redrawing, the dropping jaw for the fast fraction.
struct VisibleSurfaceTuning {
  /// Cells a side of the depth buffer, count, for meshes up to `small_mesh` vertices and above. About two faces of a full
  /// mesh fall on a cell.
  int cells_small = 40, cells_large = 48, small_mesh = 512;
  /// mm. Depths are compared at this nominal distance of the model's origin: self-occlusion depends on the shape and turn of
  /// the model, and hardly on its distance, which the next solve changes. What is farther than this before the origin counts as
  /// being at `nearest_mm`: it hides what is behind it, but no other point there.
  float nominal_distance_mm = 1000, nearest_mm = 1;
  /// mm. Vectors that move a vertex by less are left out of its samples. A hundredth of the model's own error.
  float sample_slack_mm = 0.01f;
  /// mm. Vectors that move a vertex by less are left out where its position comes from the tables, and where a mesh is
  /// adapted. Several such vectors together still move it by less than hidden_margin_mm. Adapting the mesh of profile S at a start
  /// then takes 25 instead of 85 million instructions of a Cortex-M7, one of 1,900 vertices 113 instead of 178 of x86-64.
  float table_slack_mm = 0.5f;
  /// Fraction of hidden_margin_mm. If a vertex moved farther than this since its last update, all vertices are updated and
  /// depth is drawn again. Otherwise a fast jaw would be hidden by its old position. The rest of the margin covers the
  /// frames that share a drawing.
  float fast_fraction = 0.75f;
  /// Frames that one drawing of depth serves at most, count; and the turn (rad) and relative change of scale that it allows.
  /// Such a turn moves the silhouette by less than a cell.
  std::uint32_t drawing_frames = 3;
  float drawing_turn_rad = 0.03f, drawing_scale = 0.03f;
  /// Newton steps that take `surface_at` from the flat face onto the surface, count. Round value, not tuned.
  int newton_steps = 4;
  /// They end below this distance in the image, px; and leave the point where it was for a step of more than this in (u,v), or
  /// where the image of the chart's unit square is less than this, px^2. Round values, not tuned.
  float newton_near_px = 1e-3f, newton_most_step = 0.1f, newton_least_area_px2 = 1e-3f;
  /// A point that stays farther than this from where it should be seen, px, is not on the surface. Round value, not tuned.
  float newton_far_px = 0.5f;
  /// Largest error of an adapted mesh over its mean error. Round value, not tuned.
  float most_over_mean_error = 4;
  /// Points of the contour kept for each silhouette point, count. The contour of a fine mesh has many.
  std::size_t contour_points_per_point = 8;
  /// Frames in which all vertices are sampled again after the person has changed, count: as many as lie between two changes at
  /// least. A vertex takes 17,000 instructions.
  std::size_t renewal_frames = 8;
  /// One face and vertex in this many is ranked again in a frame while the mesh follows the view, count. Round value, not tuned.
  int rank_interval_frames = 32;
};
inline constexpr VisibleSurfaceTuning kVisibleSurfaceTuning{};

/// Of `count` vertices, those that a frame samples again.
constexpr std::size_t renewed_vertices(std::size_t count) {
  return (count + kVisibleSurfaceTuning.renewal_frames - 1) / kVisibleSurfaceTuning.renewal_frames;
}

/// Capacities of VisibleSurface.
struct VisibleSurfaceLimits {
  std::uint16_t vertices = 0;
  std::size_t samples_per_vertex = 0;  ///< kept for each vertex; 0: vertex positions are read from the tables
  std::uint16_t silhouette_points = 0;
  Span<unsigned char> adaptation_memory;  ///< as EstimatorLimits::adaptation_memory
};

/// Vertices move in turn: each in one of `interval` frames.
struct VertexTurn {
  std::uint32_t frame, interval;
  bool is_of(VertexId v) const { return interval <= 1 || (v + frame) % interval == 0; }
};

class VisibleSurface;

/// Functions of a mesh that follows the view. They are called through this table only, so that a program whose limits name no table
/// does not link what is behind it: the criteria of view and texture, and the ranking of a mesh once more.
struct MeshFollowing {
  /// As MeshPolicy has it.
  Criterion (VisibleSurface::*criterion)();
  void (VisibleSurface::*follow)(Cascade& cascade, const ModelState& state, std::uint32_t frame);
};

/// How VisibleSurface adapts its mesh.
struct MeshPolicy {
  float error_mm = 0.3f;            ///< mean error of the mesh at the start
  const MeshFollowing* following = nullptr;  ///< null: the mesh stays
  std::uint16_t operations = 0;              ///< splits and welds a frame, at most
  std::uint16_t vertex_budget = 0;           ///< while it follows; 0: the capacity
  ViewOptions view;                          ///< the view criterion
  TextureOptions texture;           ///< the texture criterion, if its score is not null
};

/// Mesh, posed vertices and depth buffer.
///
/// The positions of vertices follow the expression a few at a time (`update`), since visibility tolerates millimetres. The
/// images are those of the pinhole. The depth buffer is drawn on demand and reused while the view is nearly the same.
class VisibleSurface {
 public:
  void lay_out(Arena& arena, std::size_t parameters, const VisibleSurfaceLimits& limits);

  /// Starts from the model's base mesh. \return the statuses of Mesh::set_base.
  Status start(const Model& model);
  /// Adapts the mesh to the surface at `state`, once, and moves its vertices there. `cascade` must stay.
  /// \param keeps_vertices  those that have samples are near the surface: some move there now, and some in each call of `update`.
  void adapt(Cascade& cascade, const ModelState& state, const MeshPolicy& policy,
             bool keeps_vertices = false);
  /// If the policy follows the view, makes at most policy.operations splits and welds for that of `state`. The surface is that of
  /// `adapt`, so that ranks of different frames are comparable.
  void follow_view(Cascade& cascade, const ModelState& state, std::uint32_t frame) {
    if (policy_.following != nullptr) (this->*policy_.following->follow)(cascade, state, frame);
  }

  /// Parameters that are not free have changed to those in q, and the model has turned: q becomes q * turn. The vertices turn
  /// with it at once. Their samples are out of date: `update` renews some in each call, and moves the others no more before that.
  void revise(const float* q, Quat turn);
  /// Moves one vertex in `interval` to the surface at `state` and projects all. \param is_exact  with interval 1: all are on the
  /// surface afterwards, to the last digit.
  void update(Cascade& cascade, const ModelState& state, std::uint32_t frame, std::uint32_t interval,
              bool is_exact);
  /// Projects all vertices, which stay where they are on the surface.
  void turn_to(const View& view);
  /// To be called when the view has changed: images are projected again when they are needed.
  void invalidate_images() { images_are_current_ = false; }

  /// Brings the depth buffer up to date with `view`. `frame` counts frames.
  void draw_depth(const View& view, std::uint32_t frame);
  /// True if the surface hides the point with image position x (px, pinhole) and position `rotated` (mm, camera axes, from the
  /// model's origin). Precondition: draw_depth.
  bool hides(Vec2 x, Vec3 rotated) const;
  /// The apparent contour at `view`, without the open boundary of the mesh. Valid until the next call.
  Span<const SilhouettePoint> find_contour(const View& view, std::uint32_t frame);
  /// (u,v) of the visible surface under an image position (px, pinhole), or of the nearest visible point.
  /// \return their distance in the image, px; 0 on the surface; negative when nothing is visible.
  float surface_at(Cascade& cascade, const ModelState& state, Vec2 x, Vec2* uv);
  /// Moves `uv`, of the mesh under x (px, pinhole), onto the surface by Newton's method, as the mesh is flat between its
  /// vertices. Unchanged where that does not converge. \return how far from x the surface at `uv` is then seen, px.
  static float refine_uv(Cascade& cascade, const ModelState& state, Vec2 x, Vec2* uv);

  const Mesh& mesh() const { return mesh_; }
  const Vec3* positions() const { return position_; }
  const Vec2* images() const { return image_; }

  // Those of MeshFollowing.
  Criterion view_criterion();
  void adapt_to_view(Cascade& cascade, const ModelState& state, std::uint32_t frame);

 private:
  bool keeps_samples() const { return samples_per_vertex_ > 0; }
  Vec3* samples_of(VertexId v) { return samples_ + v * samples_per_vertex_; }
  void select_surface(Cascade& cascade) const;
  void forget_unused_samples();
  void place_vertex(Cascade& cascade, const float* q, VertexId v);
  float move_vertices(Cascade& cascade, const float* q, VertexTurn turn, bool others);
  void renew_vertices(Cascade& cascade, const float* q, std::size_t most);
  void project(const View& view);
  float nearest_on_mesh(Vec2 x, Vec2* uv) const;

  Mesh mesh_;
  Adapter adapter_;
  ContourOptions contour_criterion_;
  MeshPolicy policy_;
  EitherOf view_and_texture_;
  float* surface_q_ = nullptr;  // parameters of the surface that the mesh is adapted to
  std::size_t parameters_ = 0, samples_per_vertex_ = 0;
  Vec3* samples_ = nullptr;
  Vec2* uv_ = nullptr;  // where each vertex was placed: ids are used again
  Vec3* position_ = nullptr;
  Vec2* image_ = nullptr;
  float* depth_ = nullptr;
  bool has_new_surface_ = false;     // which the adapter has not sampled
  VertexId first_outdated_ = kNone;  // of those whose samples are of another person; the others follow it
  bool images_are_current_ = false, depth_is_drawn_ = false;
  DepthBuffer depth_buffer_;
  View drawn_view_;
  std::uint32_t drawn_frame_ = 0;
  SilhouetteFinder finder_;
  Span<SilhouettePoint> contour_;
};

}  // namespace pliant
