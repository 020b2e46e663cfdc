// How much texture the picture shows where on the surface, kept over the chart: the mesh that follows the view has more
// vertices there.
#include "pliant/tracker.hpp"

namespace pliant {

namespace {

constexpr float kSteps = 16;  // stored ones for a score of 1
constexpr float kMostScore = 4;
constexpr float kWorthLambda = CornerOptions{}.min_score;  // what is worth a corner is worth a vertex

constexpr float kSamples[4][3] = {{1.0f / 3, 1.0f / 3, 1.0f / 3},
                                  {2.0f / 3, 1.0f / 6, 1.0f / 6},
                                  {1.0f / 6, 2.0f / 3, 1.0f / 6},
                                  {1.0f / 6, 1.0f / 6, 2.0f / 3}};

}  // namespace

/// Gives the mesh a score to follow, unless the caller has one.
void Tracker::start_texture() {
  TextureOptions& texture = options_.estimator.texture;
  notes_texture_ =
      limits_.texture_cells > 0 && options_.estimator.mesh_operations > 0 && texture.score == nullptr;
  if (!notes_texture_) return;
  for (int i = 0; i < limits_.texture_cells * limits_.texture_cells; ++i) texture_[i] = 0;
  texture.context = this;
  texture.score = texture_score;
}

std::uint8_t& Tracker::texture_at(Vec2 uv) const {
  const std::size_t side = limits_.texture_cells;
  const auto cell = [side](float t) {
    return static_cast<std::size_t>(clamp(t * static_cast<float>(side), 0, static_cast<float>(side) - 1));
  };
  return texture_[cell(uv.y) * side + cell(uv.x)];
}

float Tracker::texture_score(void* context, Vec2 uv) {
  return (1 / kSteps) * static_cast<float>(static_cast<const Tracker*>(context)->texture_at(uv));
}

/// Looks at the faces that turn to the camera, one in `parts`, beginning at `part`. What is seen now replaces what was.
void Tracker::note_texture(std::uint32_t part, std::uint32_t parts) {
  const Mesh& mesh = estimator_.mesh();
  for (FaceId f : mesh.faces()) {
    if (f % parts != part || !faces_camera(mesh, estimator_.vertex_images(), f)) continue;
    Vec2 x[3], uv[3];
    for (int k = 0; k < 3; ++k) {
      x[k] = estimator_.vertex_seen(mesh.corner(f, k)) - origin_;
      uv[k] = mesh.uv(mesh.corner(f, k));
    }
    for (const auto& w : kSamples) {
      const float lambda =
          corner_score(current_.level(0), w[0] * x[0] + w[1] * x[1] + w[2] * x[2]).lambda_min;
      texture_at(w[0] * uv[0] + w[1] * uv[1] + w[2] * uv[2]) =
          static_cast<std::uint8_t>(kSteps * min(lambda / kWorthLambda, kMostScore));
    }
  }
}

}  // namespace pliant
