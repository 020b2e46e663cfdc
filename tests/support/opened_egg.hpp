#pragma once
// The egg (model_builder.hpp) as an opened model.
#include <doctest/doctest.h>

#include <vector>

#include "model_builder.hpp"

struct OpenedEgg {
  std::vector<std::uint32_t> words;
  pliant::Model model;
  std::vector<float> q;  // all 0

  explicit OpenedEgg(int identities);
};
