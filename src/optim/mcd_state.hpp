#pragma once
// What an Mcd works on between the calls of its parts: the standardised data, and scratch memory.
#include "optim/mcd_search.hpp"
#include "pliant/outliers.hpp"

namespace pliant {

struct Mcd::State {
  std::size_t row_capacity = 0, column_capacity = 0, stride = 0;
  float *z = nullptr, *other = nullptr;  // standardised data by columns, and room for as much again
  mcd::Scratch scratch = {};
  double* matrices = nullptr;       // two of columns x columns
  ScaledNumber* seen = nullptr;     // determinants that the search has met
  float* candidate_pool = nullptr;  // shapes of FAST-MCD's candidates
  std::uint16_t *row_of = nullptr, *order = nullptr;
  // Rows without NaN or infinity; of these, the rows in the subspace of the constant columns.
  std::size_t finite_rows = 0, used_rows = 0;
  std::size_t active_columns = 0, subset_size = 0;
  std::uint8_t active[kMcdMaxColumns] = {};  // a column: it is not constant
  double median[kMcdMaxColumns] = {}, scale[kMcdMaxColumns] = {};

  void lay_out(Arena& arena, const McdLimits& limits);
  mcd::Cloud cloud() const { return {z, stride, used_rows, active_columns}; }
  mcd::Search begin_search(std::uint16_t* best) const { return {cloud(), subset_size, scratch, best, seen}; }
};

}  // namespace pliant
