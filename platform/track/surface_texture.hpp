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

/// A grid over (u,v), a byte a cell. Without cells it does nothing.
class SurfaceTexture {
 public:
  void lay_out(Arena& arena, std::uint8_t cells_a_side);
  /// Clears the grid and offers its score to the mesh's criterion, unless the options have one or the mesh stays.
  void start(EstimatorOptions* options);
  /// Notes every face that turns to the camera (frame 0).
  void note_all(const Estimator& estimator, const FrameRegion& region) { note(estimator, region, 0, 1); }
  /// Notes those of this frame: one face in interval_frames.
  void note_frame(const Estimator& estimator, const FrameRegion& region, std::uint32_t frame) {
    note(estimator, region, frame % kSurfaceTextureTuning.interval_frames,
         kSurfaceTextureTuning.interval_frames);
  }
  /// 0 to most_score.
  float score(Vec2 uv) const;

 private:
  void note(const Estimator& estimator, const FrameRegion& region, std::uint32_t part, std::uint32_t parts);
  std::uint8_t& cell(Vec2 uv) const;

  std::uint8_t* cells_ = nullptr;
  std::size_t side_ = 0;
  bool is_on_ = false;
};

}  // namespace pliant
