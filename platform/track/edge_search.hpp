#pragma once
// Looks for the model's curves (lids, lips, brows) and its outline in a picture, a row an edge.
#include <cstddef>
#include <cstdint>

#include "pliant/edges.hpp"
#include "pliant/estimator.hpp"
#include "pliant/pyramid.hpp"

namespace pliant {

class EdgeSearch {
 public:
  static constexpr std::size_t kAlternatives = 2;

  /// Room for so many edge points, outline points among them.
  void lay_out(Arena& arena, std::size_t capacity);

  /// Takes on points along all of the model's curves and around its outline, as far as there is room.
  void place(Estimator& estimator, float spacing_mm, std::size_t silhouette_points);
  /// Edges of curves are asked for from now on with the contrast that they have in this picture, and as far beside the
  /// model's curve; those that it does not show are given up.
  void anchor(Estimator& estimator, const Pyramid& pyramid, Vec2 origin);
  /// Edges of curves are asked for with the sign that the model's albedo gives them.
  void expect_albedo(Estimator& estimator);

  /// \param prediction_of  the index of an id's prediction.
  /// \param sd_px          of the predictions, across the edges.
  /// \return how many observations were written.
  std::size_t look(Span<const Prediction> predictions, const std::uint16_t* prediction_of,
                   const Pyramid& pyramid, Vec2 origin, float image_scale, float sd_px,
                   Span<Observation> out);
  /// Learns the contrast of the edges that were used; `out` as `look` wrote it and a solve judged it.
  void note(Span<const Observation> out);

  std::size_t count() const { return count_; }

 private:
  struct Edge {
    std::uint16_t id;
    std::uint8_t count;  // of its observations, which follow those of the edge before
    bool is_silhouette, is_used, any_contrast;
    float contrast;
    float offset;  // along the normal, in px at an image scale of one
  };

  Edge* edges_ = nullptr;
  std::size_t capacity_ = 0, count_ = 0;
};

}  // namespace pliant
