#include "host/bake/symmetric_eigen.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <stdexcept>

namespace pliant::host::bake {

namespace {

/// Numbers that are not finite may pass for a success.
template <class Solver>
SymmetricEigen result_of(const Solver& solver) {
  if (solver.info() != Eigen::Success || !solver.eigenvalues().allFinite() ||
      !solver.eigenvectors().allFinite())
    throw std::runtime_error("the eigenvalues of a matrix cannot be computed");
  return {solver.eigenvalues(), solver.eigenvectors()};
}

}  // namespace

SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& a) {
  return result_of(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(a));
}

SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  // The solver does not ask its own factorisation of b whether it succeeded.
  if (Eigen::LLT<Eigen::MatrixXd>(b).info() != Eigen::Success)
    throw std::runtime_error(
        "the eigenvalues of a matrix cannot be computed: the other is not positive definite");
  return result_of(Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(a, b));
}

}  // namespace pliant::host::bake
