#include "mesh_tracker.hpp"

#include <algorithm>
#include <chrono>

#include "host/bench/klt.hpp"
#include "pliant/coarse_translation.hpp"
#include "pliant/visibility.hpp"

namespace pliant::figure9 {

namespace {

/// A slot of each vertex that a mesh may have; those of the anchors come after them.
constexpr std::uint16_t kVertexSlots = kMostVertices, kAnchors = 128;
constexpr float kMarkerExclusionPx = 8, kMinFacing = 0.3f;

FrameView view_of_image(const host::Image& image, double time_s) {
  FrameView view = host::frame_of(image);
  view.time_ns = static_cast<std::int64_t>(time_s * 1e9);
  return view;
}

EstimatorLimits estimator_limits() {
  EstimatorLimits limits;
  limits.points = kVertexSlots + kAnchors;
  return limits;
}

PatchLimits patch_limits() {
  PatchLimits limits;
  limits.slots = kVertexSlots + kAnchors;
  limits.window = 11;
  return limits;
}

PyramidLimits pyramid_limits(const Experiment& e) {
  PyramidLimits limits;
  limits.width = e.frames[0].width;
  limits.height = e.frames[0].height;
  return limits;
}

}  // namespace

MeshTracker::MeshTracker(const Model& model, const Experiment& experiment, const MeshSetting& setting,
                         bool has_anchors)
    : experiment_(experiment),
      cascade_(model),
      estimator_(model, estimator_limits()),
      first_(pyramid_limits(experiment)),
      current_(pyramid_limits(experiment)),
      previous_(pyramid_limits(experiment)),
      patches_(patch_limits()),
      tracked_(kVertexSlots + kAnchors),
      slot_of_(kVertexSlots + kAnchors) {
  const Experiment& e = experiment_;
  const FrameView frame = view_of_image(e.frames[0], 0);
  host::require(first_->build(frame), "frame 0");
  host::require(current_->build(frame), "frame 0");
  host::require(estimator_->start(e.camera, frame.width, frame.height, e.pose, e.q.data(), nullptr, {}),
                "start");
  score_chart();
  mesh_ = std::make_unique<AdaptedMesh>(model, e.q, setting, e.pose, score_);
  cast_markers();
  track_vertices();
  if (has_anchors) track_corners();
}

int MeshTracker::tracked() const {
  return static_cast<int>(
      std::count_if(tracked_.begin(), tracked_.end(), [](const Tracked& f) { return f.is_used; }));
}

MeshTracker::SeenPoint MeshTracker::seen_in_frame_0(Vec2 uv) {
  const Projector projector(view_of(experiment_.pose, experiment_.camera), true);
  const SurfaceFrame frame = cascade_->surface_frame(uv, experiment_.q.data());
  SeenPoint seen;
  Projector::Derivatives d;
  if (!projector.project(frame.p, &seen.x, &d)) return seen;
  const Vec2 along_u = d.along(frame.pu), along_v = d.along(frame.pv);
  seen.jacobian = {along_u.x, along_v.x, along_u.y, along_v.y};
  const Vec3 normal = projector.rotated(normalised(cross(frame.pv, frame.pu)));
  seen.facing = -dot(normal, normalised(projector.to_camera(frame.p)));
  return seen;
}

void MeshTracker::score_chart() {
  constexpr int n = ChartScore::kCells;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const Vec2 uv{(static_cast<float>(i) + 0.5f) / n, (static_cast<float>(j) + 0.5f) / n};
      const SeenPoint seen = seen_in_frame_0(uv);
      if (seen.facing >= kMinFacing) score_.set(uv, corner_score(first_->level(0), seen.x));
    }
  score_.normalise();
}

