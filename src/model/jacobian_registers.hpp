#pragma once
// The Jacobians of the values that are alive while a cascade runs (Eq. 11), each by its non-zero columns.
#include "model/cascade_plan.hpp"
#include "model/field_step.hpp"
#include "pliant/cascade.hpp"

namespace pliant {

/// The Jacobian of one value.
struct JacobianRegister {
  Vec3* column;           // a column number
  std::uint16_t* list;    // numbers of the columns in use, in the order of their first use
  std::uint8_t* is_used;  // a column number
  std::size_t count;      // of the list

  void add(std::uint16_t c, Vec3 derivative) {
    if (is_used[c]) {
      column[c] = column[c] + derivative;
      return;
    }
    is_used[c] = 1;
    column[c] = derivative;
    list[count++] = c;
  }
  void clear() {
    for (std::size_t k = 0; k < count; ++k) is_used[list[k]] = 0;
    count = 0;
  }
};

class JacobianRegisters {
 public:
  void lay_out(Arena& arena, std::size_t registers, std::size_t parameters);

  /// Empties all registers. Cost: the columns in use.
  void clear();

  /// Applies the chain rule: the columns of the record's sources, mapped by `step`, and those of its own parameters
  /// become the columns of the record's register.
  void propagate(const CascadePlan& plan, const CascadeRecord& r, std::size_t record, const FieldStep& step);

  /// Adds dp/dq of one parameter, if that is free.
  void add(JacobianRegister& to, std::uint16_t parameter, Vec3 derivative) const {
    const std::uint16_t c = column_of_[parameter];
    if (c != kNone) to.add(c, derivative);
  }
  /// A parameter's column, or kNone. Set after lay_out, and valid while the object lives.
  void set_columns(const std::uint16_t* column_of) { column_of_ = column_of; }

  /// The Jacobian in register k, its columns in order. Valid until the register changes.
  Jacobian sorted(std::size_t k);
  JacobianRegister& operator[](std::size_t k) { return registers_[k]; }

 private:
  Span<JacobianRegister> registers_;
  const std::uint16_t* column_of_ = nullptr;
};

}  // namespace pliant
