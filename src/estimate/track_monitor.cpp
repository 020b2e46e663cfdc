#include "estimate/track_monitor.hpp"

namespace pliant {

namespace {

bool reaches(float fraction, std::size_t part, std::size_t all) {
  return static_cast<float>(part) >= fraction * static_cast<float>(all);
}

}  // namespace

bool TrackMonitor::is_good(const SolveResult& result, float scale_ratio) const {
  const TrackMonitorTuning& t = kTrackMonitorTuning;
  const float per_width = static_cast<float>(width_) / kNominalWidthPx;
  const bool enough = result.inliers >= t.least_inliers &&
                      reaches(t.least_inlier_fraction, result.inliers, result.searched) &&
                      reaches(t.least_inlier_fraction, result.patch_inliers, result.patches_searched);
  const bool fits = result.rms_px <= t.most_rms_px * per_width &&
                    (result.score == 0 || result.score >= t.least_score) && result.pose_is_observed;
  return enough && fits && scale_ratio <= 1 + t.most_scale_change &&
         scale_ratio * (1 + t.most_scale_change) >= 1;
}

TrackState TrackMonitor::add(bool is_good) {
  const int most = kTrackMonitorTuning.lost_after_frames;
  if (is_good) {
    bad_frames_ = 0;
    return TrackState::tracking;
  }
  if (bad_frames_ < most) ++bad_frames_;
  return bad_frames_ >= most ? TrackState::lost : TrackState::degraded;
}

}  // namespace pliant
