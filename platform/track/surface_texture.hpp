#pragma once
/// \file surface_texture.hpp
/// How much texture the image shows where on the surface, over (u,v): an adaptive mesh refines more there
/// (docs/algorithms.md, section 2.5).
#include <cstdint>

#include "pliant/corners.hpp"
#include "pliant/criteria.hpp"
#include "pliant/estimator.hpp"
#include "track/frame_region.hpp"

namespace pliant {

/// Tuning of the texture score. Each constant: unit, reason, experiment.
struct SurfaceTextureTuning {
  /// Eigenvalue of the structure tensor that scores 1, (grey/px)^2. The same as the threshold of a corner.
  float unit_lambda = CornerOptions{}.min_score;
  /// Highest score, and stored steps for a score of 1: 64 values fit into a byte. Round values, not tuned.
  float most_score = 4, steps = 16;
  /// Number of frames in which each face is noted once. The texture of a face changes slowly. Round value, not tuned.
  std::uint32_t interval_frames = 32;
};
inline constexpr SurfaceTextureTuning kSurfaceTextureTuning{};

/// A grid over (u,v), a byte a cell.
class SurfaceTexture {
 public:
  /// \param cells_a_side  at least 1.
  void lay_out(Arena& arena, std::uint8_t cells_a_side);
  /// Clears the grid and offers its score to the mesh's criterion, unless the options have one or the mesh stays.
  void start(EstimatorOptions* options);
  /// Notes the faces that turn to the camera: all of them in frame 0 of a track, then one face in interval_frames.
  void note(const Estimator& estimator, const FrameRegion& region, std::uint32_t frame);
  /// 0 to most_score.
  float score(Vec2 uv) const;

 private:
  std::uint8_t& cell(Vec2 uv) const;

  std::uint8_t* cells_ = nullptr;
  std::size_t side_ = 0;
  bool is_on_ = false;
};

/// Makes a grid, and a tracker's calls to it (`kSurfaceTexture`, tracker_limits.hpp).
struct TextureNoting {
  SurfaceTexture* (*lay_out)(Arena& arena, std::uint8_t cells_a_side);
  void (SurfaceTexture::*start)(EstimatorOptions* options);
  void (SurfaceTexture::*note)(const Estimator& estimator, const FrameRegion& region, std::uint32_t frame);
};

}  // namespace pliant
