#pragma once
// What an Estimator owns, in its arena.
#include "estimate/frame_solver.hpp"
#include "estimate/lens_transfer.hpp"
#include "estimate/state_parts.hpp"
#include "estimate/track_monitor.hpp"
#include "estimate/visible_surface.hpp"
#include "pliant/estimator.hpp"

namespace pliant {

struct Estimator::Impl : StateParts {
  bool started = false;
  Camera camera;
  Lens lens;
  int width = 0, height = 0;
  std::uint32_t frame = 0;

  Cascade cascade;
  VisibleSurface surface;
  FrameSolver solver;
  const StretchPrior* stretch = nullptr;  // null without springs
  StretchRows* springs = nullptr;
  TrackMonitor monitor;

  Vec2 tau_before;  // at the beginning of the frame, or proposed: what `translate` is relative to
  Span<const Prediction> predictions;  // of all points at `state`; empty when either has changed
  std::size_t sample_capacity = 0;     // a point
  std::uint32_t tangent_interval = 1, vertex_interval = 1;  // frames
  Status (Cascade::*personalise)(const float* q) = nullptr;
  const MeshFollowing* mesh_following = nullptr;  // null: none is named, or no memory stays for it
  bool surface_is_trusted = false;  // all vertices are at the trusted parameters

  std::size_t parameter_count() const { return cascade.parameter_count(); }
  SolveInput solve_input() { return {cascade, points, motion.expected(), stretch, springs}; }
  Status choose_free(const std::uint8_t* is_free);
  void set_view(const Pose& pose);
  void set_state(const Pose& pose, const float* q);
  Status start_parts(const EstimatorOptions& options, bool keeps_mesh);
  MeshPolicy mesh_policy(const EstimatorOptions& options) const;
  void update_surface(std::uint32_t interval) {
    surface.update(cascade, state, frame, interval, interval <= 1);
    surface_is_trusted = false;
  }
  /// All vertices at the trusted parameters, which the state has, as exact as those of a good frame.
  void restore_surface() {
    if (surface_is_trusted)
      surface.turn_to(state.view);
    else
      surface.update(cascade, state, frame, 1, false);
    surface_is_trusted = true;
  }
  Status add(PointKind kind, Vec2 uv, Vec2 along, std::uint16_t* id);
  void note_new_point(std::uint16_t id);
  void note_new_view() {
    predictions = {};
    surface.invalidate_images();
  }
  void forget_person();
  Status revise(const float* q, Quat turn);
  /// Moves the state, but not the surface, to a saved one, which is expected then. \return as Estimator::restore.
  Status expect(const State& saved);
  /// Places the silhouette points at the present state. Null before there is one: a program that adds none does not link it.
  void (*place_silhouette)(Impl&) = nullptr;
  Prediction predict(std::uint16_t id, const Projector& projector);
  bool is_visible(const Prediction& p, Vec3 rotated) const;
};

}  // namespace pliant
