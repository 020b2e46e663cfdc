#pragma once
/// \file drawn_portraits.hpp
/// Portraits of people who do not exist: the model with random parameters, and painted hair, neck and clothes.
#include <vector>

#include "host/learn/face_sheet.hpp"
#include "host/learn/other_pictures.hpp"
#include "host/learn/photographs.hpp"

namespace pliant::host::learn {

/// How far drawn people turn at most, rad.
struct DrawnTurn {
  float yaw = 0.2f, pitch = 0.1f;
};

/// Draws portraits of 320 x 320 pixels. Their truth is exact. The same for the same seed.
/// \param sheet   of the model. \param others  backgrounds; may be empty.
/// \param first_person  number of the first person; the others follow.
std::vector<Photograph> draw_portraits(const Model& model, const FaceSheet& sheet,
                                       const OtherPictures& others, std::size_t count, std::uint64_t seed,
                                       int first_person, const DrawnTurn& most_turned = {});

}  // namespace pliant::host::learn
