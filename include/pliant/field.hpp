#pragma once
/// \file field.hpp
/// Deformation fields: sample a vector field at (u,v), and run the cascade to a surface point, its tangents and its
/// Jacobian (the paper, section 3; Eq. 1-4 and 11).
#include <cstddef>
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/geometry.hpp"
#include "pliant/model.hpp"

namespace pliant {

/// Value of a field at (u,v), bilinear, zero outside its support; a weight field's value is in x.
/// (u,v) is clamped to [0,1]^2. Cost: 4 samples.
Vec3 sample(const Model& model, const Field& field, Vec2 uv);

/// The same and its derivatives along u and v, those of the cell that holds (u,v).
Vec3 sample_with_gradient(const Model& model, const Field& field, Vec2 uv, Vec3* du, Vec3* dv);

/// J_i = dp/dq, 3 x n, of one surface point (Eq. 11), by the columns that are not zero.
struct Jacobian {
  const Vec3* column = nullptr;         ///< indexed by column number; only those listed are meaningful
  const std::uint16_t* list = nullptr;  ///< numbers of the non-zero columns, ascending
  std::size_t count = 0;                ///< of the list
};

/// A surface point and its tangents dp/du, dp/dv in millimetres per unit of u, v.
struct SurfaceFrame {
  Vec3 p, pu, pv;
};

/// The cascade of a model, ready to run. Some parameters are free: they are the columns of the Jacobian. The others
/// are frozen, and what depends on frozen ones only (a person's identity, usually) is folded into each baked point.
///
/// A baked point is the cascade's samples at one (u,v): evaluating it touches no table. Not copyable in spirit: the
/// scratch it works in is its own, so one Cascade serves one thread. Bytes: about 44 a record and 14 a parameter for
/// each register (a plain chain needs one).
class Cascade {
 public:
  /// Arena layout (create_in, measured_bytes). All parameters start free.
  void lay_out(Arena& arena, const Model& model);

  const Model& model() const { return model_; }

  /// Chooses the free parameters: `is_free` holds one flag a parameter. Baked points made before are void.
  void set_free(const std::uint8_t* is_free);
  /// Frees one group and freezes the other.
  void set_free(Group group);
  void set_all_free();

  std::size_t parameter_count() const { return model_.parameters().count; }
  /// Columns of the Jacobian, in the order of their parameters.
  std::size_t column_count() const { return column_count_; }
  std::uint16_t parameter_of(std::size_t column) const { return parameter_of_[column]; }
  /// Column of a parameter, or kNone when it is frozen.
  std::uint16_t column_of(std::size_t parameter) const { return column_of_[parameter]; }

  /// Vec3 values in a baked point under the present choice; never more than model().cascade().count.
  std::size_t baked_count() const { return baked_count_; }
  /// Samples the fields at (u,v) and folds the frozen part with the values in q (all parameters).
  void bake(Vec2 uv, const float* q, Vec3* baked);

  /// Position of a baked point (Eq. 1). `q` holds all parameters; only the free ones are read.
  Vec3 evaluate(const Vec3* baked, const float* q);
  /// The same with its Jacobian; the Jacobian is valid until the next call on this object.
  Vec3 evaluate(const Vec3* baked, const float* q, Jacobian* jacobian);

  /// Position straight from the tables, whatever is free. Cost: one sample a record.
  Vec3 surface_point(Vec2 uv, const float* q);
  /// Lists the records that do anything at q (most leave their source as it is where their parameter is 0), so that the
  /// `selected_point`s that follow visit only those. `q` must stay where and as it is meanwhile.
  void select(const float* q);
  /// Position at the selected q, straight from the tables. Cost: one sample a listed record.
  Vec3 selected_point(Vec2 uv);
  /// Position and tangents straight from the tables.
  SurfaceFrame surface_frame(Vec2 uv, const float* q);

 private:
  struct Register {
    Vec3* column;
    std::uint16_t* list;
    std::uint8_t* touched;
    std::size_t count;
  };
  void assign_registers();
  bool is_live(std::size_t record) const { return live_[record] != 0; }
  void propagate(std::size_t record, const struct FieldStep& step);
  void add_column(Register& reg, std::uint16_t parameter, Vec3 derivative);

  Model model_;
  std::uint16_t *parameter_of_ = nullptr, *column_of_ = nullptr;
  std::uint8_t* live_ = nullptr;         // a record: depends on a free parameter
  std::uint8_t* folded_ = nullptr;       // a frozen record that a live one (or the end) reads
  std::uint8_t* register_of_ = nullptr;  // a record
  std::uint16_t* last_reader_ = nullptr;
  std::uint16_t *selected_ = nullptr, *stands_for_ = nullptr;  // listed records; whose value a record has
  std::size_t selected_count_ = 0;
  const float* selected_q_ = nullptr;
  Vec3* point_ = nullptr;  // a record's value in the running evaluation
  Vec3 *tangent_u_ = nullptr, *tangent_v_ = nullptr;
  static constexpr std::size_t kMaxRegisters = 8;
  Register register_[kMaxRegisters] = {};
  std::size_t register_count_ = 0, column_count_ = 0, baked_count_ = 0;
};

}  // namespace pliant
