// C-steps to convergence (docs/algorithms.md, section 6.1). The determinant never increases; it stays equal only if the
// subset does.
#include "optim/mcd_search.hpp"

#include "base/integers.hpp"

namespace pliant::mcd {

namespace {
bool was_seen(const Search& search) {
  const std::size_t count = smaller(search.seen_count, kRemembered);
  const ScaledNumber last = search.seen[search.seen_count % kRemembered];
  for (std::size_t i = 0; i < count; ++i)
    if (i != search.seen_count % kRemembered && is_close(search.seen[i], last, kTuning.same_determinant))
      return true;
  return false;
}
}  // namespace

void Search::converge(Shape<double>& shape) {
  for (int step = 0; step < kTuning.c_steps; ++step) {
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
