#pragma once
// Keeps the parameters of a fit where the surface does not fold over (docs/algorithms.md, section 3.5).
#include "pliant/fold_over.hpp"

namespace pliant {

class FoldOverGuard {
 public:
  void lay_out(Arena& arena, const Model& model);

  /// Starts from the frozen parameters of `q` with all free ones at rest.
  void start(Cascade& cascade, const float* q);

  /// Where `q` folds the surface, moves it back towards the state of the last call (or of `start`); then remembers it.
  /// \param q  all parameters; changed in place.
  /// \return whether q was moved.
  bool move_back(Cascade& cascade, float* q);

  /// Positions of the base mesh's vertices at the state of the last call, mm.
  const Vec3* positions() const { return valid_position_; }

 private:
  FoldOverTest test_;
  Vec3 *valid_position_ = nullptr, *position_ = nullptr;  // of the base mesh, at valid_q_ and at a trial
  float* valid_q_ = nullptr;
};

}  // namespace pliant
