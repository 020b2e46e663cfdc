#pragma once
// Surfaces of any shape with the upper part of the print of the fixtures' sheet: as many pixels as a table keeps.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "host/bake/bake.hpp"
#include "host/io/image.hpp"
#include "obj_folder.hpp"

namespace pliant::host {

/// The table of such a surface. \param contrast  of the print, as a fraction of that of the fixture.
inline std::vector<std::uint8_t> printed(const obj_folder::Shape& shape, float contrast = 1) {
  const obj_folder::ObjFolder folder("printed");
  folder.write("neutral", shape);
  bake::BakeOptions options;
  options.source = folder.path.string();
  const Image whole = read_image(PLIANT_FIXTURES "/sheet/print.png");
  Image part(whole.width, 512, whole.channels);
  std::transform(whole.pixels.begin(), whole.pixels.begin() + static_cast<std::ptrdiff_t>(part.pixels.size()),
                 part.pixels.begin(), [contrast](std::uint8_t grey) {
                   return static_cast<std::uint8_t>(200 + contrast * (static_cast<float>(grey) - 200));
                 });
  options.texture = folder.put("print.png", encode_png(part));
  std::vector<std::uint8_t> bytes;
  std::string error;
  REQUIRE_MESSAGE(bake::bake(options, bytes, error), error);
  return bytes;
}

/// A shape that is curved in all directions.
inline Vec3 cap(float s, float t) {
  const float x = 2.2f * (s - 0.5f), y = 2.2f * (t - 0.5f), r = std::sqrt(x * x + y * y),
              f = r > 0 ? std::sin(r) / r : 1;
  return {160 * f * x, 160 * f * y, 160 * std::cos(r) - 160};
}

}  // namespace pliant::host
