#pragma once
/// \file photo_texture.hpp
/// A photograph taken off a fitted model's surface, as a picture over the chart (Figures 3 and 4 of the paper).
#include <string>
#include <vector>

#include "host/io/fit_file.hpp"
#include "host/io/image.hpp"

namespace pliant::host {

/// Pixels a side, and JPEG quality, that a face in a photograph of a few megapixels is worth.
constexpr int kPhotoTextureSide = 1024, kPhotoTextureQuality = 90;

/// What the photograph shows of the surface, in colour, `side` x `side` pixels, v = 0 in the first row. What turns away,
/// is hidden behind another part or lies outside the picture is taken from the other side of the face where the model is
/// its own mirror image and the photograph shows that, and smoothly continued from its surroundings elsewhere.
/// \param fit   the view; \param q  all parameters of the model in it.
Image photo_texture(const Model& model, const FitFile& fit, const std::vector<float>& q, const Image& photo,
                    int side);

/// The fitted model as glTF with that picture on it, without lights: the photograph has its own.
std::string textured_glb(const Model& model, const FitFile& fit, const std::vector<float>& q,
                         const Image& photo);

}  // namespace pliant::host
