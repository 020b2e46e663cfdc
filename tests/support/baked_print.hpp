#pragma once
// Tables of surfaces with a print.
#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "host/bake/bake.hpp"
#include "host/io/image.hpp"
#include "obj_folder.hpp"

namespace pliant {

/// The bytes of a table that is baked from a shape over (s, t) with this picture as its texture.
inline std::vector<std::uint8_t> baked_print(const obj_folder::Shape& shape, const host::Image& picture) {
  const obj_folder::ObjFolder folder("print");
  folder.write("neutral", shape);
  host::bake::BakeOptions options;
  options.source = folder.path.string();
  options.texture = folder.put("print.png", host::encode_png(picture));
  std::vector<std::uint8_t> bytes;
  std::string error;
  REQUIRE_MESSAGE(host::bake::bake(options, bytes, error), error);
  return bytes;
}

}  // namespace pliant
