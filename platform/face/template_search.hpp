#pragma once
// Where in a picture something looks like the model: small templates drawn from it, in a few poses, over all places and
// sizes.
#include <cstdint>

#include "vision/directions.hpp"
#include "face/rendered_template.hpp"
#include "pliant/pyramid.hpp"

namespace pliant {

/// A place that looks like the model. Positions are of the model's middle (ModelPicture::middle).
struct Candidate {
  Vec2 x;           // px of the frame
  float scale = 0;  // px per mm
  Quat turn;
  float likeness = 0;  // cosine between the directions of picture and template
};

class PictureSearch {
 public:
  static constexpr int kSide = ModelPicture::kSide / 2;
  static constexpr float kInnerPx = 16;  // of a template: the inner face's larger side
  static constexpr int kTurns = 9;
  static constexpr std::size_t kCandidates = 6;
  static constexpr int kReach = 3;  // of the directions

  /// For frames of this size, and inner faces of least_px or more.
  void lay_out(Arena& arena, int width, int height, float least_px);
  /// Draws the templates. `picture` is prepared and drawn at rest.
  void prepare(ModelPicture& picture, float distance_mm);
  /// The most likely places, for inner faces between two sizes in px of the frame, best first.
  /// Cost: a product a pixel of a template, kTurns times at each place of the frame shrunk to kInnerPx / least_px, and
  /// twice that for all larger sizes together.
  Span<const Candidate> find(const Pyramid& pyramid, float least_px, float largest_px);

 private:
  struct Template {
    Direction* direction;
    Quat turn;
    int x0, y0, x1, y1;  // what of the square is not zero
    float length;
  };
  void draw_template(ModelPicture& picture, Template& t);
  void add_drawing(const ModelPicture& picture);
  void search_scale(const Pyramid& pyramid, float scale);
  float likeness_at(const Template& t, int x, int y) const;
  void offer(const Candidate& candidate);
  void shrink_to(const Pyramid& pyramid, float ratio);
  void sum_energy();

  int width_ = 0, height_ = 0;  // room for the shrunk frame
  float scale_ = 0, rho_ = 1e-3f;
  DirectionFinder finder_;
  Template* template_ = nullptr;
  Direction* template_directions_ = nullptr;
  std::uint8_t* grey_ = nullptr;
  Direction* direction_ = nullptr;
  std::uint32_t* energy_ = nullptr;  // sums over all above and to the left
  std::int32_t* sum_ = nullptr;      // of a template's directions, while it is drawn
  ImageView shrunk_;
  Candidate* candidate_ = nullptr;
  std::size_t found_ = 0;
};

/// A view that puts the model point `middle` at x.
View view_at(Vec2 x, float scale, Quat turn, Vec3 middle, float rho, Vec2 principal);

}  // namespace pliant
