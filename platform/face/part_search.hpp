#pragma once
// Where the parts of a model lie in a picture that shows it about where it is drawn.
#include "vision/directions.hpp"
#include "face/rendered_template.hpp"
#include "pliant/fit.hpp"
#include "pliant/pyramid.hpp"

namespace pliant {

class PartSearch {
 public:
  static constexpr int kMargin = 8, kWindow = ModelPicture::kSide + 2 * kMargin;
  static constexpr int kPart = 5;        // px around the middle of a part
  static constexpr float kInnerPx = 42;  // of the drawing: the inner face's larger side
  static constexpr int kReach = 6;       // of the directions
  static constexpr std::size_t kParts = 64;

  void lay_out(Arena& arena);
  /// Looks at the frame where `view` has the model, and draws the model (ModelPicture::set) as it would be seen there.
  void look(const Pyramid& pyramid, ModelPicture& picture, const View& view);
  /// Cosine between the directions of what was drawn and of what was seen, over the inner face; 0 where one is even grey.
  float likeness() const { return likeness_; }
  /// Looks for what is drawn around each of the model's landmarks, up to `reach` (at most kMargin) px
  /// of the drawing away.
  /// Only each `step`th is looked for.
  /// \return how many were found, at most kParts.
  std::size_t find(ModelPicture& picture, int reach, std::size_t step, Correspondence* out) const;

 private:
  void compare(const std::uint8_t* inner);
  void sum_energy();
  float likeness_of_part(int x, int y, int dx, int dy, float drawn) const;
  bool find_part(int x, int y, int reach, Vec2* shift, float* likeness) const;

  DirectionFinder finder_;
  std::uint8_t* grey_ = nullptr;
  Direction *drawn_ = nullptr, *seen_ = nullptr;  // what is drawn is 0 beside the inner face
  std::uint32_t* energy_ = nullptr;               // of what is seen: sums over all above and to the left
  View drawn_view_;
  Vec2 origin_;      // of the drawing, px of the frame
  float ratio_ = 1;  // px of the drawing per px of the frame
  float likeness_ = 0;
};

}  // namespace pliant
