#pragma once
// A small lit picture of the model, and which of its pixels tell a face from other things.
#include <cstdint>

#include "pliant/camera.hpp"
#include "pliant/cascade.hpp"
#include "pliant/model.hpp"

namespace pliant {

/// Draws the base mesh with the model's albedo into a square of kSide pixels.
class ModelPicture {
 public:
  static constexpr int kSide = 64;
  static constexpr int kPixels = kSide * kSide;

  void lay_out(Arena& arena, const Model& model);
  /// Takes the albedo and the region of lids, brows and lips from the model. \return not_found where it has none.
  Status prepare();

  /// Who is drawn, and with what expression. Cost: a cascade a vertex.
  void set(const float* q);
  /// Draws at a view in the picture's own pixels. `light` is the unit direction to the lamp in camera axes.
  void draw(const View& view, Vec3 light);

  const std::uint8_t* pixels() const { return grey_; }
  /// Not 0 on the inner face: from above the brows to below the lips, and facing the camera.
  const std::uint8_t* inner() const { return inner_; }
  /// Middle of the inner face at rest (mm), and the larger of its width and height.
  Vec3 middle() const { return middle_; }
  float inner_size() const { return 2 * max(half_.x, half_.y); }
  /// A point of who is drawn; the parameters of `set` must be where and as they were.
  Vec3 point(Vec2 uv) { return cascade_.selected_point(uv); }
  const Model& model() const { return cascade_.model(); }

 private:
  struct Corner {
    Vec2 x, uv;
    Vec2 place;  // on the face, mm beside `middle`, at rest
    float depth, light;
  };
  void shrink_albedo();
  bool find_region();
  void leave_out_rim();
  void draw_face(const Corner& a, const Corner& b, const Corner& c);
  float albedo_at(Vec2 uv) const;

  static constexpr int kAlbedoSide = 96;
  Cascade cascade_;
  std::uint8_t *albedo_ = nullptr, *grey_ = nullptr, *inner_ = nullptr;
  float* depth_ = nullptr;
  Vec3 *position_ = nullptr, *normal_ = nullptr;
  Vec2* place_ = nullptr;
  Corner* corner_ = nullptr;
  float* rest_ = nullptr;
  Vec3 middle_;
  Vec2 half_;
};

}  // namespace pliant
