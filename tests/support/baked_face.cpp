#include "baked_face.hpp"

#include <doctest/doctest.h>

#include <fstream>
#include <iterator>

const char* baked_face_path() {
  return PLIANT_BAKED_FACE;
}

BakedModel& baked_face() {
  static BakedModel* face = [] {
    std::ifstream file(baked_face_path(), std::ios::binary);
    REQUIRE_MESSAGE(file.good(), baked_face_path());
    return new BakedModel(std::vector<std::uint8_t>(std::istreambuf_iterator<char>(file), {}));
  }();
  return *face;
}
