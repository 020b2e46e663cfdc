#pragma once
/// \file fold_over.hpp
/// Whether parameters make the surface fold over, and how far a step may go before it does (the paper, section 3.4: not
/// every q is valid; docs/algorithms.md, section 3.5).
#include <cstddef>

#include "pliant/arena.hpp"
#include "pliant/cascade.hpp"

namespace pliant {

/// Cosine between the normals p_u x p_v of a surface point now and at rest: 0 or less where the surface has
/// folded over. 0 where either normal is zero.
float orientation(const SurfaceFrame& now, const SurfaceFrame& rest);

/// Tests the faces of the model's base mesh. A face has folded over when its normal is 90 degrees or more
/// from the one at rest. Faces that one parameter turns so far at one of its limits are intended (a lip that
/// rolls in) and not tested. A fold-over between the vertices of a face is not detected.
/// Bytes: 12 a face, 12 a vertex and 4 a parameter.
class FoldOverTest {
 public:
  /// Arena layout (create_in, measured_bytes).
  void lay_out(Arena& arena, const Model& model);

  /// Measures the model at rest and at the limits of each parameter. Once a model. Cost: two samples a vertex
  /// and limit, about 10 ms for 150 parameters on a host.
  /// \param cascade  of the same model, with any choice of free parameters.
  void start(Cascade& cascade);
  /// Measures the model at rest alone. Until `start`, faces that are meant to fold over are watched too. So step_fraction can only
  /// be too small: where it is 1 now, it is 1 after `start`. Cost: a sample a vertex.
  void start_at_rest(Cascade& cascade);
  bool is_started() const { return vertex_count_ > 0; }  ///< True after either.

  /// Positions of the base mesh's vertices at q (mm). Cost: one sample a vertex and active record.
  /// \param slack_mm  as Cascade::select.
  void compute_positions(Cascade& cascade, const float* q, Vec3* position, float slack_mm = 0) const;

  std::size_t vertex_count() const { return vertex_count_; }    ///< Vertices of the base mesh.
  std::size_t watched_count() const { return watched_count_; }  ///< Faces that are watched.
  /// Watched faces that have folded over.
  /// \param position  by base vertex, mm. Those of a mesh refined from the base do, because base vertices
  ///                  come first there.
  std::size_t count_folded(const Vec3* position) const;
  /// The fraction in [0,1] of a step from one shape to another on which no further watched face folds over: 1
  /// where the whole step is valid, else 0.9 of the step that folds the first face. Exact where positions are
  /// linear in the parameters (add_vector); with rotations the result has to be tested again. Cost: about 60
  /// operations a face.
  float step_fraction(const Vec3* from, const Vec3* to) const;

 private:
  Model model_;
  Vec3* rest_normal_ = nullptr;  // a face; zero where it is not watched
  Vec3* position_ = nullptr;
  float* q_ = nullptr;
  std::size_t vertex_count_ = 0, watched_count_ = 0;
};

}  // namespace pliant
