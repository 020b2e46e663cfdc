// Uses the Gram matrix of the centred shapes, whose size is their number (Sirovich 1987).
#include "host/bake/principal_components.hpp"

#include <algorithm>
#include <cmath>

#include "host/bake/symmetric_eigen.hpp"

namespace pliant::host::bake {

namespace {

/// Centred shapes as columns, and their mean.
Eigen::MatrixXd centred(const std::vector<std::vector<Vec3>>& shapes, Eigen::VectorXd& mean) {
  const auto rows = static_cast<Eigen::Index>(3 * shapes[0].size()),
             columns = static_cast<Eigen::Index>(shapes.size());
  Eigen::MatrixXd x(rows, columns);
  for (Eigen::Index c = 0; c < columns; ++c) {
    Eigen::Index r = 0;
    for (Vec3 p : shapes[static_cast<std::size_t>(c)])
      for (float value : {p.x, p.y, p.z}) x(r++, c) = static_cast<double>(value);
  }
  mean = x.rowwise().mean();
  x.colwise() -= mean;
  return x;
}

std::vector<Vec3> vectors(const Eigen::VectorXd& x) {
  std::vector<Vec3> result;
  for (Eigen::Index r = 0; r < x.size(); r += 3)
    result.push_back({static_cast<float>(x(r)), static_cast<float>(x(r + 1)), static_cast<float>(x(r + 2))});
  return result;
}

}  // namespace

PrincipalComponents find_components(const std::vector<std::vector<Vec3>>& shapes, int count) {
  Eigen::VectorXd mean;
  const Eigen::MatrixXd x = centred(shapes, mean);
  const double divisor = static_cast<double>(shapes.size()) - 1;
  const SymmetricEigen eigen = symmetric_eigen(x.transpose() * x / divisor);
  const double whole = std::max(1e-30, eigen.values.sum());
  PrincipalComponents result;
  result.mean = vectors(mean);
  for (int k = 0; k < count; ++k) {
    const Eigen::Index column = x.cols() - 1 - k;  // eigenvalues ascend
    // X v has the length sqrt(divisor lambda). Its sign is chosen so that the largest entry is positive, which makes the
    // result the same on every machine.
    Eigen::VectorXd direction = x * eigen.vectors.col(column) / std::sqrt(divisor);
    Eigen::Index largest = 0;
    direction.cwiseAbs().maxCoeff(&largest);
    if (direction(largest) < 0) direction = -direction;
    result.components.push_back(vectors(direction));
    result.explained.push_back(static_cast<float>(std::max(0.0, eigen.values(column)) / whole));
  }
  return result;
}

}  // namespace pliant::host::bake
