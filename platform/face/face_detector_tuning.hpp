#pragma once
// Tuned constants of the face detector.
#include <cstddef>

#include "pliant/geometry.hpp"

namespace pliant {

/// Tuning of the face detector. Each constant has its unit. All values were set on rendered faces
/// (tests/unit/face/face_detector_test.cpp); none was tuned further.
struct FaceDetectorTuning {
  /// Turns of the head between templates, radians. A template covers about half of it to either side.
  float yaw_step_rad = 0.32f, pitch_step_rad = 0.2f, roll_step_rad = 0.28f;
  /// Ratio of two searched sizes.
  float scale_step = 1.15f;
  /// Candidates closer than this fraction of a template's side are the same face.
  float same_place_fraction = 0.2f;
  /// Added to the squared length of each pixel's direction: an even area then has a similarity of zero.
  float even_energy = 400;

  /// Smallest similarity of a landmark's surroundings.
  float min_landmark_similarity = 0.2f;
  /// Taken off the similarity for a displacement, times its square, 1/px^2: of equals, the closest to the rendered
  /// position.
  float distance_penalty = 0.002f;
  /// Standard deviation of a landmark whose surroundings are exactly as rendered, px of the rendered template.
  float landmark_sd_px = 0.6f;

  /// Size of the inner face relative to the frame's height that the templates are rendered for; sets their perspective.
  float usual_fraction = 0.35f;
  /// Rounds of fitting pose alone, for each candidate, and of fitting pose and parameters, for the best ones.
  int pose_rounds = 2, full_rounds = 3;
  /// Search range around a landmark in each round, px of the rendered template.
  int reach_px[5] = {6, 5, 4, 3, 3};
  /// In the first rounds only every n-th landmark is searched, to save time. This is n.
  std::size_t pose_landmark_step = 2;
  /// Candidates that are fitted fully, at most, and the similarity that a second one needs relative to the first.
  std::size_t full_candidates = 2;
  float second_candidate_fraction = 0.6f;
  /// Iterations of a fit, at most.
  int fit_iterations = 12;

  /// Margins of the region around lids, brows and lips in which faces and other objects differ most, mm: at the sides and
  /// above, and below.
  float margin_beside_mm = 6, margin_below_mm = 10;
  /// Pixels along the silhouette that do not count, px: the background behind them is unknown.
  int silhouette_margin_px = 3;
  /// Rendering: fraction of the light that comes from everywhere, and the grey level of the background.
  float ambient_light = 0.4f;
  int background_grey = 110;
  /// Directions to the lamp in camera coordinates: from above, and from above to either side.
  Vec3 lights[3] = {{0, -0.6f, -0.8f}, {-0.6f, -0.4f, -0.69f}, {0.6f, -0.4f, -0.69f}};
};
inline constexpr FaceDetectorTuning kFaceDetectorTuning{};

}  // namespace pliant
