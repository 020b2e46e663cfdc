#pragma once
// Tuning of adaptation, of the view-dependent criterion, and of the fold-over test.

namespace pliant {

struct AdaptTuning {
  /// Hysteresis, a ratio of ranks > 1: a split must be worth this much more than the weld that makes room for it, and a weld
  /// must stay this far below tolerance. Without it, the mesh would split and weld the same vertex in turn. Not tuned.
  float hysteresis = 1.25f;
  /// Operations of one call of Adapter::adapt for each vertex of the capacity, count: bounds its time. A call that builds a
  /// mesh from its base needs about one. Round value, not tuned.
  int operations_per_vertex = 16;
};
inline constexpr AdaptTuning kAdaptTuning{};

struct ViewTuning {
  /// Cosine of 75 degrees: a triangle whose normal is within 15 degrees of square to the viewing ray is at the silhouette.
  /// Wide enough for the coarsest faces of a face's base mesh. Not tuned.
  float silhouette_cosine = 0.258819045f;
  /// A triangle further than this outside the image counts as hidden, px. Covers the motion of a few frames. Not tuned.
  float margin_px = 20;
  /// A point nearer than this fraction of the model's distance is behind the camera. Keeps divisions bounded. Round value.
  float nearest_fraction = 1e-3f;
};
inline constexpr ViewTuning kViewTuning{};

struct FoldOverTuning {
  /// Fraction taken of the step that folds the first face. The distance to the fold keeps rotations in the cascade, which
  /// the test takes as linear, on the safe side. Round value (docs/algorithms.md, section 3.5), not tuned.
  float safe_fraction = 0.9f;
};
inline constexpr FoldOverTuning kFoldOverTuning{};

}  // namespace pliant
