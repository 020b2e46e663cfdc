#include "dense.hpp"

#include <Eigen/Cholesky>

Eigen::MatrixXd solve_symmetric(const Eigen::MatrixXd& h, const Eigen::MatrixXd& g) {
  return h.ldlt().solve(g);
}

void add_product(Eigen::MatrixXd& h, const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  h.noalias() += a.transpose() * b;
}
