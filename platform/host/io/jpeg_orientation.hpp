#pragma once
/// \file jpeg_orientation.hpp
/// How a camera was held when it took a JPEG picture (Exif 2.3, tag 274), and the picture as it is to be shown.
#include <string_view>

#include "host/io/image.hpp"

namespace pliant::host {

/// The orientation that a JPEG file tells, 1 to 8; 1, upright, where it tells none, for what is no JPEG, and for damaged tags.
/// Cost: the segments before the picture.
int jpeg_orientation(std::string_view jpeg);

/// The picture turned and mirrored to be upright. \param orientation  1 to 8.
Image upright(const Image& image, int orientation);

}  // namespace pliant::host
