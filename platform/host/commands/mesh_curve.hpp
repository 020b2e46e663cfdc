#pragma once
/// \file mesh_curve.hpp
/// Error against size of the mesh for all criteria.
#include <string>
#include <vector>

#include "host/render/model_mesh.hpp"

namespace pliant::host {

/// A Markdown table: criterion, setting, vertices, faces, mean and maximum error in mm. A row "budget" is the contour criterion
/// with the number of vertices of the row above instead of a tolerance.
/// \param tolerances_mm  tolerances of the contour criterion; two rows for each.
std::string mesh_curve(const Model& model, ModelSurface& surface, const std::vector<float>& tolerances_mm);

}  // namespace pliant::host
