#pragma once
/// \file folding.hpp
/// Whether parameters make the surface fold over itself, and how far along a step one may go before it does (the paper,
/// section 3.4: not every q is a valid one; ALGORITHMS: section 3.5).
#include <cstddef>
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/cascade.hpp"

namespace pliant {

/// Cosine between the normals p_u x p_v of a surface point now and at rest: 0 or less where the surface has folded over.
/// 0 where either has no normal.
float orientation(const SurfaceFrame& now, const SurfaceFrame& rest);

/// The same test by the faces of the model's base mesh: a face has folded when its normal makes 90 degrees or more with the
/// one it has at rest. Faces that one parameter alone turns that far within its limits (the inside of a lip that
/// rolls) are the model's own doing and are not watched. What folds between the vertices of a face is not seen.
/// Bytes: 12 a face, 12 a vertex and 4 a parameter.
class FoldOverTest {
 public:
  void lay_out(Arena& arena, const Model& model);

  /// Measures the model at rest and at each parameter's limits; the cascade's choice of free parameters does not matter.
  /// Cost: two samples a vertex and limit, some 10 ms for 150 parameters on a host. Once a model.
  void start(Cascade& cascade);
  bool is_started() const { return vertex_count_ > 0; }

  /// Positions of the base mesh's vertices at q (mm). Cost: one sample a vertex and active record.
  void compute_positions(Cascade& cascade, const float* q, Vec3* position) const;

  std::size_t vertex_count() const { return vertex_count_; }
  std::size_t watched_count() const { return watched_count_; }
  /// Faces watched that have folded. `position` is indexed by base vertex, as everywhere here; those of any mesh refined
  /// from the base will do, its base vertices come first.
  std::size_t count_folded(const Vec3* position) const;
  /// How much of the way from one shape to another, in [0,1], no watched face folds that was not folded before: 1 where the
  /// whole step is good, else 0.9 of what folds the first face. Exact where positions are linear in the
  /// parameters (add_vector); with rotations check again where it leads. Cost: about 60 operations a face.
  float step_fraction(const Vec3* from, const Vec3* to) const;

 private:
  Model model_;
  Vec3* rest_normal_ = nullptr;  // a face; zero where it is not watched
  Vec3* position_ = nullptr;
  float* q_ = nullptr;
  std::size_t vertex_count_ = 0, watched_count_ = 0;
};

}  // namespace pliant
