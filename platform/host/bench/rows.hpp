#pragma once
/// \file rows.hpp
/// Rows and times, for all topics of `pliant bench`.
#include <ostream>
#include <string>
#include <vector>

#include "host/io/numbers.hpp"
#include "host/io/statistics.hpp"

namespace pliant::host {

/// Prints rows "topic,pliant,variant,metric,value" and flushes each. Bytes are told to the byte.
class BenchRows {
 public:
  BenchRows(std::ostream& out, const char* topic) : out_(out), topic_(topic) {}
  void operator()(const std::string& variant, const char* metric, double value) const {
    out_ << topic_ << ",pliant," << variant << "," << metric << "," << number_text(value) << std::endl;
  }

 private:
  std::ostream& out_;
  const char* topic_;
};

/// Milliseconds since an arbitrary moment: elapsed time, and processor time of this process.
double wall_ms();
double process_ms();

/// Median time of a call over at least `runs` calls and 0.4 s, after three calls that are not counted.
template <class Call>
double median_microseconds(Call&& call, int runs) {
  for (int i = 0; i < 3; ++i) call();
  std::vector<double> times;
  for (const double start = wall_ms(); static_cast<int>(times.size()) < runs || wall_ms() - start < 400;) {
    const double before = wall_ms();
    call();
    times.push_back(1e3 * (wall_ms() - before));
  }
  return quantile(times, 0.5);
}

}  // namespace pliant::host
