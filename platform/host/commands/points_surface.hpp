#pragma once
/// \file points_surface.hpp
/// The model as the page of `pliant points` has it: numbers with which the page fits it to handles.
#include <vector>

#include "host/io/fit_file.hpp"
#include "host/io/json.hpp"

namespace pliant::host {

/// The model's start and how it deforms (render/shape_expansion.hpp), at the handles and at the base mesh's vertices:
///   camera {f, cx, cy, k1, k2, aspect}, and q [w, x, y, z] and t [x, y, z] of the start, about `centre`, the mean point
///   facing: the mean normal of the model
///   parameters [{name, value, minimum, maximum, sd}]
///   terms [[a, b]], b = -1 in a term of the first degree
///   handles, wire: {points, start, startScale, moves, moveScales}: `start` holds 16-bit integers, all x, then all y and all z,
///     `moves` the same for each term, of 16 bits (handles) or 8 bits (wire). Both are little-endian in base64; in the
///     bytes of `moves` every run of zeros is a zero and its length
///   corners: three 16-bit vertices of the wire for each face, counted so that its area in the picture is positive if it
///     faces the camera
/// The wire is empty where it would take more than 1.5 million numbers.
Json page_surface(const Model& model, const FitFile& start, const std::vector<float>& q,
                  const std::vector<Vec2>& handles);

}  // namespace pliant::host
