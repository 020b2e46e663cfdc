#pragma once
/// \file cascade.hpp
/// Deformation fields: sample a vector field at (u,v), and run the cascade to a surface point, its tangents and its
/// Jacobian (the paper, section 3; Eq. 1-4 and 11).
#include <cstddef>
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/field.hpp"
#include "pliant/geometry.hpp"
#include "pliant/model.hpp"

namespace pliant {

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

/// Room for a person's folded neutral (Cascade::fold): samples of one field over the chart, 6 bytes each. 128 x 128, as
/// tables are baked unless told otherwise, cost 96 KiB. None by default.
struct PersonalFieldLimits {
  std::uint16_t width = 0, height = 0;  ///< both 0, or 2 to 256
};

/// The cascade of a model, ready to run. Some parameters are free: they are the columns of the Jacobian. The others
/// are frozen, and what depends on frozen ones only (a person's identity, usually) is folded into each baked point.
///
/// A baked point is the cascade's samples at one (u,v): evaluating it touches no table. Not copyable in spirit: the
/// scratch it works in is its own, so one Cascade serves one thread. Bytes: about 50 a record and 15 a parameter for
/// each register (a plain chain needs one), and the folded neutral's.
class Cascade {
 public:
  /// Arena layout (create_in, measured_bytes). All parameters start free, interpolation bilinear, nothing folded.
  void lay_out(Arena& arena, const Model& model, const PersonalFieldLimits& fold = {});

  const Model& model() const { return model_; }

  /// How every field is sampled from now on. Baked points, and a folded neutral, made before are void.
  void set_interpolation(Interpolation interpolation);
  Interpolation interpolation() const { return interpolation_; }

  /// Chooses the free parameters: `is_free` holds one flag a parameter. Baked points made before are void, and so is a
  /// folded neutral.
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

  /// Folds the frozen part, with the values in q, into one field of the arena (int16, the limits' size), so that a new
  /// (u,v) costs two samples for a person where it cost one for each identity field. What can be folded is a record
  /// that no free parameter has touched, with all it reads; of several such that free ones build on, the one with most
  /// samples. The field holds what they add to the constant at their root, which stays as sharp as the table has it.
  /// On the grid of the table's identity fields nothing is lost but the rounding. Half as many samples a side move lips
  /// and lids, which take little room in (u,v), by up to 2.6 mm on a real face: 0.06 mm on average.
  ///
  /// From then on frozen parameters that only the folded part reads are not read from any q. Freezing others, or
  /// `forget_person`, ends it; baked points made before keep their values. Where nothing is worth folding (two samples or
  /// fewer) nothing changes; `is_personalised` tells.
  /// Cost: the frozen part at width x height points, twice.
  /// \return capacity when the limits left no room, bad_argument when q gives a surface that is not finite; then
  ///         nothing is folded.
  Status personalise(const float* q);
  void forget_person();
  bool is_personalised() const { return neutral_ != kNone; }
  /// Fields that one new (u,v) samples, all parameters away from zero.
  std::size_t sample_count() const;

  /// Vec3 values in a baked point under the present choice; never more than model().cascade().count.
  std::size_t samples_per_point() const { return emitted_count_; }
  /// Samples the fields at (u,v) and folds the frozen part with the values in q (all parameters). With `slack_mm`, vectors
  /// are left out that move the point by less than that however large their parameter: the far ends of fields, a quarter
  /// of what a face's points would read at 0.01 mm.
  void sample_point(Vec2 uv, const float* q, Vec3* baked, float slack_mm = 0);

  /// Position of a baked point (Eq. 1). `q` holds all parameters; only the free ones are read.
  Vec3 evaluate(const Vec3* baked, const float* q);
  /// The same with its Jacobian; the Jacobian is valid until the next call on this object.
  Vec3 evaluate(const Vec3* baked, const float* q, Jacobian* jacobian);

