#pragma once
// A model table with what it takes to evaluate it, for tests on a host.
#include <doctest/doctest.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "aligned_block.hpp"
#include "pliant/cascade.hpp"

/// A table in aligned memory, opened, with a cascade to evaluate it.
struct BakedModel {
  std::vector<std::uint32_t> words;
  AlignedBlock block;
  pliant::Model model;
  pliant::Cascade cascade;

  explicit BakedModel(const std::vector<std::uint8_t>& table) : words((table.size() + 3) / 4) {
    std::memcpy(words.data(), table.data(), table.size());
    REQUIRE(pliant::Model::open(words.data(), table.size(), &model) == pliant::Status::ok);
    block = AlignedBlock(pliant::measured_bytes<pliant::Cascade>(model));
    pliant::Arena arena(block.data(), block.size());
    REQUIRE(pliant::create_in(arena, cascade, model) == pliant::Status::ok);
  }
  BakedModel(const BakedModel&) = delete;
  BakedModel& operator=(const BakedModel&) = delete;

  std::vector<float> rest() const { return std::vector<float>(model.parameters().count, 0.0f); }
  /// All zero but one parameter at `fraction` of its maximum.
  std::vector<float> posed(const std::string& name, float fraction = 1) const {
    auto q = rest();
    const auto k = model.find_parameter(name.c_str());
    REQUIRE_MESSAGE(k != pliant::kNone, name);
    q[k] = fraction * model.parameters()[k].maximum;
    return q;
  }
  pliant::Vec2 uv(const std::string& landmark) const {
    const auto k = model.find_landmark(landmark.c_str());
    REQUIRE_MESSAGE(k != pliant::kNone, landmark);
    return {model.landmarks()[k].u, model.landmarks()[k].v};
  }
  pliant::Vec3 at(pliant::Vec2 where, const std::vector<float>& q) {
    return cascade.surface_point(where, q.data());
  }
  pliant::Vec3 at(const std::string& landmark, const std::vector<float>& q) { return at(uv(landmark), q); }
};
