#pragma once
// The model's landmarks in a frame that shows it roughly where it is rendered.
#include "face/rendered_template.hpp"
#include "pliant/fit.hpp"
#include "pliant/pyramid.hpp"
#include "vision/gradient_directions.hpp"

namespace pliant {

/// Compares the rendered model with a frame, as a whole and around each landmark.
class LandmarkSearch {
 public:
  static constexpr int kMargin = 8;  ///< px around the rendered square, so that landmarks can be displaced
  static constexpr int kWindow = RenderedTemplate::kSide + 2 * kMargin;
  static constexpr int kRadius = 5;      ///< px of the square around a landmark that is compared
  static constexpr float kInnerPx = 42;  ///< larger side of the inner face, px of the rendered square
  static constexpr int kReach = 6;       ///< of the gradient directions, px
  static constexpr std::size_t kMaxLandmarks = 64;

  void lay_out(Arena& arena);
  /// Renders the model (RenderedTemplate::set) at `view` and samples the frame there.
  void load(const Pyramid& pyramid, RenderedTemplate& rendered, const View& view);
  /// Cosine between the gradient directions of rendering and frame over the inner face; 0 if one of them is even grey.
  float similarity() const { return similarity_; }
  /// Searches the surroundings of each `step`th landmark within `reach` px of the rendered square, at most kMargin.
  /// \param out  room for kMaxLandmarks. \return how many were found.
  std::size_t find(RenderedTemplate& rendered, int reach, std::size_t step, Correspondence* out) const;

 private:
  void compare(const std::uint8_t* inner);
  float landmark_similarity(int x, int y, int dx, int dy, float rendered_length) const;
  bool find_landmark(int x, int y, int reach, Vec2* shift, float* similarity) const;

  GradientDirectionFilter filter_;
  std::uint8_t* grey_ = nullptr;
  GradientDirection *rendered_ = nullptr, *seen_ = nullptr;  // the rendering is zero outside the inner face
  EnergyTable energy_;                                       // of the frame
  View rendered_view_;
  Vec2 origin_;      // of the rendered square, px of the frame
  float ratio_ = 1;  // px of the rendered square per px of the frame
  float similarity_ = 0;
};

}  // namespace pliant
