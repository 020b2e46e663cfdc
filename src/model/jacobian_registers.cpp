#include "model/jacobian_registers.hpp"

namespace pliant {

void JacobianRegisters::lay_out(Arena& arena, std::size_t registers, std::size_t parameters) {
  registers_ = arena.take_span<JacobianRegister>(registers);
  for (std::size_t k = 0; k < registers; ++k) {
    const JacobianRegister empty{arena.take<Vec3>(parameters), arena.take<std::uint16_t>(parameters),
                                 arena.take<std::uint8_t>(parameters), 0};
    if (arena.is_measuring()) continue;
    registers_[k] = empty;
    for (std::size_t c = 0; c < parameters; ++c) empty.is_used[c] = 0;
  }
}

void JacobianRegisters::clear() {
  for (JacobianRegister& r : registers_) r.clear();
}

void JacobianRegisters::propagate(const CascadePlan& plan, const CascadeRecord& r, std::size_t record,
                                  const FieldStep& f) {
  const auto source = [&](int k) -> const JacobianRegister* {
    const std::uint16_t s = r.source[k];
    return s != kNone && plan.is_live(s) ? &registers_[plan.register_of(s)] : nullptr;
  };
  JacobianRegister& out = registers_[plan.register_of(record)];
  const JacobianRegister *first = source(0), *second = source(1);
  // If the record shares its register with a source, that source's columns are transformed in place. Otherwise the register
  // holds columns that no later record reads; they are removed.
  const float scale_in_place = first == &out ? f.keep : f.keep_second;
  if (first != &out && second != &out) {
    out.clear();
  } else if (f.maps || scale_in_place != 1) {
    for (std::size_t k = 0; k < out.count; ++k) {
      Vec3& column = out.column[out.list[k]];
      column = f.maps ? f.map * column : scale_in_place * column;
    }
  }
  if (first != nullptr && first != &out)
    for (std::size_t k = 0; k < first->count; ++k) {
      const std::uint16_t c = first->list[k];
      out.add(c, f.maps ? f.map * first->column[c] : f.keep * first->column[c]);
    }
  if (second != nullptr && second != &out)
    for (std::size_t k = 0; k < second->count; ++k) {
      const std::uint16_t c = second->list[k];
      out.add(c, f.keep_second * second->column[c]);
    }
  for (int k = 0; k < 6; ++k)
    if (r.parameter[k] != kNone) add(out, r.parameter[k], f.along_parameter[k]);
}

Jacobian JacobianRegisters::sorted(std::size_t k) {
  JacobianRegister& r = registers_[k];
  for (std::size_t n = 1; n < r.count; ++n)  // insertion sort: the list is short and nearly sorted
    for (std::size_t m = n; m > 0 && r.list[m] < r.list[m - 1]; --m) {
      const std::uint16_t other = r.list[m];
      r.list[m] = r.list[m - 1];
      r.list[m - 1] = other;
    }
  return {r.column, r.list, r.count};
}

}  // namespace pliant
