#pragma once
// What tests compute in double precision with Eigen, compiled once: such templates take ten seconds a test.
#include <Eigen/Core>

/// The x with h x = g, of a symmetric h that is not singular; a column of x for each of g.
Eigen::MatrixXd solve_symmetric(const Eigen::MatrixXd& h, const Eigen::MatrixXd& g);

/// h += a^T b.
void add_product(Eigen::MatrixXd& h, const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);
