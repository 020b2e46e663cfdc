#include "estimate/surface_points.hpp"

#include "model/chart.hpp"

namespace pliant {

namespace {

/// Unit vector perpendicular to v, clockwise on the screen; zero for zero.
Vec2 perpendicular(Vec2 v) {
  const float size = length(v);
  return size > 0 ? Vec2{-v.y / size, v.x / size} : Vec2{};
}

/// A number from 0 to 4 that grows with the angle of v over a full turn. It needs no arc tangent.
float diamond_angle(Vec2 v) {
  const float size = magnitude(v.x) + magnitude(v.y);
  if (!(size > 0)) return 0;
  const float t = v.y / size;
  return v.x < 0 ? 2 - t : (v.y < 0 ? 4 + t : t);
}

Vec2 mean_position(Span<const SilhouettePoint> contour) {
  Vec2 sum{};
  for (const SilhouettePoint& p : contour) sum = sum + p.x;
  return (1.0f / static_cast<float>(contour.count)) * sum;
}

/// Pieces in which a segment of a curve is walked, since the surface is curved between its ends.
int pieces_of(float chord_mm) {
  constexpr int kMost = kSurfacePointsTuning.most_pieces;
  const float pieces = chord_mm / kSurfacePointsTuning.piece_mm;
  return pieces < static_cast<float>(kMost) ? 1 + static_cast<int>(pieces) : kMost;
}

}  // namespace

void SurfacePoints::lay_out(Arena& arena, std::size_t points, std::size_t silhouette_points,
                            std::size_t samples_per_point) {
  capacity_ = points;
  silhouette_capacity_ = silhouette_points;
  sample_capacity_ = samples_per_point;
  arena.count_as(Purpose::points);
  kind_ = arena.take<PointKind>(points);
  uv_ = arena.take<Vec2>(points);
  along_ = arena.take<Vec2>(points);
  tangent_u_ = arena.take<Vec3>(points);
  tangent_v_ = arena.take<Vec3>(points);
  predictions_ = arena.take<Prediction>(points);
  arena.count_as(Purpose::sampled_points);
  samples_ = arena.take<Vec3>(points * samples_per_point);
}

void SurfacePoints::clear(std::size_t samples_per_point) {
  PLIANT_ASSERT(samples_per_point <= sample_capacity_);
  stride_ = samples_per_point;
  silhouette_count_ = 0;
  for (std::size_t i = 0; i < capacity_; ++i) kind_[i] = PointKind::none;
}

Status SurfacePoints::add(PointKind kind, Vec2 uv, Vec2 along, Cascade& cascade, const float* q,
                          std::uint16_t* id) {
  PLIANT_ASSERT(kind != PointKind::none);
  const bool has_direction = is_finite(along) && dot(along, along) > 0;
  if (id == nullptr || !is_in_chart(uv) || (kind == PointKind::curve && !has_direction))
    return Status::bad_argument;
  if (kind == PointKind::silhouette && silhouette_count_ >= silhouette_capacity_) return Status::capacity;
  std::uint16_t i = 0;
  while (i < capacity_ && kind_[i] != PointKind::none) ++i;
  if (i == capacity_) return Status::capacity;
  *id = i;
  kind_[i] = kind;
  along_[i] = kind == PointKind::curve ? along : Vec2{};
  silhouette_count_ += kind == PointKind::silhouette;
  place(i, uv, cascade, q);
  if (kind != PointKind::silhouette) set_tangents(i, cascade.surface_frame(uv, q));
  return Status::ok;
}

Status SurfacePoints::add_curve(Span<const Vec2> polyline, float spacing_mm, Cascade& cascade, const float* q,
                                Span<std::uint16_t> ids, std::size_t* count) {
  PLIANT_ASSERT(polyline.count > 0 && spacing_mm > 0);
  *count = 0;
  float until_next = 0.5f * spacing_mm;
  cascade.select(q);  // and so does `add`
  Vec3 before = cascade.selected_point(polyline[0]);
  for (std::size_t k = 0; k + 1 < polyline.count; ++k) {
    const Vec2 along = polyline[k + 1] - polyline[k];
    const Vec3 end = cascade.selected_point(polyline[k + 1]);
    const int pieces = pieces_of(length(end - before));
    const Vec2 piece = (1.0f / static_cast<float>(pieces)) * along;
    for (int n = 0; n < pieces; ++n) {
      const Vec2 a = polyline[k] + static_cast<float>(n) * piece;
      const Vec3 here = n + 1 < pieces ? cascade.selected_point(a + piece) : end;
      const float size = length(here - before);
      before = here;
      for (; until_next < size; until_next += spacing_mm) {
        if (*count == ids.count) return Status::capacity;
        const Status status =
            add(PointKind::curve, a + (until_next / size) * piece, along, cascade, q, &ids[*count]);
        if (status != Status::ok) return status;
        ++*count;
      }
      until_next -= size;
    }
  }
  return Status::ok;
}

void SurfacePoints::sample_again(std::uint16_t id, Quat turn, Cascade& cascade, const float* q) {
  place(id, uv_[id], cascade, q);
  const Mat3 back = rotation_matrix(conjugate(in_model_axes(turn)));
  tangent_u_[id] = back * tangent_u_[id];
  tangent_v_[id] = back * tangent_v_[id];
}

void SurfacePoints::remove(std::uint16_t id) {
  if (!has(id)) return;
  silhouette_count_ -= kind_[id] == PointKind::silhouette;
  kind_[id] = PointKind::none;
}

void SurfacePoints::place(std::uint16_t id, Vec2 uv, Cascade& cascade, const float* q) {
  uv_[id] = uv;
  cascade.sample_point(uv, q, samples_ + id * stride_, kSurfacePointsTuning.sample_slack_mm);
}

void SurfacePoints::set_tangents(std::uint16_t id, const SurfaceFrame& frame) {
  tangent_u_[id] = frame.pu;
  tangent_v_[id] = frame.pv;
}

void SurfacePoints::update_tangents(Cascade& cascade, const float* q, std::uint32_t frame,
                                    std::uint32_t interval) {
  cascade.select(q, kSurfacePointsTuning.tangent_slack_mm);
  const auto has_tangents = [this](std::size_t i) {
    return i < capacity_ && kind_[i] != PointKind::none && kind_[i] != PointKind::silhouette;
  };
  for (std::uint16_t i = 0; i < capacity_; ++i) {
    if ((i + frame) % interval != 0 || !has_tangents(i)) continue;
    if (kHasVectors && has_tangents(i + interval)) cascade.announce(uv_[i + interval]);
    set_tangents(i, cascade.selected_frame(uv_[i]));
  }
}

void SurfacePoints::place_silhouette(Span<const SilhouettePoint> contour, Cascade& cascade, const float* q) {
  for (std::size_t i = 0; i < capacity_; ++i)
    if (kind_[i] == PointKind::silhouette) along_[i] = {};
  if (contour.empty()) return;
  const Vec2 middle = mean_position(contour);
  const float per_turn = 0.25f * static_cast<float>(silhouette_count_);
  std::size_t sector = 0;
  for (std::uint16_t i = 0; i < capacity_; ++i) {
    if (kind_[i] != PointKind::silhouette) continue;
    const float centre = static_cast<float>(sector++) + 0.5f;
    float nearest = 0.5f;
    const SilhouettePoint* best = nullptr;
    for (const SilhouettePoint& p : contour) {
      const float off = magnitude(per_turn * diamond_angle(p.x - middle) - centre);
      if (off >= nearest) continue;
      nearest = off;
      best = &p;
    }
    if (best == nullptr) continue;
    along_[i] = best->normal;
    place(i, best->uv, cascade, q);
  }
}

bool SurfacePoints::predict(std::uint16_t id, const PredictionInput& input, Prediction* prediction,
                            Vec3* position) const {
  PLIANT_ASSERT(has(id));
  Prediction out;
  out.id = id;
  const Vec3 p = input.cascade.evaluate(samples(id), input.state.q);
  Projector::Derivatives d;
  const bool is_in_front = input.projector.project(p, &out.x, &d);
  if (!is_in_front) {
    out.x = kBehind;
    *prediction = out;
    return false;
  }
  if (kind_[id] == PointKind::silhouette) {
    out.normal = along_[id];
  } else {
    const Vec2 along_u = d.along(tangent_u_[id]), along_v = d.along(tangent_v_[id]);
    out.jacobian = {along_u.x, along_v.x, along_u.y, along_v.y};
    const Vec3 normal = input.projector.rotated(cross(tangent_v_[id], tangent_u_[id])),
               ray = input.projector.to_camera(p);
    const float both = dot(normal, normal) * dot(ray, ray);
    out.facing = both > 0 ? -dot(normal, ray) / square_root(both) : 0.0f;
    if (kind_[id] == PointKind::curve) out.normal = perpendicular(out.jacobian * along_[id]);
  }
  for (int k = 0; k < kPoseUnknowns; ++k) {
    const float v = input.expected.pose_variance[k];
    out.covariance.xx += v * d.pose[k].x * d.pose[k].x;
    out.covariance.xy += v * d.pose[k].x * d.pose[k].y;
    out.covariance.yy += v * d.pose[k].y * d.pose[k].y;
  }
  *prediction = out;
  *position = p;
  return true;
}

SurfaceFrame SurfacePoints::frame(std::uint16_t id, Cascade& cascade, const float* q) const {
  PLIANT_ASSERT(has(id));
  const bool slides = kind_[id] == PointKind::silhouette;
  return {cascade.evaluate(samples(id), q), slides ? Vec3{} : tangent_u_[id], slides ? Vec3{} : tangent_v_[id]};
}

bool SurfacePoints::is_turned_to_camera(const Prediction& prediction) const {
  return kind_[prediction.id] == PointKind::silhouette
             ? dot(prediction.normal, prediction.normal) > 0
             : prediction.facing >= kSurfacePointsTuning.least_facing;
}

}  // namespace pliant
