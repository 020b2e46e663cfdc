#pragma once
// The built-in face as `pliant bake` makes it by default. The host build bakes it once for all test programs, and those
// of a target read the host build's file.
#include <fstream>
#include <iterator>

#include "baked_model.hpp"

inline const char* baked_face_path() {
  return PLIANT_BAKED_FACE;
}

inline BakedModel& baked_face() {
  static BakedModel* face = [] {
    std::ifstream file(baked_face_path(), std::ios::binary);
    REQUIRE_MESSAGE(file.good(), baked_face_path());
    return new BakedModel(std::vector<std::uint8_t>(std::istreambuf_iterator<char>(file), {}));
  }();
  return *face;
}
