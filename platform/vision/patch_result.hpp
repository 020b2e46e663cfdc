#pragma once
// The result of a match: its uncertainty, and whether it is accepted.
#include "vision/patch_refine.hpp"

namespace pliant::patch {

/// Sets light, correlation, residual, rank and information of a result. \param along  the direction to which an edge
/// confined the search, or zero. \param flow  as PatchOptions::normal_flow.
void describe(const Measurement& m, Vec2 along, const NormalFlow* flow, PatchResult& r);

/// Length of d, px; of a result of rank one, only its part in the direction that has information.
float informed_distance(Vec2 d, const PatchResult& r);

/// Why a result is not accepted, or ok. \param start  where the search started.
PatchStatus judge(const PatchResult& r, Vec2 start, const PatchOptions& o);

}  // namespace pliant::patch
