#pragma once
/// \file criteria.hpp
/// Adaptation criteria (the paper, section 5.2; docs/algorithms.md, section 2): unconditional, normals,
/// contour error; and, from its future work, view and texture. Each is a struct of options and a rank of a
/// triangle (error over tolerance, see Criterion); `criterion_of` makes a Criterion of the two. The options
/// must outlive it. They may change between calls of the Adapter; call Adapter::rerank after that.
#include "pliant/adapt.hpp"
#include "pliant/geometry.hpp"

namespace pliant {

/// A Criterion from options and a rank of triangles. These are live, or those that a weld restores.
template <class Options, float (*rank)(const Options&, const Shape&, const Triangle&)>
Criterion criterion_of(const Options& options, bool sees_neighbours = false) {
  Criterion c;
  c.context = &options;
  c.refine_rank = [](const void* context, const Shape& shape, FaceId f) {
    return rank(*static_cast<const Options*>(context), shape, shape.mesh.triangle(f));
  };
  c.weld_rank = [](const void* context, const Shape& shape, VertexId v) {
    Triangle parents[2];
    float worst = 0;
    for (int i = shape.mesh.find_parents(v, parents) - 1; i >= 0; --i)
      worst = max(worst, rank(*static_cast<const Options*>(context), shape, parents[i]));
    return worst;
  };
  c.ranks_triangles = true;
  c.sees_neighbours = sees_neighbours;
  return c;
}

// --- Tests of the application's own ---

/// The paper's two tests: which faces to refine, which vertices to remove.
struct AdaptTests {
  void* context = nullptr;  ///< passed to the functions
  /// True: the face is refined.
  bool (*should_refine)(void* context, const Shape& shape, FaceId face) = nullptr;
  /// True: the vertex may be removed.
  bool (*should_simplify)(void* context, const Shape& shape, VertexId vertex) = nullptr;
};
Criterion criterion_of(const AdaptTests& tests);  ///< The criterion of these options, which must outlive it.

// --- Unconditional (5.2.1) ---

/// Every face down to a number of bisections of the base mesh, coarse ones first.
struct Unconditional {
  int levels = 3;  ///< bisections; 0 or less: the base mesh
};
/// The criterion of these options, which must outlive it.
Criterion criterion_of(const Unconditional& options);

// --- Normals (5.2.2) ---

/// Detects ridges, valleys and jagged boundaries: by the angle between the normals of two faces at an edge,
/// or, at a boundary edge, between the mean normals of the faces around its two ends.
struct NormalsOptions {
  /// Cosine of the tolerated angle (15 degrees). With 1 or more, no triangle is refined.
  float cos_angle = 0.96593f;
  float shortest_edge_mm = 0.5f;  ///< a triangle whose subdivision edge is shorter is not refined
};
/// The criterion of these options, which must outlive it.
Criterion criterion_of(const NormalsOptions& options);
/// Rank of one triangle: error over tolerance.
float compute_rank(const NormalsOptions& options, const Shape& shape, const Triangle& triangle);

// --- Contour error (5.2.3) ---

/// How far a triangle is from the surface.
struct ContourError {
  float mean_mm = 0;   ///< Eq. 6 over the triangle's area in (u,v)
  float max_mm = 0;    ///< Eq. 7
  float area_mm2 = 0;  ///< of the flat triangle
};

/// Samples the error of Eq. 5 at 4 inner points with equal weights (mean and maximum; the mean is exact for
/// quadratic surfaces) and in the middle of the subdivision edge (maximum). Cost: 5 samples of the surface.
ContourError measure_contour(const Shape& shape, const Triangle& triangle);
/// The same by `cells` x `cells` equal parts of the triangle, sampled at their centres: for reports.
/// \param cells  1 to 64.
ContourError measure_contour(const Shape& shape, const Triangle& triangle, int cells);
/// Of all faces: mean weighted by area, maximum, and area of the whole.
ContourError compute_contour_error(const Shape& shape, int cells);

/// Tolerances. One that is 0 or less is not used. The rank is the largest ratio of error to tolerance.
struct ContourOptions {
  float mean_mm = 0.3f;  ///< of the mean error
  float max_mm = 1.0f;   ///< of the maximum
  /// Of mean error times area: a triangle's part of the mean error of the whole surface. The tolerance to set where the
  /// mean error is to be smallest under a vertex budget.
  float volume_mm3 = 0;
};
/// The criterion of these options, which must outlive it.
Criterion criterion_of(const ContourOptions& options);
/// Rank of one triangle: error over tolerance.
float compute_rank(const ContourOptions& options, const Shape& shape, const Triangle& triangle);

// --- View-dependent ---

/// Contour error in the image, px: the part across the viewing ray. It weighs more at the silhouette, and
/// little on the far side and outside the image. Pinhole, no distortion.
struct ViewOptions {
  Pose pose;                              ///< of the model
  float focal_px = 500;                   ///< px
  float cx = 159.5f, cy = 119.5f;         ///< principal point
  float width_px = 320, height_px = 240;  ///< of the picture
  float tolerance_px = 0.5f;              ///< error that ranks 1; with 0 or less, no triangle is refined
  /// Factor on the error of triangles turned by 75 to 105 degrees from the camera. Round value, not tuned.
  float silhouette_gain = 3;
  /// Of those turned further, and those more than 20 px outside the image. Round value, not tuned.
  float hidden_gain = 0.05f;
};
/// The criterion of these options, which must outlive it.
Criterion criterion_of(const ViewOptions& options);
/// Rank of one triangle: error over tolerance.
float compute_rank(const ViewOptions& options, const Shape& shape, const Triangle& triangle);

// --- Texture-driven ---

/// Puts vertices where there is texture to track. The application gives a score for every (u,v): at least 0,
/// and 1 where a vertex is just worth having. A triangle's rank is its best score times the square of its
/// subdivision edge's length over twice the shortest length; 0 for shorter edges.
struct TextureOptions {
  void* context = nullptr;                           ///< passed to the functions
  float (*score)(void* context, Vec2 uv) = nullptr;  ///< at least 0; 1 is worth a vertex
  /// No subdivision edge shorter than twice this is split for its own rank. Other edges of flat triangles, and those that
  /// neighbours' refinement splits, may be shorter.
  float shortest_edge_mm = 4;
};
/// The criterion of these options, which must outlive it.
Criterion criterion_of(const TextureOptions& options);
/// Rank of one triangle: error over tolerance.
float compute_rank(const TextureOptions& options, const Shape& shape, const Triangle& triangle);

// --- Combinations of two criteria ---

/// Refines where either criterion does, simplifies where both do.
struct EitherOf {
  Criterion first, second;  ///< the two criteria combined
};
Criterion criterion_of(const EitherOf& options);  ///< The criterion of these options, which must outlive it.

}  // namespace pliant
