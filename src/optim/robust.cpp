#include "pliant/robust.hpp"

namespace pliant {

LossValue evaluate(Loss loss, float u) {
  constexpr float kHuber = 1.345f,
                  kTukey = 4.685f;  // 95 % efficiency for normal residuals (Holland, Welsch 1977)
  switch (loss) {
    case Loss::squares:
      break;
    case Loss::huber:
      if (u > kHuber) return {kHuber * (u - 0.5f * kHuber), kHuber / u};
      break;
    case Loss::tukey: {
      const float c2 = kTukey * kTukey;
      const float t = u < kTukey ? 1 - u * u / c2 : 0.0f;
      return {c2 / 6 * (1 - t * t * t), t * t};
    }
  }
  return {0.5f * u * u, 1};
}

namespace {

float median(float a, float b, float c) {
  return max(min(a, b), min(max(a, b), c));
}

/// Moves the chosen values to the front. \return how many. Without a branch on the values, which a processor could not predict.
template <class Predicate>
std::size_t partition(float* value, std::size_t n, const Predicate& is_chosen) {
  std::size_t chosen = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const float v = value[i];
    value[i] = value[chosen];
    value[chosen] = v;
    chosen += is_chosen(v) ? 1u : 0u;
  }
  return chosen;
}

void sift_down(float* heap, std::size_t n, std::size_t i) {  // smallest on top
  for (;;) {
    std::size_t least = i;
    for (std::size_t child = 2 * i + 1; child <= 2 * i + 2 && child < n; ++child)
      if (heap[child] < heap[least]) least = child;
    if (least == i) return;
    const float other = heap[i];
    heap[i] = heap[least];
    heap[least] = other;
    i = least;
  }
}

}  // namespace

float select(float* value, std::size_t n, std::size_t k) {
  constexpr std::size_t kFew = 16;  // values from which a heap is as fast; round value, not tuned
  constexpr int kMostRounds =
      16;  // more only happen for values that make the pivots bad; then the heap bounds the cost
  for (int round = 0; round < kMostRounds && n > kFew; ++round) {
    const float pivot = median(value[0], value[n / 2], value[n - 1]);
    const std::size_t below = partition(value, n, [pivot](float v) { return v < pivot; });
    if (k < below) {
      n = below;
      continue;
    }
    value += below;
    n -= below;
    k -= below;
    const std::size_t equal = partition(value, n, [pivot](float v) { return v <= pivot; });
    if (k < equal) return pivot;
    value += equal;
    n -= equal;
    k -= equal;
  }
  for (std::size_t i = n / 2; i-- > 0;) sift_down(value, n, i);
  for (; k > 0; --k) {
    const float least = value[0];
    value[0] = value[--n];
    value[n] = least;
    sift_down(value, n, 0);
  }
  return value[0];
}

float robust_scale(float* length, std::size_t n) {
  constexpr float kRayleighMedian = 1.1774f;  // sqrt(2 ln 2)
  return n == 0 ? 0.0f : select(length, n, n / 2) / kRayleighMedian;
}

}  // namespace pliant
