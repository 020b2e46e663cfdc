#pragma once
// Keeps the parameters of a fit where the surface does not fold over (docs/algorithms.md, section 3.5).
#include "pliant/fold_over.hpp"

namespace pliant {

/// Watches the shapes of a fit, and moves parameters back to where no watched face has turned over.
class FoldOverGuard {
 public:
  /// \param samples  whether there is room for the vertices' samples: 12 bytes a vertex and record for a quarter of the time of
  ///                 each shape.
  void lay_out(Arena& arena, const Model& model, bool samples);

  /// Starts from the frozen parameters of `q` with all free ones of `cascade` at rest.
  void start(const Cascade& cascade, const float* q);

  /// Several shapes will be needed: samples the vertices, if there is room. One costs two shapes.
  void expect_shapes();
  /// Notes the shape at q.
  void see(const float* q);
  /// Whether the surface folds over on the straight way from the state of `start` to q.
  /// Vectors below FitTuning::fold_over_slack_mm are left out of the test.
  bool has_folded(const float* q);

  /// Where `q` folds the surface, moves it back towards the state of the last call (or of `start`); then remembers it.
  /// \param q  all parameters; changed in place.
  /// \return whether q was moved.
  bool move_back(float* q);

  /// Positions of the base mesh's vertices at the state of the last call of `start`, `see` or `move_back`, mm.
  const Vec3* positions() const { return seen_; }

 private:
  void compute_positions(const float* q, Vec3* position);
  float step_fraction();

  Cascade* cascade_ = nullptr;  // all its parameters are free, whichever a fit has, so that its samples last
  FoldOverTest test_;
  bool is_exact_ = false;       // test_ knows the faces that are meant to fold over
  bool has_samples_ = false;
  Span<Vec3> samples_;                                    // of the base mesh's vertices
  Vec3 *valid_position_ = nullptr, *position_ = nullptr;  // of the base mesh, at valid_q_ and at a trial
  const Vec3* seen_ = nullptr;                            // one of the two
  float* valid_q_ = nullptr;
};

}  // namespace pliant
