#include "statistics.hpp"

#include <algorithm>
#include <numeric>
#include <random>

#include "host/io/statistics.hpp"

namespace pliant::figure9 {

namespace {

double mean_of(const double* first, std::size_t count) {
  return count == 0 ? 0 : std::accumulate(first, first + count, 0.0) / static_cast<double>(count);
}

}  // namespace

Summary summarise(const std::vector<double>& error) {
  if (error.empty()) return {};
  const std::size_t tail = std::min<std::size_t>(100, error.size());
  return {mean_of(error.data(), error.size()), host::quantile(error, 0.5), host::quantile(error, 0.95),
          mean_of(error.data() + error.size() - tail, tail)};
}

Difference paired_difference(const std::vector<double>& a, const std::vector<double>& b) {
  constexpr std::size_t kBlock = 30;
  constexpr int kDraws = 2000;
  const std::size_t n = std::min(a.size(), b.size()), block = std::min(kBlock, n);
  Difference out;
  if (n == 0) return out;
  std::vector<double> difference(n);
  for (std::size_t i = 0; i < n; ++i) difference[i] = a[i] - b[i];
  out.mean = mean_of(difference.data(), n);
  std::mt19937 random(1);
  std::uniform_int_distribution<std::size_t> start(0, n - block);
  std::vector<double> means;
  for (int draw = 0; draw < kDraws; ++draw) {
    double sum = 0;
    std::size_t count = 0;
    for (; count < n; count += block)
      sum += static_cast<double>(block) * mean_of(&difference[start(random)], block);
    means.push_back(sum / static_cast<double>(count));
  }
  out.low = host::quantile(means, 0.025);
  out.high = host::quantile(means, 0.975);
  return out;
}

}  // namespace pliant::figure9
