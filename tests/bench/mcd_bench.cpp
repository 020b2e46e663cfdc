// Times of the minimum covariance determinant on Gaussian data with 20 % of the rows shifted: one
// deterministic start, six, and 500 random ones. Prints topic,peer,variant,metric,value; times are medians.
// "missed" counts outliers not flagged in the last run.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <string>
#include <vector>

#include "../random.hpp"
#include "pliant/outliers.hpp"

using namespace pliant;

namespace {

double now_ms() {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

double cpu_now_ms() {
  return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

std::vector<float> shifted_gaussian(std::size_t rows, std::size_t columns) {
  Random random(7);
  std::vector<float> data(rows * columns);
  for (std::size_t i = 0; i < rows; ++i)
    for (std::size_t j = 0; j < columns; ++j)
      data[i * columns + j] = random.normal() + (5 * i < rows ? 10.0f : 0.0f);
  return data;
}

template <class Run>
void measure(const Mcd& mcd, const std::string& variant, int repeats, Run run) {
  std::vector<double> ms, cpu_ms;
  for (int k = 0; k < repeats; ++k) {
    const double start = now_ms(), cpu_start = cpu_now_ms();
    if (run() != Status::ok) std::printf("mcd,pliant,%s,failed,1\n", variant.c_str());
    ms.push_back(now_ms() - start);
    cpu_ms.push_back(cpu_now_ms() - cpu_start);
  }
  std::sort(ms.begin(), ms.end());
  std::sort(cpu_ms.begin(), cpu_ms.end());
  std::size_t missed = 0;
  for (std::size_t i = 0; 5 * i < mcd.rows(); ++i) missed += mcd.is_flagged(i) ? 0 : 1;
  std::printf("mcd,pliant,%s,ms,%.4g\n", variant.c_str(), ms[ms.size() / 2]);
  std::printf("mcd,pliant,%s,cpu_ms,%.4g\n", variant.c_str(), cpu_ms[cpu_ms.size() / 2]);
  std::printf("mcd,pliant,%s,missed,%zu\n", variant.c_str(), missed);
  std::printf("mcd,pliant,%s,steps,%zu\n", variant.c_str(), mcd.full_steps());
}

void bench(std::size_t rows, std::size_t columns, float alpha) {
  const std::vector<float> data = shifted_gaussian(rows, columns);
  const McdLimits limits{rows, columns};
  std::vector<double> block(measured_bytes<Mcd>(limits) / sizeof(double) + 2);
  Arena arena(block.data(), block.size() * sizeof(double));
  Mcd mcd;
  if (create_in(arena, mcd, limits) != Status::ok) return;
  McdOptions options;
  options.alpha = alpha;
  const std::string size =
      std::to_string(rows) + "x" + std::to_string(columns) + (alpha > 0.6f ? "_0.75" : "_0.5");
  for (std::uint32_t exchanges : {0u, 50u}) {
    options.exchanges = exchanges;
    const std::string end = exchanges > 0 ? "_exchanges" : "";
    measure(mcd, "median_ball_" + size + end, 21,
            [&] { return mcd.deterministic(data.data(), rows, columns, McdStarts::median_ball, options); });
    measure(mcd, "all_six_" + size + end, 11,
            [&] { return mcd.deterministic(data.data(), rows, columns, McdStarts::all_six, options); });
    measure(mcd, "fast_500_" + size + end, 7, [&] { return mcd.fast(data.data(), rows, columns, options); });
  }
}

}  // namespace

int main() {
  for (float alpha : {0.5f, 0.75f}) {
    bench(120, 6, alpha);
    bench(256, 6, alpha);
    bench(200, 2, alpha);
    bench(500, 2, alpha);
    bench(1900, 2, alpha);
    bench(1900, 3, alpha);
    bench(1900, 12, alpha);
    bench(500, 20, alpha);
  }
}
