#pragma once
// Search of a whole frame for places that are similar to the model: small templates rendered from it in a few poses,
// at all positions and sizes.
#include <cstdint>

#include "face/rendered_template.hpp"
#include "pliant/pyramid.hpp"
#include "vision/gradient_directions.hpp"

namespace pliant {

/// A place that is similar to the model. The position is that of the model's middle (RenderedTemplate::middle).
struct Candidate {
  Vec2 x;           // px of the frame
  float scale = 0;  // px per mm
  Quat rotation;
  float similarity = 0;  // cosine between the gradient directions of frame and template
};

/// The templates, and the frame reduced to their size.
class TemplateSearch {
 public:
  static constexpr int kSide = RenderedTemplate::kSide / 2;
  static constexpr float kInnerPx = 16;  ///< larger side of the inner face, px of a template
  static constexpr int kTurns = 9;       ///< poses of the head
  static constexpr std::size_t kCandidates = 6;
  static constexpr int kReach = 3;  ///< of the gradient directions, px

  /// For frames of this size and inner faces of smallest_px or more.
  void lay_out(Arena& arena, int width, int height, float smallest_px);
  /// Renders the templates as seen from a distance. Precondition: `rendered` is prepared and shows the model at rest.
  void prepare(RenderedTemplate& rendered, float distance_mm);
  /// Finds the most similar places for inner faces between two sizes in px of the frame, best first.
  /// Cost: kTurns times a product for each pixel of a template and each pixel of the frame reduced to kInnerPx /
  /// smallest_px of its size, and twice that for all larger sizes together.
  Span<const Candidate> find(const Pyramid& pyramid, float smallest_px, float largest_px);

 private:
  struct Template {
    GradientDirection* direction;
    Quat rotation;
    int x0, y0, x1, y1;  // the part of the square that is not zero
    float length;
  };
  void render_template(RenderedTemplate& rendered, Template& t);
  void add_rendering(const RenderedTemplate& rendered);
  void search_scale(const Pyramid& pyramid, float scale);
  float similarity_at(const Template& t, int x, int y) const;
  void offer(const Candidate& candidate);
  void reduce_to(const Pyramid& pyramid, float ratio);

  int width_ = 0, height_ = 0;  // room for the reduced frame
  float scale_ = 0, rho_ = 1e-3f;
  GradientDirectionFilter filter_;
  Template* template_ = nullptr;
  GradientDirection* template_directions_ = nullptr;
  std::uint8_t* grey_ = nullptr;
  GradientDirection* direction_ = nullptr;
  EnergyTable energy_;
  std::int32_t* sum_ = nullptr;  // of a template's directions while it is rendered
  ImageView reduced_;
  Candidate* candidate_ = nullptr;
  std::size_t found_ = 0;
};

/// A view that puts the model point `middle` at x.
View view_at(Vec2 x, float scale, Quat rotation, Vec3 middle, float rho, Vec2 principal);

}  // namespace pliant
