#pragma once
// The built-in face, baked once for a test program.
#include "bake/bake.hpp"
#include "baked_model.hpp"

inline BakedModel& baked_face() {
  static BakedModel* face = [] {
    pliant::bake::BakeOptions options;
    options.source = PLIANT_FIXTURES "/face";
    std::vector<std::uint8_t> table;
    std::string error;
    REQUIRE_MESSAGE(pliant::bake::bake(options, table, error), error);
    return new BakedModel(table);
  }();
  return *face;
}
