#pragma once
// Models that are built in memory (model_builder.hpp), opened.
#include <doctest/doctest.h>

#include <vector>

#include "model_builder.hpp"

/// A table opened in memory of its own.
struct OpenModel {
  std::vector<std::uint32_t> words;
  pliant::Model model;

  explicit OpenModel(const ModelBuilder& builder);
};

/// The egg.
struct OpenedEgg : OpenModel {
  std::vector<float> q;  // all 0

  explicit OpenedEgg(int identities);
};
