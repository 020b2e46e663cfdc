#pragma once
// Depths are compared at a nominal distance: what hides what depends on the model's shape and turn, and hardly on how far
// away the next solve finds it.

namespace pliant {

constexpr float kNominalDepthMm = 1000;
constexpr float kHiddenMarginMm = 6;
/// What a single parameter may be wrong about a vertex that is read from the tables: some of them at once are still well
/// within the margin.
constexpr float kVertexSlackMm = 0.5f;

}  // namespace pliant
