#include "host/learn/aligner_components.hpp"

#include <algorithm>

#include "host/bake/symmetric_eigen.hpp"

namespace pliant::host::learn {

LearntGlobal reduce_to_components(const RidgeSums& sums, const std::vector<double>& solution,
                                  std::size_t most) {
  using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const std::size_t bytes = sums.inputs - 1, outputs = sums.outputs, components = std::min(most, outputs);
  const auto rows = static_cast<Eigen::Index>(outputs), columns = static_cast<Eigen::Index>(bytes + 1);
  const Eigen::Map<const RowMatrix> w(solution.data(), rows, columns);
  const Eigen::Map<const Eigen::MatrixXd> h(sums.xx.data(), columns, columns);
  // Covariance of the predictions: its leading directions are the components.
  const Eigen::VectorXd mean_x = h.row(columns - 1).transpose() / sums.weight;
  const Eigen::VectorXd mean = w * mean_x;
  const Eigen::MatrixXd hw = h.selfadjointView<Eigen::Lower>() * w.transpose();
  const Eigen::MatrixXd covariance = w * hw / sums.weight - mean * mean.transpose();
  const Eigen::MatrixXd v =
      bake::symmetric_eigen(covariance).vectors.rightCols(static_cast<Eigen::Index>(components));
  const RowMatrix projected = v.transpose() * w;
  const Eigen::VectorXd offset = v.transpose() * mean;
  LearntGlobal out;
  out.basis.resize(components * bytes);
  out.bias.resize(components);
  out.output.resize(outputs * components);
  for (std::size_t c = 0; c < components; ++c) {
    const auto row = static_cast<Eigen::Index>(c);
    for (std::size_t k = 0; k < bytes; ++k)
      out.basis[c * bytes + k] = projected(row, static_cast<Eigen::Index>(k));
    out.bias[c] = projected(row, columns - 1) - offset(row);
    for (std::size_t o = 0; o < outputs; ++o)
      out.output[o * components + c] = v(static_cast<Eigen::Index>(o), row);
  }
  out.mean.assign(mean.data(), mean.data() + outputs);
  return out;
}

}  // namespace pliant::host::learn
