#pragma once
// Landmarks of a model that are named by the iBUG scheme: ibug00 to ibug67.
#include "pliant/model.hpp"

namespace pliant {

/// Index of landmark ibugNN of a model, or kNone. \param number  NN. \param expected  index that is compared first: models
/// list the scheme's landmarks in its order.
std::uint16_t find_ibug(const Model& model, int number, std::size_t expected = 0);

/// Those whose middle and distances are a face's box: outer corners of the eyes, then of the mouth, each the right one of
/// the face first. \return false if the model lacks one.
bool find_box_corners(const Model& model, std::uint16_t (&corners)[4]);

}  // namespace pliant
