// The estimator's surface points: patches and markers where they are put, edges along curves of the model, and points that
// slide along the outline; and where each is expected in the image.
#include "estimate/estimator_depth.hpp"
#include "estimate/estimator_problem.hpp"

namespace pliant {

namespace {

bool is_in_chart(Vec2 uv) {
  return uv.x >= 0 && uv.x <= 1 && uv.y >= 0 && uv.y <= 1;
}

/// Unit vector a quarter turn on from v; zero for zero.
Vec2 across(Vec2 v) {
  const float size = length(v);
  return size > 0 ? Vec2{-v.y / size, v.x / size} : Vec2{};
}

/// Grows with the angle of v, from 0 to 4 over a full turn: no arc tangent needed.
float diamond_angle(Vec2 v) {
  const float size = magnitude(v.x) + magnitude(v.y);
  if (!(size > 0)) return 0;
  const float t = v.y / size;
  return v.x < 0 ? 2 - t : (v.y < 0 ? 4 + t : t);
}

}  // namespace

Status Estimator::take_id(PointKind kind, std::uint16_t* id) {
  if (!started_) return Status::not_started;
  if (id == nullptr) return Status::bad_argument;
  std::uint16_t i = 0;
  while (i < limits_.points && kind_[i] != PointKind::none) ++i;
  if (i == limits_.points) return Status::capacity;
  kind_[i] = kind;
  along_[i] = {};
  was_rejected_[i] = 0;
  *id = i;
  return Status::ok;
}

/// Puts a point there.
void Estimator::place(std::uint16_t id, Vec2 uv) {
  predicted_view_.s = 0;
  uv_[id] = uv;
  cascade_.sample_point(uv, q_, samples_of_point(id), kSampleSlackMm);
}

Status Estimator::add_point(Vec2 uv, std::uint16_t* id) {
  if (started_ && !is_in_chart(uv)) return Status::bad_argument;
  const Status status = take_id(PointKind::surface, id);
  if (status != Status::ok) return status;
  place(*id, uv);
  cascade_.select(q_);
  update_tangents(*id);
  return Status::ok;
}

Status Estimator::add_edge_point(Vec2 uv, Vec2 along, std::uint16_t* id) {
  if (started_ && !(is_in_chart(uv) && is_finite(along) && dot(along, along) > 0))
    return Status::bad_argument;
  const Status status = take_id(PointKind::curve, id);
  if (status != Status::ok) return status;
  along_[*id] = along;
  place(*id, uv);
  cascade_.select(q_);
  update_tangents(*id);
  return Status::ok;
}

Status Estimator::add_curve(std::size_t curve, float spacing_mm, Span<std::uint16_t> ids,
                            std::size_t* count) {
  constexpr std::uint32_t kPieces = 8;  // of a segment: between its ends the surface is not straight
  if (!started_) return Status::not_started;
  if (count == nullptr || curve >= model().curves().count || !(spacing_mm > 0)) return Status::bad_argument;
  *count = 0;
  const Curve& c = model().curves()[curve];
  const Vec2* points = &model().curve_points()[c.first_point];
  float until_next = 0.5f * spacing_mm;
  Vec3 before = cascade_.surface_point(points[0], q_);
  for (std::uint32_t k = 1; k < kPieces * (c.point_count - 1) + 1; ++k) {
    const Vec2 along = points[(k - 1) / kPieces + 1] - points[(k - 1) / kPieces];
    const Vec2 piece = (1.0f / kPieces) * along;
    const Vec2 a = points[(k - 1) / kPieces] + static_cast<float>((k - 1) % kPieces) * piece;
    const Vec3 here = cascade_.surface_point(a + piece, q_);
    const float size = length(here - before);
    before = here;
    for (; until_next < size; until_next += spacing_mm) {
      if (*count == ids.count) return Status::capacity;
      const Status status = add_edge_point(a + (until_next / size) * piece, along, &ids[*count]);
      if (status != Status::ok) return status;
      ++*count;
    }
    until_next -= size;
  }
  return Status::ok;
}

Status Estimator::add_silhouette_point(std::uint16_t* id) {
  std::size_t there = 0;
  for (std::size_t i = 0; i < limits_.points; ++i) there += kind_[i] == PointKind::silhouette;
  if (started_ && there >= limits_.silhouette_points) return Status::capacity;
  const Status status = take_id(PointKind::silhouette, id);
  if (status == Status::ok) place(*id, {0.5f, 0.5f});
  return status;
}

void Estimator::remove_point(std::uint16_t id) {
  if (id < limits_.points) kind_[id] = PointKind::none;
}

/// Gives each outline point its own sector of the apparent contour as seen from its middle, so that it stays about where
/// it is from frame to frame; one whose sector has none of the contour gets no normal, and is not visible.
void Estimator::place_silhouette() {
  std::size_t sectors = 0;
  for (std::size_t i = 0; i < limits_.points; ++i)
    if (kind_[i] == PointKind::silhouette) {
      along_[i] = {};
      ++sectors;
    }
  if (sectors == 0) return;
  draw_depth();
  if (!vertices_are_current_) project_vertices();
  const Projector projector(view_, true);
  const std::size_t all = finder_.find({mesh_, vertex_, vertex_image_, vertex_depth_}, projector, &depth_,
                                       kHiddenMarginMm, {silhouette_, silhouette_count_});
  std::size_t found = 0;
  Vec2 sum{};
  for (std::size_t k = 0; k < (all < silhouette_count_ ? all : silhouette_count_); ++k) {
    if (silhouette_[k].is_border) continue;  // where the mesh ends there need not be an edge
    sum = sum + silhouette_[k].x;
    silhouette_[found++] = silhouette_[k];
  }
  if (found == 0) return;
  const Vec2 middle = (1.0f / static_cast<float>(found)) * sum;
  const float per_turn = 0.25f * static_cast<float>(sectors);
  std::size_t sector = 0;
  for (std::uint16_t i = 0; i < limits_.points; ++i) {
    if (kind_[i] != PointKind::silhouette) continue;
    const float centre = static_cast<float>(sector++) + 0.5f;
    float nearest = 0.5f;
    const SilhouettePoint* best = nullptr;
    for (std::size_t k = 0; k < found; ++k) {
      const float off = magnitude(per_turn * diamond_angle(silhouette_[k].x - middle) - centre);
      if (off >= nearest) continue;
      nearest = off;
      best = &silhouette_[k];
    }
    if (best == nullptr) continue;
    along_[i] = best->normal;
    place(i, best->uv);
  }
}

/// At the parameters that the cascade has selected.
void Estimator::update_tangents(std::uint16_t id) {
  if (kind_[id] == PointKind::silhouette) return;
  const SurfaceFrame frame = cascade_.selected_frame(uv_[id]);
  tangent_u_[id] = frame.pu;
  tangent_v_[id] = frame.pv;
}

Prediction Estimator::prediction(std::uint16_t id, const Projector& projector) {
  Prediction out;
  out.id = id;
  const Vec3 p = cascade_.evaluate(samples_of_point(id), q_);
  Projector::Derivatives d;
  if (!projector.project(p, &out.x, &d)) {
    out.x = kBehind;
    return out;
  }
  if (kind_[id] == PointKind::silhouette) {
    out.normal = along_[id];
  } else {
    const Vec2 along_u = d.along(tangent_u_[id]), along_v = d.along(tangent_v_[id]);
    out.jacobian = {along_u.x, along_v.x, along_u.y, along_v.y};
    const Vec3 normal = projector.rotated(cross(tangent_v_[id], tangent_u_[id])),
               sight = projector.to_camera(p);
    const float both = dot(normal, normal) * dot(sight, sight);
    out.facing = both > 0 ? -dot(normal, sight) / square_root(both) : 0.0f;
    if (kind_[id] == PointKind::curve) out.normal = across(out.jacobian * along_[id]);
  }
  for (int k = 0; k < kPoseUnknowns; ++k) {
    const float v = pose_variance_[k];
    out.covariance.xx += v * d.pose[k].x * d.pose[k].x;
    out.covariance.xy += v * d.pose[k].x * d.pose[k].y;
    out.covariance.yy += v * d.pose[k].y * d.pose[k].y;
  }
  const Vec2 seen = lens_.distort(out.x);
  const bool inside = seen.x >= 0 && seen.y >= 0 && seen.x <= static_cast<float>(width_ - 1) &&
                      seen.y <= static_cast<float>(height_ - 1);
  if (kind_[id] == PointKind::silhouette)  // the finder has left out what is hidden
    out.visible = inside && dot(out.normal, out.normal) > 0;
  else
    out.visible = inside && out.facing >= options_.min_facing &&
                  !depth_.hides(out.x, kNominalDepthMm + projector.rotated(p).z, kHiddenMarginMm);
  if (!lens_.is_none()) see_through_lens(&out);
  return out;
}

Span<const Prediction> Estimator::predict() {
  draw_depth();
  const Projector projector(view_, true);
  std::size_t n = 0;
  for (std::uint16_t i = 0; i < limits_.points; ++i) {
    if (kind_[i] == PointKind::none) continue;
    predictions_[n] = prediction(i, projector);
    ++n;
  }
  prediction_count_ = n;
  predicted_view_ = view_;
  for (std::size_t i = 0; i < cascade_.parameter_count(); ++i) predicted_q_[i] = q_[i];
  return {predictions_, n};
}

/// Whether `predictions_` are of the state as it is, through the pinhole.
bool Estimator::is_predicted() const {
  if (!lens_.is_none()) return false;
  const View &a = view_, &b = predicted_view_;
  bool same = a.q.w == b.q.w && a.q.x == b.q.x && a.q.y == b.q.y && a.q.z == b.q.z && a.s == b.s &&
              a.tau.x == b.tau.x && a.tau.y == b.tau.y && a.rho == b.rho;
  for (std::size_t i = 0; same && i < cascade_.parameter_count(); ++i) same = predicted_q_[i] == q_[i];
  return same;
}

Prediction Estimator::predict(std::uint16_t id) {
  draw_depth();
  return prediction(id, Projector(view_, true));
}

}  // namespace pliant