  /// Position straight from the tables (and the folded neutral, if there is one). Cost: one sample a record.
  Vec3 surface_point(Vec2 uv, const float* q);
  /// Lists the records that do anything at q (most leave their source as it is where their parameter is 0), so that the
  /// `selected_point`s and `selected_frame`s that follow visit only those. `q` must stay where and as it is meanwhile.
  /// With `slack_mm`, vectors that move no point by more than that are left out as well.
  void select(const float* q, float slack_mm = 0);
  /// Position at the selected q, straight from the tables. Cost: one sample a listed record.
  Vec3 selected_point(Vec2 uv);
  /// Position and tangents straight from the tables; and at the selected q.
  SurfaceFrame surface_frame(Vec2 uv, const float* q);
  SurfaceFrame selected_frame(Vec2 uv);

 private:
  struct Register {
    Vec3* column;
    std::uint16_t* list;
    std::uint8_t* touched;
    std::uint16_t count, busy_until;  // columns listed; the last record that reads the value
  };
  enum class Role : std::uint8_t {
    unused,  // nothing that the result needs
    frozen,  // depends on frozen parameters only
    folded,  // the same, and a live record (or the end) reads it: part of a baked point
    live,    // depends on a free parameter
  };
  template <class Predicate>
  void choose(const Predicate& is_free);
  void plan();
  void mark_needed(std::size_t result);
  void assign_registers();
  void link();
  bool is_skipped(std::size_t n, Vec3 s, float slack_mm) const;
  void compact(Vec3* baked, float slack_mm) const;
  std::uint16_t find_neutral();
  Status fill_neutral(std::size_t record, const float* q);
  std::uint16_t root_field(std::size_t record) const;
  bool is_live(std::size_t record) const { return role_[record] == Role::live; }
  Vec3 point_of_source(const CascadeRecord& r, int k) const;
  Vec3 record_sample(std::size_t record, Vec2 uv, Vec3* du, Vec3* dv) const;
  Vec3 neutral_sample(Vec2 uv, Vec3* du, Vec3* dv) const;
  template <bool kDerive>
  Vec3 run(const Vec3* baked, const float* q);
  void propagate(std::size_t record, const struct FieldStep& step);
  enum Link : std::uint8_t {
    kFollows = 1,  // its only source is the record emitted before
    kPlain = 2,    // follows, adds a vector, and its derivative goes into its source's register
    kStores = 4,   // its value is wanted by another than the record emitted after
    kSkips = 8,    // does nothing at a sample of zero, and nobody misses it
  };
  void add_column(Register& reg, std::uint16_t parameter, Vec3 derivative);

  Model model_;
  Interpolation interpolation_ = Interpolation::bilinear;
  std::uint16_t *parameter_of_ = nullptr, *column_of_ = nullptr;
  Role* role_ = nullptr;            // a record
  std::uint8_t* needed_ = nullptr;  // a record: the result reads it, at first or second hand
  std::uint16_t *visited_ = nullptr, *emitted_ = nullptr;  // records needed; those of them in a baked point
  std::uint16_t *register_of_ = nullptr, *last_reader_ = nullptr;
  std::uint8_t* link_ = nullptr;              // an emitted record: how it hangs on the one before
  std::uint16_t* plain_parameter_ = nullptr;  // and the first of its parameters
  std::uint16_t *selected_ = nullptr, *stands_for_ = nullptr;  // listed records; whose value a record has
  std::size_t visited_count_ = 0, emitted_count_ = 0, selected_count_ = 0;
  std::uint16_t result_ = 0;       // the record whose value is the surface point
  std::uint16_t neutral_ = kNone;  // the record that is read from the folded neutral
  Field neutral_field_ = {};       // what it adds to its root
  PersonalFieldLimits personal_limits_;
  std::int16_t* neutral_samples_ = nullptr;
  const float* selected_q_ = nullptr;
  Vec3* point_ = nullptr;  // a record's value in the running evaluation
  Vec3 *tangent_u_ = nullptr, *tangent_v_ = nullptr;
  Register* register_ = nullptr;
  std::size_t register_count_ = 0, column_count_ = 0;
};

}  // namespace pliant
