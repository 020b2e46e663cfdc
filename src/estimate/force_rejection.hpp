#pragma once
// Rejection of rows by image forces in parameter space (the paper, Appendix A; docs/algorithms.md, section 6.5).
#include "estimate/frame_problem.hpp"
#include "pliant/estimator_options.hpp"
#include "pliant/image_forces.hpp"

namespace pliant {

/// Decides which rows agree about the rigid motion. The estimate is made from a sample of the rows; every row of rank two is
/// then tested against it.
class RowForces {
 public:
  /// \param sample  rows that the estimate is made from, at most.
  void lay_out(Arena& arena, std::size_t sample);
  /// Computes `is_kept` of the rows of rank two, at the problem's state. Precondition: the rows are measured there. If there
  /// are too few rows, nothing changes.
  void reject(FrameProblem& problem);

 private:
  ForceRejector rejector_;
  std::size_t sample_capacity_ = 0;
  float* jacobian_ = nullptr;
  Vec2* force_ = nullptr;
  std::uint8_t* keep_ = nullptr;
};

/// Functions of the rejection. The estimator calls them through this table only, so that a program whose limits name
/// no table does not link the 15 kB behind it.
struct ForceRejection {
  /// Takes a RowForces from the arena. \return null if the arena measures or is exhausted.
  RowForces* (*lay_out)(Arena& arena, std::size_t sample);
  void (*reject)(RowForces& forces, FrameProblem& problem);
};

}  // namespace pliant
