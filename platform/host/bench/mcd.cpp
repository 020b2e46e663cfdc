// Times of the minimum covariance determinant on Gaussian data with 20 % of the rows shifted, from one deterministic start,
// from six, and from 500 random ones. Times are medians. "missed" counts the outliers that are not flagged in the last run.
#include "host/bench/bench.hpp"
#include "host/bench/rows.hpp"
#include "host/io/failure.hpp"
#include "host/io/owned.hpp"
#include "host/learn/sample_random.hpp"
#include "pliant/outliers.hpp"

namespace pliant::host {

namespace {

/// The sum of twelve uniform numbers: without functions that differ between C libraries.
double nearly_normal(learn::SplitMix& random) {
  double sum = -6;
  for (int i = 0; i < 12; ++i) sum += random.uniform();
  return sum;
}

std::vector<float> shifted_gaussian(std::size_t rows, std::size_t columns) {
  learn::SplitMix random{7};
  std::vector<float> data(rows * columns);
  for (std::size_t i = 0; i < rows; ++i)
    for (std::size_t j = 0; j < columns; ++j)
      data[i * columns + j] = static_cast<float>(nearly_normal(random)) + (5 * i < rows ? 10.0f : 0.0f);
  return data;
}

template <class Run>
void measure(const BenchRows& row, const Mcd& mcd, const std::string& variant, int repeats, Run run) {
  std::vector<double> ms, cpu_ms;
  for (int k = 0; k < repeats; ++k) {
    const double start = wall_ms(), cpu_start = process_ms();
    require(run(), variant);
    ms.push_back(wall_ms() - start);
    cpu_ms.push_back(process_ms() - cpu_start);
  }
  std::size_t missed = 0;
  for (std::size_t i = 0; 5 * i < mcd.rows(); ++i) missed += mcd.is_flagged(i) ? 0 : 1;
  row(variant, "ms", quantile(ms, 0.5));
  row(variant, "cpu_ms", quantile(cpu_ms, 0.5));
  row(variant, "missed", static_cast<double>(missed));
  row(variant, "steps", static_cast<double>(mcd.full_steps()));
}

void bench_shape(const BenchRows& row, std::size_t rows, std::size_t columns, float alpha) {
  const std::vector<float> data = shifted_gaussian(rows, columns);
  Owned<Mcd> memory(McdLimits{rows, columns});
  Mcd& mcd = *memory;
  McdOptions options;
  options.alpha = alpha;
  const std::string size =
      std::to_string(rows) + "x" + std::to_string(columns) + (alpha > 0.6f ? "_0.75" : "_0.5");
  const auto deterministic = [&](McdStarts starts) {
    return mcd.deterministic(data.data(), rows, columns, starts, options);
  };
  for (const std::uint32_t exchanges : {0u, 50u}) {
    options.exchanges = exchanges;
    const std::string end = exchanges > 0 ? "_exchanges" : "";
    measure(row, mcd, "median_ball_" + size + end, 21, [&] { return deterministic(McdStarts::median_ball); });
    measure(row, mcd, "all_six_" + size + end, 11, [&] { return deterministic(McdStarts::all_six); });
    measure(row, mcd, "fast_500_" + size + end, 7,
            [&] { return mcd.fast(data.data(), rows, columns, options); });
  }
}

}  // namespace

void bench_mcd(std::ostream& out) {
  const BenchRows row(out, "mcd");
  for (const float alpha : {0.5f, 0.75f}) {
    for (const std::size_t rows : {120u, 256u}) bench_shape(row, rows, 6, alpha);
    for (const std::size_t rows : {200u, 500u, 1900u}) bench_shape(row, rows, 2, alpha);
    for (const std::size_t columns : {3u, 12u}) bench_shape(row, 1900, columns, alpha);
    bench_shape(row, 500, 20, alpha);
  }
}

}  // namespace pliant::host
