#pragma once
// Which records of a cascade have to be visited, and how, under one choice of free parameters. Made when the choice
// changes; evaluation only reads it.
#include "pliant/arena.hpp"
#include "pliant/model.hpp"

namespace pliant {

/// The plan of one choice of free parameters: role, link and register of each record. Makes no evaluation itself.
class CascadePlan {
 public:
  enum class Role : std::uint8_t {
    unused,  // the surface point does not depend on it
    frozen,  // depends on frozen parameters only, and only frozen records read it
    cached,  // depends on frozen parameters only, and a live record reads it or it is the surface point
    live,    // depends on a free parameter
  };
  // How the evaluation of a sampled surface point gets from the sampled record before to this one; flags.
  enum Link : std::uint8_t {
    kFollows = 1,   // its only source is the sampled record before
    kAddsHere = 2,  // follows, is an add_vector, and its derivatives are in the registers of its source
    kStores = 4,    // another record than the next sampled one reads its value, or it is the surface point
    // Leaves its source as it is where its sample is zero, and only the next sampled record reads it.
    kMaySkip = 8,
    kMultipliesHere = 16,  // as kAddsHere, of a product
  };

  void lay_out(Arena& arena, Span<const CascadeRecord> records);

  /// Plans for the surface point, the last record's value.
  /// \param column_of        a parameter: its column, or kNone when it is frozen.
  /// \param personal_record  the record whose value comes from the personal field, or kNone.
  void make(Span<const CascadeRecord> records, const std::uint16_t* column_of, std::uint16_t personal_record);

  /// Lists the records that the value of `result` depends on, without those that only `personal_record` reads. The rest
  /// of the plan is void until `make`.
  void list_needed(Span<const CascadeRecord> records, std::size_t result, std::uint16_t personal_record);

  /// Records that `result` depends on, in order.
  Span<const std::uint16_t> needed() const { return {needed_, needed_count_}; }
  /// Records with a value in a sampled surface point, in order: the live and the cached ones.
  std::size_t sampled_count() const { return sampled_count_; }
  std::uint16_t sampled(std::size_t n) const { return sampled_[n]; }
  unsigned link(std::size_t n) const { return link_[n]; }
  /// The links of all sampled records, and the first parameter of each; kNone when it has none.
  const std::uint8_t* links() const { return link_; }
  const std::uint16_t* first_parameters() const { return first_parameter_; }

  Role role(std::size_t record) const { return role_[record]; }
  bool is_live(std::size_t record) const { return role_[record] == Role::live; }
  /// Where a live record's derivatives are.
  std::uint16_t register_of(std::size_t record) const { return register_of_[record]; }
  /// Registers that every choice of free parameters can do with.
  std::size_t register_count() const { return register_count_; }
  std::uint16_t result() const { return result_; }
  std::uint16_t personal_record() const { return personal_record_; }

 private:
  void assign_roles(Span<const CascadeRecord> records, const std::uint16_t* column_of);
  void find_last_readers(Span<const CascadeRecord> records);
  void assign_registers();
  void link_records(Span<const CascadeRecord> records);
  bool is_stored(Span<const CascadeRecord> records, std::size_t n) const;

  Role* role_ = nullptr;               // a record
  std::uint8_t* is_needed_ = nullptr;  // a record
  std::uint16_t *needed_ = nullptr, *sampled_ = nullptr;
  std::uint16_t *register_of_ = nullptr, *last_reader_ = nullptr;  // a record
  std::uint16_t* busy_until_ = nullptr;       // a register: the last record that reads it
  std::uint8_t* link_ = nullptr;              // a sampled record
  std::uint16_t* first_parameter_ = nullptr;  // a sampled record
  std::size_t needed_count_ = 0, sampled_count_ = 0, register_count_ = 0;
  std::uint16_t result_ = 0, personal_record_ = kNone;
};

}  // namespace pliant
