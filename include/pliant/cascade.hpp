#pragma once
/// \file cascade.hpp
/// The cascade of a model: from parameters q to a surface point, its tangents and its Jacobian (the paper, section 3,
/// Eq. 1-4 and 11; docs/algorithms.md, section 3.1).
#include <cstddef>
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/field.hpp"
#include "pliant/geometry.hpp"
#include "pliant/model.hpp"

namespace pliant {

/// J_i = dp/dq, 3 x n, of one surface point (Eq. 11), by the columns that are not zero. Unit: mm per unit of q.
struct Jacobian {
  const Vec3* column = nullptr;         ///< indexed by column number; only those listed have a value
  const std::uint16_t* list = nullptr;  ///< numbers of the non-zero columns, ascending
  std::size_t count = 0;                ///< columns listed
};

/// A surface point (mm, model axes) and its tangents dp/du, dp/dv (mm per unit of u and v).
struct SurfaceFrame {
  Vec3 p;       ///< position, mm
  Vec3 pu, pv;  ///< tangents, mm per unit of u and of v
};

/// Size of the field that Cascade::personalise fills, in samples: 6 bytes each, 128 x 128 are 96 KiB. Fields
/// are baked at 128 x 128 by default.
struct PersonalFieldLimits {
  std::uint16_t width = 0, height = 0;  ///< both 0 (no room for the field), or both 2 to 256
};

/// Runs the cascade of a model. Some parameters are free: each is a column of the Jacobian. The others are frozen.
///
/// A sampled surface point holds the samples of the cascade's fields at one (u,v), and the value of every
/// part of the cascade that depends on frozen parameters only. Its evaluation reads no table. The object
/// works in scratch memory of its own, so one object serves one thread, and its copies share that memory.
/// Bytes: about 70 a record of the cascade, and 15 a parameter for each value that is alive at once (one in a
/// cascade without branches).
class Cascade {
 public:
  /// Arena layout (create_in, measured_bytes). Afterwards all parameters are free and interpolation is bilinear.
  /// \pre `model` is open and its table outlives this object; create_in refuses another with bad_argument.
  void lay_out(Arena& arena, const Model& model, const PersonalFieldLimits& person = {});

  const Model& model() const { return model_; }  ///< The model of the layout.

  /// How every field is sampled from now on. Ends personalisation and invalidates sampled surface points.
  void set_interpolation(Interpolation interpolation);
  Interpolation interpolation() const;  ///< How fields are sampled.

  /// Chooses the free parameters. Ends personalisation and invalidates sampled surface points. O(records^2).
  /// \param is_free  one flag a parameter, not null.
  void set_free(const std::uint8_t* is_free);
  /// Frees one group and freezes the other.
  void set_free(Group group);
  void set_all_free();  ///< Frees all parameters.

  /// Number of parameters of the model.
  std::size_t parameter_count() const { return model_.parameters().count; }
  /// Columns of the Jacobian: one a free parameter, in the order of the parameters.
  std::size_t column_count() const { return column_count_; }
  /// Parameter of a column.
  std::uint16_t parameter_of(std::size_t column) const { return parameter_of_[column]; }
  /// Column of a parameter, or kNone when it is frozen.
  std::uint16_t column_of(std::size_t parameter) const { return column_of_[parameter]; }

  /// Samples the fixed parameters' part of the cascade, at their values in q, into one field in the arena
  /// (the personal field, int16 samples). A new (u,v) then costs two samples for a person instead of one for
  /// each identity field.
  ///
  /// The part is a record that no free parameter has changed, and all records that it depends on. Of several
  /// such records, the one that saves most samples is used. The field holds the difference to the constant at
  /// the root of that part; the constant is still read from the table. If no record saves a sample, nothing
  /// changes and `is_personalised` stays false.
  ///
  /// From then on the frozen parameters of that part are not read from any q. Any set_free or `forget_person`
  /// ends this; sampled surface points made before keep their values. Error: that of the quantisation when
  /// the personal field has the size of the identity fields; with half as many samples a side, up to 2.6 mm
  /// at lips and lids, 0.06 mm on average (measured on a scanned face). Cost: the part's samples at width x
  /// height points, once or twice.
  /// \param q  all parameters.
  /// \return capacity (no room in the limits), bad_argument (q is null, or gives a point further than 1e9 mm from its
  ///         root or not finite).
  Status personalise(const float* q);
  void forget_person();          ///< Ends the personalisation.
  bool is_personalised() const;  ///< True while a personal field is in use.
  /// Fields that a new (u,v) samples when no parameter is zero. O(records).
  std::size_t sample_count() const;

  /// Vec3 values in a sampled surface point under the present choice of free parameters; at most
  /// model().cascade().count.
  std::size_t samples_per_point() const;
  /// Makes a sampled surface point: samples the fields at (u,v) and computes the frozen parts. Cost:
  /// sample_count() samples.
  /// \param q         all parameters; only the frozen ones are read.
  /// \param samples   samples_per_point() values.
  /// \param slack_mm  leaves out each vector of which no component moves the point by this at the limits of its parameter.
  ///                  At 0.01 mm the evaluation of a face's points reads a quarter less. 0: leaves out zero vectors.
  void sample_point(Vec2 uv, const float* q, Vec3* samples, float slack_mm = 0);

  /// Position (mm) of a sampled surface point (Eq. 1). `q` holds all parameters: those of records that follow a free one are
  /// read, free or not.
  Vec3 evaluate(const Vec3* samples, const float* q);
  /// The same with its Jacobian, which is valid until the next call of `evaluate` on this object.
  Vec3 evaluate(const Vec3* samples, const float* q, Jacobian* jacobian);

  /// Position and tangents straight from the tables (and the personal field). `q` holds all parameters.
  /// Cost: one sample for each record whose parameters are not zero.
  Vec3 surface_point(Vec2 uv, const float* q);
  SurfaceFrame surface_frame(Vec2 uv, const float* q);  ///< Position and tangents straight from the tables.
  /// Prepares many surface points at one q: lists the records whose parameters are not zero. The calls of
  /// `selected_point` and `selected_frame` that follow visit only these.
  /// \param q         all parameters; must stay at its address and unchanged for those calls.
  /// \param slack_mm  leaves out each vector of which no component moves any point by this at q.
  void select(const float* q, float slack_mm = 0);
  /// Position at the selected q. Cost: one sample a listed record.
  Vec3 selected_point(Vec2 uv);
  /// Announces that `selected_frame` will be called for a point after the next one: starts to fetch the samples from memory,
  /// on which it waits for half of its time. Changes nothing else.
  void announce(Vec2 uv) const;
  /// Position and tangents at the selected q.
  SurfaceFrame selected_frame(Vec2 uv);

 private:
  struct State;  // in the arena

  template <class Predicate>
  void choose(const Predicate& is_free);
  void update_plan(std::uint16_t personal_record);
  std::uint16_t find_personal_record();
  Status fill_personal_field(std::size_t record, const float* q);

  Model model_;
  std::uint16_t *parameter_of_ = nullptr, *column_of_ = nullptr;  // a column; a parameter
  std::size_t column_count_ = 0;
  State* state_ = nullptr;
};

}  // namespace pliant
