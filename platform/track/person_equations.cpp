#include "track/person_equations.hpp"

#include "base/integers.hpp"
#include "base/wide_vectors.hpp"
#include "pliant/geometry.hpp"

namespace pliant {

namespace {

/// g += w r B^T and, in the packed triangle h of n rows, h += w B^T B, of one row B with residual r and weight w.
PLIANT_WIDE_VECTORS
void add_row(const float* __restrict row, std::size_t n, float residual, float weight, float* __restrict h,
             float* __restrict g) {
  for (; n > 0; h += n, --n, ++row, ++g) {
    const float w = weight * *row;
    if (w == 0) continue;
    *g += w * residual;
    for (std::size_t j = 0; j < n; ++j) h[j] += w * row[j];
  }
}

}  // namespace

void PersonEquations::lay_out(Arena& arena, std::size_t unknowns) {
  count_ = unknowns;
  h_ = arena.take<float>(unknowns * (unknowns + 1) / 2);
  g_ = arena.take<float>(unknowns);
}

void PersonEquations::reset() {
  for (std::size_t k = 0; k < count_ * (count_ + 1) / 2; ++k) h_[k] = 0;
  for (std::size_t k = 0; k < count_; ++k) g_[k] = 0;
}

void PersonEquations::add(const float* row, float residual, float weight) {
  add_row(row, count_, residual, weight, h_, g_);
}

void PersonEquations::add_prior(std::size_t unknown, float residual, float weight) {
  h(unknown, unknown) += weight;
  g_[unknown] += weight * residual;
}

void PersonEquations::eliminate(std::size_t first) {
  for (std::size_t k = 0; k < first; ++k) {
    const float pivot = h(k, k);
    if (!(pivot > 0)) continue;
    const float* const from = of_row(k);
    for (std::size_t i = k + 1; i < count_; ++i) {
      const float f = from[i] / pivot;
      if (f == 0) continue;
      float* const to = of_row(i);
      for (std::size_t j = i; j < count_; ++j) to[j] -= f * from[j];
      g_[i] -= f * g_[k];
    }
  }
}

void PersonEquations::count_from_zero(std::size_t first, const float* now) {
  for (std::size_t i = first; i < count_; ++i)
    for (std::size_t j = first; j < count_; ++j) g_[i] += h(smaller(i, j), larger(i, j)) * now[j - first];
}

bool PersonEquations::solve(std::size_t first, float* x) {
  for (std::size_t k = first; k < count_; ++k) {
    if (!(h(k, k) > 0)) return false;
    const float per_root = 1.0f / square_root(h(k, k));
    for (std::size_t j = k; j < count_; ++j) h(k, j) *= per_root;
    for (std::size_t i = k + 1; i < count_; ++i)
      for (std::size_t j = i; j < count_; ++j) h(i, j) -= h(k, i) * h(k, j);
  }
  for (std::size_t i = first; i < count_; ++i) {
    float sum = g_[i];
    for (std::size_t k = first; k < i; ++k) sum -= h(k, i) * x[k - first];
    x[i - first] = sum / h(i, i);
  }
  for (std::size_t i = count_; i-- > first;) {
    float sum = x[i - first];
    for (std::size_t k = i + 1; k < count_; ++k) sum -= h(i, k) * x[k - first];
    x[i - first] = sum / h(i, i);
  }
  return true;
}

}  // namespace pliant
