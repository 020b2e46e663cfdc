// C-steps to convergence (ALGORITHMS 6.1): the determinant never increases, and stays the same only where the
// subset does.
#include "optim/mcd_search.hpp"

namespace pliant::mcd {

namespace {
constexpr int kMostSteps = 100;  // three to ten is usual
constexpr double kSame = 1e-11;

bool was_seen(const Search& search) {
  const std::size_t count = search.seen_count < kRemembered ? search.seen_count : kRemembered;
  const ScaledNumber last = search.seen[search.seen_count % kRemembered];
  for (std::size_t i = 0; i < count; ++i)
    if (i != search.seen_count % kRemembered && is_close(search.seen[i], last, kSame)) return true;
  return false;
}
}  // namespace

void Search::converge(Shape<double>& shape) {
  for (int step = 0; step < kMostSteps; ++step) {
    c_step(cloud, subset_size, scratch, shape);
    ++steps;
    if (!found || is_less(shape.determinant, best_determinant)) {
      found = true;
      best_determinant = shape.determinant;
      for (std::size_t i = 0; i < subset_size; ++i) best[i] = scratch.subset[i];
    }
    seen[seen_count % kRemembered] = shape.determinant;
    const bool stop = was_seen(*this);
    ++seen_count;
    if (stop) return;
  }
}

}  // namespace pliant::mcd