/// As the paper: a marker is put on the mesh, into the flat triangle under it.
void MeshTracker::cast_markers() {
  const Mesh& mesh = mesh_->mesh();
  const Projector projector(view_of(experiment_.pose, experiment_.camera), true);
  std::vector<Vec2> image(kMostVertices);
  for (VertexId v : mesh.vertices())
    projector.project(cascade_->surface_point(mesh.uv(v), experiment_.q.data()), &image[v]);
  for (const std::optional<Vec2>& x : experiment_.truth[0]) {
    Marker marker;
    float best = 1e30f;
    for (FaceId f : mesh.faces()) {
      if (!x || !faces_camera(mesh, image.data(), f)) continue;
      float w[3];
      const VertexId a = mesh.corner(f, 0), b = mesh.corner(f, 1), c = mesh.corner(f, 2);
      const float d2 = nearest_on_triangle(image[a], image[b], image[c], *x, w);
      if (d2 >= best) continue;
      best = d2;
      marker.is_on_mesh = true;
      marker.face = f;
      marker.uv = w[0] * mesh.uv(a) + (w[1] * mesh.uv(b) + w[2] * mesh.uv(c));
    }
    markers_.push_back(marker);
  }
}

bool MeshTracker::is_near_marker(Vec2 x) const {
  for (const std::optional<Vec2>& m : experiment_.truth[0])
    if (m && length(*m - x) < kMarkerExclusionPx) return true;
  return false;
}

/// Brings the tracked vertices into line with the mesh.
void MeshTracker::track_vertices() {
  const Mesh& mesh = mesh_->mesh();
  for (std::size_t slot = 0; slot < kVertexSlots; ++slot) {
    const auto v = static_cast<VertexId>(slot);
    const bool is_live = mesh.is_live_vertex(v);
    Tracked& f = tracked_[slot];
    if (f.is_used && (!is_live || mesh.uv(v).x != f.uv.x || mesh.uv(v).y != f.uv.y)) drop(slot);
    if (is_live && !f.is_used) track(slot, mesh.uv(v));
  }
}

void MeshTracker::track_corners() {
  CornerOptions options;
  options.min_score = 1;
  options.quality = 0;
  options.min_ratio = 0.02f;
  options.min_distance_px = 5;
  std::size_t slot = kVertexSlots;
  for (const Vec2 x : host::best_corners(first_->level(0), 2000, options)) {
    if (slot == tracked_.size()) break;
    Vec2 uv;
    if (estimator_->surface_at(x, &uv) != 0) continue;
    track(slot, uv);
    slot += tracked_[slot].is_used;
  }
}

void MeshTracker::track(std::size_t slot, Vec2 uv) {
  if (!estimator_->model().is_on_surface(uv)) return;
  std::uint16_t id = 0;
  if (estimator_->add_point(uv, &id) != Status::ok) return;
  const SeenPoint seen = seen_in_frame_0(uv);
  // A vertex that frame 0 does not show is not tracked: a template of a later frame would hold on to that frame's error.
  if (seen.facing < kMinFacing || is_near_marker(seen.x) ||
      patches_->capture(static_cast<int>(slot), *first_, seen.x) != PatchStatus::ok) {
    estimator_->remove_point(id);
    return;
  }
  tracked_[slot] = {true, uv, id, seen.jacobian};
  slot_of_[id] = slot;
}

void MeshTracker::drop(std::size_t slot) {
  estimator_->remove_point(tracked_[slot].id);
  patches_->release(static_cast<int>(slot));
  tracked_[slot].is_used = false;
}

Outcome MeshTracker::update(std::size_t frame) {
  const double t = static_cast<double>(frame) / experiment_.frames_per_second;
  const auto start = std::chrono::steady_clock::now();
  current_->swap(*previous_);
  host::require(current_->build(view_of_image(experiment_.frames[frame], t)), "frame");
  estimator_->begin(static_cast<std::int64_t>(t * 1e9));
  expect_motion();
  for (int round = 0; round < 2; ++round) match_and_solve(round);
  result_ = estimator_->end();
  if (result_.state == TrackState::tracking && mesh_->update(result_.pose, static_cast<int>(frame)))
    track_vertices();
  Outcome out;
  out.milliseconds =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  out.state = result_.state;
  out.vertices = vertices();
  out.error_px = marker_error(frame);
  return out;
}

