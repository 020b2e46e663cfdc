#include "host/learn/ridge.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cmath>
#include <stdexcept>

namespace pliant::host::learn {

namespace {

constexpr std::size_t kBlockRows = 256;
using FloatRows = Eigen::Map<Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;
using Matrix = Eigen::Map<Eigen::MatrixXd>;
using ConstMatrix = Eigen::Map<const Eigen::MatrixXd>;
using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

Eigen::Index index(std::size_t n) {
  return static_cast<Eigen::Index>(n);
}

}  // namespace

void RidgeSums::resize(std::size_t in, std::size_t out) {
  inputs = in;
  outputs = out;
  xx.assign(in * in, 0);
  xy.assign(in * out, 0);
  yy.assign(out, 0);
  weight = 0;
}

void RidgeSums::add(const RidgeSums& other, double sign) {
  for (std::size_t k = 0; k < xx.size(); ++k) xx[k] += sign * other.xx[k];
  for (std::size_t k = 0; k < xy.size(); ++k) xy[k] += sign * other.xy[k];
  for (std::size_t k = 0; k < yy.size(); ++k) yy[k] += sign * other.yy[k];
  weight += sign * other.weight;
}

RidgeSums sum_of(const std::vector<RidgeSums>& folds) {
  RidgeSums all;
  all.resize(folds[0].inputs, folds[0].outputs);
  for (const RidgeSums& f : folds) all.add(f, 1);
  return all;
}

template <class Number>
void RidgeRows::add(const Number* x, const double* y, double weight) {
  const std::size_t inputs = sums_.inputs, outputs = sums_.outputs;
  x_.resize(kBlockRows * inputs);
  y_.resize(kBlockRows * outputs);
  const double root = std::sqrt(weight);
  float* const to = x_.data() + rows_ * inputs;
  for (std::size_t k = 0; k + 1 < inputs; ++k) to[k] = static_cast<float>(root) * static_cast<float>(x[k]);
  to[inputs - 1] = static_cast<float>(root);
  for (std::size_t k = 0; k < outputs; ++k) {
    y_[rows_ * outputs + k] = static_cast<float>(root * y[k]);
    sums_.yy[k] += weight * y[k] * y[k];
  }
  sums_.weight += weight;
  if (++rows_ == kBlockRows) flush();
}

template void RidgeRows::add(const std::uint8_t*, const double*, double);
template void RidgeRows::add(const float*, const double*, double);

void RidgeRows::flush() {
  if (rows_ == 0) return;
  const FloatRows x(x_.data(), index(rows_), index(sums_.inputs)),
      y(y_.data(), index(rows_), index(sums_.outputs));
  Eigen::MatrixXf xx = Eigen::MatrixXf::Zero(index(sums_.inputs), index(sums_.inputs));
  xx.selfadjointView<Eigen::Lower>().rankUpdate(x.transpose());
  const Eigen::MatrixXf xy = x.transpose() * y;
  Matrix(sums_.xx.data(), index(sums_.inputs), index(sums_.inputs)) += xx.cast<double>();
  Matrix(sums_.xy.data(), index(sums_.inputs), index(sums_.outputs)) += xy.cast<double>();
  rows_ = 0;
}

std::vector<double> solve_ridge(const RidgeSums& sums, double strength) {
  const Eigen::Index n = index(sums.inputs), m = index(sums.outputs);
  Eigen::MatrixXd h = ConstMatrix(sums.xx.data(), n, n);
  // Of the variance, not of the mean square: the mean is the constant's matter.
  const double weight = std::max(sums.weight, 1e-9);
  double variance = 0;
  for (Eigen::Index k = 0; k + 1 < n; ++k) {
    const double mean = h(n - 1, k) / weight;
    variance += h(k, k) / weight - mean * mean;
  }
  variance /= static_cast<double>(n - 1);
  for (Eigen::Index k = 0; k + 1 < n; ++k) h(k, k) += strength * weight * variance + 1e-6 * weight;
  h(n - 1, n - 1) += 1e-9 * weight;
  const auto factors = h.selfadjointView<Eigen::Lower>().llt();
  const Eigen::MatrixXd w = factors.solve(ConstMatrix(sums.xy.data(), n, m));
  if (factors.info() != Eigen::Success || !w.allFinite())
    throw std::runtime_error(
        "the weights of a regression cannot be computed: an input or output is not finite");
  std::vector<double> out(sums.inputs * sums.outputs);
  Eigen::Map<RowMatrix>(out.data(), m, n) = w.transpose();
  return out;
}

std::vector<double> squared_errors(const RidgeSums& sums, const std::vector<double>& solution) {
  const Eigen::Index n = index(sums.inputs), m = index(sums.outputs);
  const Eigen::Map<const RowMatrix> w(solution.data(), m, n);
  const ConstMatrix xy(sums.xy.data(), n, m);
  const ConstMatrix h(sums.xx.data(), n, n);
  const Eigen::MatrixXd hw = h.selfadjointView<Eigen::Lower>() * w.transpose();
  std::vector<double> out(sums.outputs);
  for (Eigen::Index k = 0; k < m; ++k)
    out[static_cast<std::size_t>(k)] =
        sums.yy[static_cast<std::size_t>(k)] - 2 * w.row(k).dot(xy.col(k)) + w.row(k).dot(hw.col(k));
  return out;
}

}  // namespace pliant::host::learn
