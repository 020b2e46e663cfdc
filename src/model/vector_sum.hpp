#pragma once
// The sum of vector fields that a chain of records adds to the constant at its root, at the nodes of a grid over the chart.
// Fields whose own samples lie at the nodes are read without interpolation.
#include "pliant/field.hpp"
#include "pliant/model.hpp"

namespace pliant {

class VectorSum {
 public:
  /// \param records  that have an effect, in the order of the table (RecordSelection::listed). \param q  all parameters.
  /// \param width    nodes; `height` likewise.
  VectorSum(const Model& model, Span<const std::uint16_t> records, const float* q, std::size_t width,
            std::size_t height)
      : model_(model), records_(records), q_(q), width_(width), height_(height) {}

  /// Whether the records are a constant and vectors added to it one after the other, and nothing else. If false, `compute`
  /// must not be called.
  bool applies() const;
  /// Of each component of a sum, no more on either side of zero, mm.
  Vec3 largest() const;
  /// The sums at the nodes (first, j) to (first + out.count - 1, j), without the constant.
  void compute(std::size_t first, std::size_t j, Interpolation interpolation, Span<Vec3> out) const;

 private:
  bool has_samples_at_nodes(const Field& field) const;
  bool overlaps(const Field& field, std::size_t first, std::size_t last, std::size_t j) const;
  void add_samples(const Field& field, float amount, std::size_t first, std::size_t j, Span<Vec3> out) const;

  const Model& model_;
  Span<const std::uint16_t> records_;
  const float* q_;
  std::size_t width_, height_;
};

}  // namespace pliant
