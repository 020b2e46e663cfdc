#pragma once
// A small rendering of the model, and a mask of the pixels in which faces and other objects differ most.
#include <cstdint>

#include "pliant/camera.hpp"
#include "pliant/cascade.hpp"
#include "pliant/model.hpp"

namespace pliant {

/// Renders the base mesh with the model's albedo into a square of kSide pixels.
class RenderedTemplate {
 public:
  static constexpr int kSide = 64;
  static constexpr int kPixels = kSide * kSide;

  void lay_out(Arena& arena, const Model& model);
  /// Reads the albedo and the region of lids, brows and lips from the model. \return `not_found` if it lacks one.
  Status prepare();

  /// Sets the parameters, all of the model's. Cost: a cascade a vertex.
  void set(const float* q);
  /// Renders at a view in px of the square. `light` is the unit direction to the lamp in camera coordinates.
  void draw(const View& view, Vec3 light);

  const std::uint8_t* pixels() const { return grey_; }
  /// 1 on the inner face, from above the brows to below the lips, where it faces the camera; otherwise 0.
  const std::uint8_t* inner() const { return inner_; }
  /// Middle of the inner face at rest, and the larger of its width and height; mm.
  Vec3 middle() const { return middle_; }
  float inner_size() const { return 2 * max(half_.x, half_.y); }
  /// A surface point under the parameters of `set`, which must still be in the same memory and unchanged.
  Vec3 point(Vec2 uv) { return cascade_.selected_point(uv); }
  const Model& model() const { return cascade_.model(); }

 private:
  struct Corner {
    Vec2 x, uv;
    Vec2 place;  // at rest, mm from `middle`
    float depth, light;
  };
  void reduce_albedo();
  bool find_region();
  void clear_silhouette();
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
