#pragma once
/// \file learn_options.hpp
/// What every training run takes, and how it reports.
#include <cstddef>
#include <cstdint>
#include <functional>

namespace pliant::host::learn {

/// Options of a training run. The result depends on `seed` and `effort`, never on `threads`.
struct LearnOptions {
  std::uint64_t seed = 1;  ///< of all random choices
  int threads = 2;         ///< at most, 1 or 2
  /// Samples as a fraction of the usual number. Committed tables are learnt with 1; less is for trials and tests.
  double effort = 1;
};

/// Is called now and then from the thread that called the training. May be empty.
/// \param stage  what is done now, in words; a new stage counts from 0 again.
/// \param done, of  steps, so that the time left can be told.
using LearnProgress = std::function<void(const char* stage, std::size_t done, std::size_t of)>;

}  // namespace pliant::host::learn