/// Moves the prediction by what the smallest pictures show, as the tracker does.
void MeshTracker::expect_motion() {
  const int top = current_->levels() - 1;
  const auto grow = static_cast<float>(1 << top);
  Vec2 low{1e9f, 1e9f}, high{-1e9f, -1e9f};
  for (VertexId v : estimator_->mesh().vertices()) {
    const Vec2 x = estimator_->vertex_images()[v];
    low = min(low, x);
    high = max(high, x);
  }
  const auto pixel = [grow](float x) { return static_cast<int>(x / grow); };
  const CoarseTranslation shift = find_coarse_translation(
      previous_->level(top), {pixel(low.x), pixel(low.y), pixel(high.x) + 1, pixel(high.y) + 1},
      current_->level(top), current_->level(top).width / 10);
  if (shift.correlation >= 0.5f) estimator_->translate(grow * shift.by);
}

void MeshTracker::match_and_solve(int round) {
  observations_.clear();
  for (const Prediction& p : estimator_->predict()) observations_.push_back(match(slot_of_[p.id], p, round));
  estimator_->solve({observations_.data(), observations_.size()});
}

Observation MeshTracker::match(std::size_t slot, const Prediction& p, int round) {
  Observation o;
  o.id = p.id;
  o.reason = Reason::not_visible;
  if (!p.visible) return o;
  PatchOptions options;
  options.min_correlation = round == 0 ? 0.45f : 0.55f;
  options.first_level = round == 0 ? -1 : 0;
  options.max_move_px = (round == 0 ? 16.0f : 3.0f) * static_cast<float>(experiment_.frames[0].width) / 320;
  const Mat2 warp = p.jacobian * inverse(tracked_[slot].reference);
  const PatchResult found = patches_->track(static_cast<int>(slot), *current_, p.x, warp, options);
  o.reason = found.status == PatchStatus::ok ? Reason::found : Reason::low_correlation;
  o.x = found.x;
  o.information = found.information;
  o.score = found.correlation;
  return o;
}

/// The face of the mesh that holds the marker's (u,v): the last one, or another after the mesh has changed.
bool MeshTracker::find_face(Marker& marker) const {
  const Mesh& mesh = mesh_->mesh();
  const auto distance = [&](FaceId f) {
    float w[3];
    return nearest_on_triangle(mesh.uv(mesh.corner(f, 0)), mesh.uv(mesh.corner(f, 1)),
                               mesh.uv(mesh.corner(f, 2)), marker.uv, w);
  };
  constexpr float kInside = 1e-12f;
  if (mesh.is_live_face(marker.face) && distance(marker.face) <= kInside) return true;
  float best = 1e30f;
  for (FaceId f : mesh.faces()) {
    const float d2 = distance(f);
    if (d2 >= best) continue;
    best = d2;
    marker.face = f;
  }
  return best < 1e-6f;
}

bool MeshTracker::project_marker(Marker& marker, Vec2* x) {
  if (!marker.is_on_mesh || !find_face(marker)) return false;
  const Mesh& mesh = mesh_->mesh();
  Vec2 uv[3];
  Vec3 corner[3];
  for (int k = 0; k < 3; ++k) {
    uv[k] = mesh.uv(mesh.corner(marker.face, k));
    corner[k] = cascade_->surface_point(uv[k], estimator_->parameters().data);
  }
  float w[3];
  nearest_on_triangle(uv[0], uv[1], uv[2], marker.uv, w);
  const Vec3 p = w[0] * corner[0] + (w[1] * corner[1] + w[2] * corner[2]);
  return Projector(estimator_->view(), true).project(p, x);
}

double MeshTracker::marker_error(std::size_t frame) {
  double sum = 0;
  int count = 0;
  for (std::size_t m = 0; m < markers_.size(); ++m) {
    Vec2 x;
    if (!experiment_.truth[frame][m] || !project_marker(markers_[m], &x)) continue;
    sum += static_cast<double>(length(x - *experiment_.truth[frame][m]));
    ++count;
  }
  return count > 0 ? sum / count : 0;
}

}  // namespace pliant::figure9
