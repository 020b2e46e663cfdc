// Criteria for tracking, which the paper leaves to future work: contour error in the image, and texture
// (docs/algorithms.md, sections 2.4 and 2.5).
#include "mesh/mesh_tuning.hpp"
#include "mesh/triangle_samples.hpp"
#include "pliant/criteria.hpp"

namespace pliant {
namespace {

Vec3 to_camera(const Mat3& r, Vec3 t, Vec3 p) {
  return r * Vec3{p.x, -p.y, -p.z} + t;
}

// (u,v) of a sample.
Vec2 sample_uv(const Shape& s, const Triangle& t, const float (&w)[3]) {
  return w[0] * s.mesh.uv(t.corner[0]) + w[1] * s.mesh.uv(t.corner[1]) + w[2] * s.mesh.uv(t.corner[2]);
}

// The sides of the picture, a bit each, beyond which p is seen. All of a triangle is outside where its corners share a side:
// multiplied by the depth, each limit is a plane through the camera, so that this holds for corners behind the camera too.
int sides_beyond(const ViewOptions& o, Vec3 p) {
  const Vec2 half{0.5f * o.width_px, 0.5f * o.height_px};
  const Vec2 from_middle{o.focal_px * p.x + (o.cx - half.x) * p.z, o.focal_px * p.y + (o.cy - half.y) * p.z};
  const Vec2 limit = p.z * (half + Vec2{kViewTuning.margin_px, kViewTuning.margin_px});
  return (from_middle.x < -limit.x) | (from_middle.x > limit.x) << 1 | (from_middle.y < -limit.y) << 2 |
         (from_middle.y > limit.y) << 3;
}

}  // namespace

float compute_rank(const ViewOptions& o, const Shape& s, const Triangle& t) {
  const Mat3 r = rotation_matrix(o.pose.q);
  Vec3 c[3];
  int outside = 15;
  for (int k = 0; k < 3; ++k) {
    c[k] = to_camera(r, o.pose.t, s.position[t.corner[k]]);
    outside &= sides_beyond(o, c[k]);
  }
  const float nearest = kViewTuning.nearest_fraction * length(o.pose.t);

  // diag(1,-1,-1) is a half turn about x: faces keep their winding in camera coordinates.
  const Vec3 normal = cross(c[1] - c[0], c[2] - c[0]), middle = (1.0f / 3) * (c[0] + c[1] + c[2]);
  const float size = length(normal) * length(middle), facing = size > 0 ? -dot(normal, middle) / size : 0;
  const float gain = outside != 0 || facing < -kViewTuning.silhouette_cosine ? o.hidden_gain
                     : facing < kViewTuning.silhouette_cosine                ? o.silhouette_gain
                                                                             : 1.0f;

  float worst = 0;
  for (const auto& w : kTriangleSamples) {
    const Vec3 p = to_camera(r, o.pose.t, s.surface(sample_uv(s, t, w)));
    if (!(p.z > nearest)) continue;
    const Vec3 e = p - (w[0] * c[0] + w[1] * c[1] + w[2] * c[2]);
    const float along = dot(e, p) / length(p);
    worst = max(worst, o.focal_px / p.z * square_root(dot(e, e) - along * along));
  }
  return o.tolerance_px > 0 ? gain * worst / o.tolerance_px : 0;
}

Criterion criterion_of(const ViewOptions& options) {
  return criterion_of<ViewOptions, compute_rank>(options);
}

float compute_rank(const TextureOptions& o, const Shape& s, const Triangle& t) {
  const float edge = length(s.position[t.corner[1]] - s.position[t.corner[0]]);
  if (o.score == nullptr || !(o.shortest_edge_mm > 0) || edge < 2 * o.shortest_edge_mm) return 0;
  float best = 0;
  for (const auto& w : kTriangleSamples) best = max(best, o.score(o.context, sample_uv(s, t, w)));
  const float sizes = edge / (2 * o.shortest_edge_mm);
  return best * sizes * sizes;
}

Criterion criterion_of(const TextureOptions& options) {
  return criterion_of<TextureOptions, compute_rank>(options);
}

}  // namespace pliant
