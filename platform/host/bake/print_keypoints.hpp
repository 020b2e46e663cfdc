#pragma once
/// \file print_keypoints.hpp
/// The keypoints of a surface's print (docs/algorithms.md, section 7.17).
#include <cstdint>
#include <vector>

#include "pliant/model.hpp"

namespace pliant::host::bake {

/// Finds the corners of a model's albedo as they look from several directions and at several scales, and writes the table that
/// PrintTable reads. Corners that look like others elsewhere on the surface are left out.
/// \return empty if fewer than 16 corners are left, or most look like others: the print cannot be told from itself.
std::vector<std::uint8_t> make_print_table(const Model& model);

}  // namespace pliant::host::bake
