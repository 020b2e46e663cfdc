#pragma once
// The built-in face as `pliant bake` makes it by default. The build bakes it once for all test programs.
#include "baked_model.hpp"
#include "host/io/files.hpp"

inline const char* baked_face_path() {
  return PLIANT_SCRATCH "/face.plm";
}

inline BakedModel& baked_face() {
  static BakedModel* face = [] {
    const std::string table = pliant::host::read_file(baked_face_path());
    return new BakedModel(std::vector<std::uint8_t>(table.begin(), table.end()));
  }();
  return *face;
}
