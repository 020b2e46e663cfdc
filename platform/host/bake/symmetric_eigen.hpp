#pragma once
/// \file symmetric_eigen.hpp
/// Eigenvalues of symmetric matrices by Eigen, compiled once: its templates are among the slowest of the whole build.
#include <Eigen/Core>

namespace pliant::host::bake {

/// Eigenvalues, ascending, and the eigenvectors as columns in the same order.
struct SymmetricEigen {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;  ///< orthonormal, with respect to `b` where there is one
};

/// \param a  n x n, symmetric; the lower triangle is read.
/// Both throw std::runtime_error if a matrix is not finite, `b` not positive definite, or the iteration does not converge.
SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& a);

/// The generalised problem a v = value b v.
/// \param b  n x n, symmetric, positive definite; the lower triangle is read.
SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

}  // namespace pliant::host::bake
