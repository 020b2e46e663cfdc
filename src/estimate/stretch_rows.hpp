#pragma once
// Springs between points of the surface: a prior for surfaces that bend and do not stretch (docs/algorithms.md, section 5.8).
#include "pliant/arena.hpp"
#include "pliant/cascade.hpp"
#include "pliant/normal_equations.hpp"
#include "pliant/stretch_prior.hpp"

namespace pliant {

/// A spring of the table: it has its rest length when nothing is stretched.
struct Spring {
  std::uint16_t first, second;  ///< points of the section; first < second
  float length_mm, sd_mm;       ///< at rest; standard deviation of the length
};

/// The springs of a model's table, checked.
struct SpringTable {
  Span<const Vec2> points;
  Span<const Spring> springs;

  /// \return bad_table for a section that is not as docs/model-format.md has it; an empty section is none.
  static Status open(Span<const std::uint8_t> section, SpringTable* table);
};

/// Observations that a spring is counted as in the work of a frame. By callgrind, sheets with 4, 6 and 12 shapes: 0.9, 1.2 and 2.2
/// in a linearisation, 0.8 to 2 where only the cost is asked for.
inline constexpr std::size_t kRowsASpring = 2;

/// The rows of the springs. A spring between p_a and p_b has the residual (length - |p_a - p_b|) / sd. It does not depend on the
/// pose.
class StretchRows {
 public:
  /// Bytes: 12 a point for each sample, parameter and position.
  void lay_out(Arena& arena, const Model& model, std::size_t samples);
  /// Observations that take as much work.
  std::size_t work_rows() const { return kRowsASpring * table_.springs.count; }
  /// Samples the points. \return bad_table.
  Status start(Cascade& cascade, const float* q);
  /// Half the sum of squares at q.
  float cost(Cascade& cascade, const float* q);
  /// Adds the rows at q. The column of parameter k of the cascade is the unknown `first_unknown` + k.
  void add(Cascade& cascade, const float* q, std::size_t first_unknown, NormalEquations& equations);

 private:
  SpringTable table_;
  Status status_ = Status::ok;
  std::size_t stride_ = 0;                         // samples a point
  Vec3 *samples_ = nullptr, *position_ = nullptr;  // of a point: stride_ of them; one
  Vec3* column_ = nullptr;                         // of a point: a parameter each
  Vec2* row_ = nullptr;                            // scratch: a parameter
  std::uint16_t* unknown_ = nullptr;               // scratch: a parameter
};

/// Functions of the prior. Solvers call them through this table only, so that a program whose limits name no table does not
/// link the code behind it.
struct StretchPrior {
  /// Takes StretchRows from the arena. \return null without springs in the model, and if the arena measures or is exhausted.
  StretchRows* (*lay_out)(Arena& arena, const Model& model, std::size_t samples);
  /// As StretchRows::work_rows, of a model's table.
  std::size_t (*work_rows)(const Model& model);
  Status (*start)(StretchRows& rows, Cascade& cascade, const float* q);
  /// As StretchRows::add, where there are equations. \return as StretchRows::cost, where there are none.
  float (*apply)(StretchRows& rows, Cascade& cascade, const float* q, NormalEquations* equations);
};

}  // namespace pliant
