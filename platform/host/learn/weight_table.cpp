#include "host/learn/weight_table.hpp"

#include <cmath>

namespace pliant::host::learn {

QuantisedRows::QuantisedRows(const std::vector<double>& weights, std::size_t columns) {
  for (std::size_t first = 0; first < weights.size(); first += columns) {
    double largest = 1e-12;
    for (std::size_t k = 0; k < columns; ++k) largest = std::max(largest, std::abs(weights[first + k]));
    scale.push_back(largest / 127);
    for (std::size_t k = 0; k < columns; ++k)
      bytes.push_back(static_cast<std::int8_t>(std::lround(weights[first + k] / scale.back())));
  }
}

std::vector<double> safe_information(std::vector<double> information) {
  for (std::size_t k = 1; k < information.size(); k += 3) information[k] *= 0.999;
  return information;
}

void WeightTable::put_floats(const std::vector<double>& values) {
  for (const double v : values) put(static_cast<float>(v));
}

void WeightTable::put_bytes(const std::vector<std::int8_t>& values) {
  for (const std::int8_t v : values) put(v);
}

}  // namespace pliant::host::learn
