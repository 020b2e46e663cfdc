#include "track/surface_texture.hpp"

namespace pliant {

namespace {

constexpr const SurfaceTextureTuning& kTuning = kSurfaceTextureTuning;

constexpr float kSamples[4][3] = {{1.0f / 3, 1.0f / 3, 1.0f / 3},
                                  {2.0f / 3, 1.0f / 6, 1.0f / 6},
                                  {1.0f / 6, 2.0f / 3, 1.0f / 6},
                                  {1.0f / 6, 1.0f / 6, 2.0f / 3}};

float score_in(void* context, Vec2 uv) {
  return static_cast<const SurfaceTexture*>(context)->score(uv);
}

}  // namespace

void SurfaceTexture::lay_out(Arena& arena, std::uint8_t cells_a_side) {
  side_ = cells_a_side;
  is_on_ = false;
  arena.count_as(Purpose::adaptation);
  cells_ = arena.take<std::uint8_t>(side_ * side_);
}

void SurfaceTexture::start(EstimatorOptions* options) {
  is_on_ = options->mesh_operations > 0 && options->texture.score == nullptr;
  if (!is_on_) return;
  for (std::size_t i = 0; i < side_ * side_; ++i) cells_[i] = 0;
  options->texture.context = this;
  options->texture.score = score_in;
}

std::uint8_t& SurfaceTexture::cell(Vec2 uv) const {
  const auto index = [this](float t) {
    return static_cast<std::size_t>(clamp(t * static_cast<float>(side_), 0, static_cast<float>(side_) - 1));
  };
  return cells_[index(uv.y) * side_ + index(uv.x)];
}

float SurfaceTexture::score(Vec2 uv) const {
  return (1 / kTuning.steps) * static_cast<float>(cell(uv));
}

/// Scores of this frame replace older ones.
void SurfaceTexture::note(const Estimator& estimator, const FrameRegion& region, std::uint32_t frame) {
  if (!is_on_) return;
  const std::uint32_t parts = frame == 0 ? 1 : kTuning.interval_frames, part = frame % parts;
  const Mesh& mesh = estimator.mesh();
  for (FaceId f : mesh.faces()) {
    if (f % parts != part || !faces_camera(mesh, estimator.vertex_images(), f)) continue;
    Vec2 x[3], uv[3];
    for (int k = 0; k < 3; ++k) {
      x[k] = estimator.vertex_seen(mesh.corner(f, k)) - region.origin();
      uv[k] = mesh.uv(mesh.corner(f, k));
    }
    for (const auto& w : kSamples) {
      const float lambda = corner_score(region.pyramid().level(0), w[0] * x[0] + w[1] * x[1] + w[2] * x[2]);
      cell(w[0] * uv[0] + w[1] * uv[1] + w[2] * uv[2]) =
          static_cast<std::uint8_t>(kTuning.steps * min(lambda / kTuning.unit_lambda, kTuning.most_score));
    }
  }
}

namespace {

SurfaceTexture* lay_out(Arena& arena, std::uint8_t cells_a_side) {
  return create_part<SurfaceTexture>(arena, cells_a_side);
}

}  // namespace

const TextureNoting kSurfaceTexture{lay_out, &SurfaceTexture::start, &SurfaceTexture::note};

}  // namespace pliant
