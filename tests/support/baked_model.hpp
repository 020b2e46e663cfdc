#pragma once
// A model table with what it takes to evaluate it, for tests on a host.
#include <cstdint>
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

  explicit BakedModel(const std::vector<std::uint8_t>& table);
  ~BakedModel();
  BakedModel(const BakedModel&) = delete;
  BakedModel& operator=(const BakedModel&) = delete;

  std::vector<float> rest() const;
  /// All zero but one parameter at `fraction` of its maximum.
  std::vector<float> posed(const std::string& name, float fraction = 1) const;
  pliant::Vec2 uv(const std::string& landmark) const;
  pliant::Vec3 at(pliant::Vec2 where, const std::vector<float>& q);
  pliant::Vec3 at(const std::string& landmark, const std::vector<float>& q);
};
