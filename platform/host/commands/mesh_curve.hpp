#pragma once
/// \file mesh_curve.hpp
/// Error against size for all criteria: what each of them pays for how much accuracy.
#include <string>
#include <vector>

#include "host/render/model_mesh.hpp"

namespace pliant::host {

/// A Markdown table: criterion, setting, vertices, faces, mean and maximum error in mm. "budget" is the
/// contour criterion given the vertices of the row above instead of a tolerance.
/// \param tolerances_mm  of the contour criterion, two rows each.
std::string mesh_curve(const Model& model, ModelSurface& surface, const std::vector<float>& tolerances_mm);

}  // namespace pliant::host
