#pragma once
/// \file photo_texture.hpp
/// Projects a photograph onto a fitted model: a texture over the chart (the paper, Figures 3 and 4).
#include <string>
#include <vector>

#include "host/io/fit_file.hpp"
#include "host/io/image.hpp"

namespace pliant::host {

/// Pixels on a side and JPEG quality of a texture. The size matches a face in a photograph of a few megapixels.
constexpr int kPhotoTextureSide = 1024, kPhotoTextureQuality = 90;

/// Makes the texture: `side` x `side` pixels in colour, v = 0 in the first row. A part of the surface that the photograph does
/// not show is taken from its mirror image, if the model is symmetric and the photograph shows that, and is interpolated
/// from its surroundings otherwise.
/// \param fit  the view.
/// \param q    all parameters of the model in it.
Image photo_texture(const Model& model, const FitFile& fit, const std::vector<float>& q, const Image& photo,
                    int side);

/// The fitted model with this texture as glTF, unlit, as the photograph contains the light.
std::string textured_glb(const Model& model, const FitFile& fit, const std::vector<float>& q,
                         const Image& photo);

}  // namespace pliant::host
