#pragma once
// Depths are compared at a nominal distance: what hides what depends on the model's shape and turn, and hardly on how far
// away the next solve finds it.

namespace pliant {

constexpr float kNominalDepthMm = 1000;
constexpr float kHiddenMarginMm = 6;

}  // namespace pliant
