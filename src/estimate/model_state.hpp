#pragma once
// The state of a tracked model.
#include <cstddef>

#include "base/arrays.hpp"
#include "pliant/arena.hpp"
#include "pliant/camera.hpp"

namespace pliant {

/// A view and one value for each of the model's parameters. Copying the struct copies the pointer; `copy` copies the values.
struct ModelState {
  View view;
  float* q = nullptr;

  void lay_out(Arena& arena, std::size_t parameters) { q = arena.take<float>(parameters); }
};

inline void copy(const ModelState& from, std::size_t parameters, ModelState* to) {
  to->view = from.view;
  copy(from.q, parameters, to->q);
}

}  // namespace pliant
