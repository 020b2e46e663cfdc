#pragma once
// What is said about the result of a search.
#include "vision/patch_work.hpp"

namespace pliant::patch {

/// Light, correlation, noise, rank and information of what was measured; `along`: the direction to which an edge confined it.
void describe(const Measurement& m, Vec2 along, const PatchOptions& o, PatchResult& r);
/// How far apart two places are, as far as the information goes, px.
float distance_seen(Vec2 d, const PatchResult& r);
/// Whether that can be the patch; `start` is where the search began.
PatchStatus judge(const PatchResult& r, Vec2 start, const PatchOptions& o);

}  // namespace pliant::patch
