#pragma once
/// \file mesh_tracker.hpp
/// Tracks an experiment with what one mesh gives: patches at its vertices, markers carried by its flat triangles.
#include <memory>

#include "adapted_mesh.hpp"
#include "experiment.hpp"
#include "pliant/estimator.hpp"
#include "pliant/patch_tracker.hpp"
#include "pliant/pyramid.hpp"

namespace pliant::figure9 {

struct Outcome {
  double error_px = 0;  ///< mean distance of the markers seen
  TrackState state = TrackState::tracking;
  double milliseconds = 0;
  int vertices = 0;  ///< of the mesh
};

/// Every vertex that frame 0 shows, with texture around it and no marker near, has a template of that frame. With anchors,
/// corners of frame 0 are tracked too, on the surface itself. Twice a frame: predict, match, solve.
class MeshTracker {
 public:
  MeshTracker(const Model& model, const Experiment& experiment, const MeshSetting& setting, bool has_anchors);

  /// Frames in order, from 1.
  Outcome update(std::size_t frame);
  int vertices() const { return mesh_->mesh().vertex_count(); }
  /// Patches there are.
  int tracked() const;

 private:
  struct Tracked {
    bool is_used = false;
    Vec2 uv;
    std::uint16_t id = 0;
    Mat2 reference;
  };
  struct Marker {
    Vec2 uv;
    bool is_on_mesh = false;
    FaceId face = 0;
  };
  struct SeenPoint {
    Vec2 x;
    Mat2 jacobian;
    float facing = -1;
  };

  SeenPoint seen_in_frame_0(Vec2 uv);
  void score_chart();
  void cast_markers();
  void track_vertices();
  void track_corners();
  void track(std::size_t slot, Vec2 uv);
  void drop(std::size_t slot);
  bool is_near_marker(Vec2 x) const;
  void expect_motion();
  void match_and_solve(int round);
  Observation match(std::size_t slot, const Prediction& p, int round);
  bool find_face(Marker& marker) const;
  bool project_marker(Marker& marker, Vec2* x);
  double marker_error(std::size_t frame);

  const Experiment& experiment_;
  ChartScore score_;
  host::Owned<Cascade> cascade_;
  host::Owned<Estimator> estimator_;
  host::Owned<Pyramid> first_, current_, previous_;
  host::Owned<PatchTracker> patches_;
  std::unique_ptr<AdaptedMesh> mesh_;
  std::vector<Tracked> tracked_;
  std::vector<std::size_t> slot_of_;  // of a surface point
  std::vector<Marker> markers_;
  std::vector<Observation> observations_;
  FrameResult result_;
};

}  // namespace pliant::figure9
