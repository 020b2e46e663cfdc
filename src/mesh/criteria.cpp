// Criteria that need the mesh only: the application's own tests, unconditional, normals (the paper, 5.2.1, 5.2.2), and
// combinations. Those that sample the surface are in criteria_contour.cpp and criteria_view.cpp.
#include "pliant/criteria.hpp"

#include "pliant/mesh_star.hpp"

namespace pliant {

// --- Tests ---

Criterion criterion_of(const AdaptTests& tests) {
  Criterion c;
  c.context = &tests;
  c.refine_rank = [](const void* context, const Shape& shape, FaceId f) {
    const auto& t = *static_cast<const AdaptTests*>(context);
    return t.should_refine != nullptr && t.should_refine(t.context, shape, f) ? 2.0f : 0.0f;
  };
  c.weld_rank = [](const void* context, const Shape& shape, VertexId v) {
    const auto& t = *static_cast<const AdaptTests*>(context);
    return t.should_simplify != nullptr && t.should_simplify(t.context, shape, v) ? 0.0f : 2.0f;
  };
  return c;
}

// --- Unconditional ---

namespace {

float unconditional_rank(const void* context, int level) {
  const int levels = static_cast<const Unconditional*>(context)->levels;
  return levels > level ? 1.0f + static_cast<float>(levels - level) : 0.0f;
}

}  // namespace

Criterion criterion_of(const Unconditional& options) {
  Criterion c;
  c.context = &options;
  c.refine_rank = [](const void* context, const Shape& shape, FaceId f) {
    return unconditional_rank(context, shape.mesh.face_level(f));
  };
  c.weld_rank = [](const void* context, const Shape& shape, VertexId v) {
    return unconditional_rank(context, shape.mesh.level(v) - 1);
  };
  c.ranks_triangles = true;
  return c;
}

// --- Normals ---

namespace {

// Unit normal; zero for a triangle without area.
Vec3 normal(const Shape& s, VertexId a, VertexId b, VertexId c) {
  return normalised(cross(s.position[b] - s.position[a], s.position[c] - s.position[a]));
}

// Mean of the normals of the faces around v.
Vec3 mean_normal(const Shape& s, VertexId v) {
  Vec3 sum;
  for (const HalfEdgeId h : star(s.mesh, v)) {
    const FaceId f = Mesh::face_of(h);
    sum = sum + normal(s, s.mesh.corner(f, 0), s.mesh.corner(f, 1), s.mesh.corner(f, 2));
  }
  return normalised(sum);
}

// 1 - cos of the angle between two normals; 0 where one is unknown.
float turn(Vec3 a, Vec3 b) {
  if (!(dot(a, a) > 0) || !(dot(b, b) > 0)) return 0;
  return 1 - dot(a, b);
}

}  // namespace

float compute_rank(const NormalsOptions& options, const Shape& s, const Triangle& t) {
  if (length(s.position[t.corner[1]] - s.position[t.corner[0]]) < options.shortest_edge_mm) return 0;
  const Vec3 own = normal(s, t.corner[0], t.corner[1], t.corner[2]);
  float worst = 0;
  for (int k = 0; k < 3; ++k) {
    const VertexId a = t.corner[k], b = t.corner[(k + 1) % 3];
    const float here = t.across[k] == kNone ? turn(mean_normal(s, a), mean_normal(s, b))
                                            : turn(own, normal(s, b, a, t.across[k]));
    worst = max(worst, here);
  }
  const float tolerated = 1 - options.cos_angle;
  return tolerated > 0 ? worst / tolerated : 0;
}

Criterion criterion_of(const NormalsOptions& options) {
  return criterion_of<NormalsOptions, compute_rank>(options, true);
}

// --- Combination ---

namespace {

// NaN counts as 0, and does not hide the rank of the other criterion.
float larger_rank(float a, float b) {
  return max(max(0, a), b);
}

}  // namespace

Criterion criterion_of(const EitherOf& options) {
  Criterion c;
  c.context = &options;
  c.refine_rank = [](const void* context, const Shape& shape, FaceId f) {
    const auto& e = *static_cast<const EitherOf*>(context);
    return larger_rank(e.first.refine_rank(e.first.context, shape, f),
                       e.second.refine_rank(e.second.context, shape, f));
  };
  c.weld_rank = [](const void* context, const Shape& shape, VertexId v) {
    const auto& e = *static_cast<const EitherOf*>(context);
    return larger_rank(e.first.weld_rank(e.first.context, shape, v),
                       e.second.weld_rank(e.second.context, shape, v));
  };
  c.ranks_triangles = options.first.ranks_triangles && options.second.ranks_triangles;
  c.sees_neighbours = options.first.sees_neighbours || options.second.sees_neighbours;
  return c;
}

}  // namespace pliant
