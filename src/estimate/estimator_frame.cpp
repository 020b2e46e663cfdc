// A frame of the estimator: what is expected when it begins, and what is believed when it ends.
#include "pliant/estimator.hpp"

namespace pliant {

void Estimator::begin(std::int64_t time_ns) {
  // What turns a tangent by less is nothing to a template, which allows for more of a warp.
  constexpr float kTangentSlackMm = 0.03f;
  constexpr float kNominal = 1.0f / 30;
  constexpr std::int64_t kLeastStep = 1'000'000, kJump = 2'000'000'000;
  // Times come from outside: their difference may wrap.
  const auto elapsed =
      static_cast<std::int64_t>(static_cast<std::uint64_t>(time_ns) - static_cast<std::uint64_t>(time_ns_));
  const bool repeats = elapsed >= 0 && elapsed < kLeastStep;  // a frame delivered twice
  const bool flows = !repeats && elapsed > 0 && elapsed < kJump;
  seconds_ = flows ? static_cast<float>(elapsed) * 1e-9f : kNominal;
  time_ns_ = time_ns;
  if (!flows && !repeats) motion_.forget_velocities();
  motion_.predict(repeats ? 0.0f : seconds_);
  const bool moves = options_.predicts_motion && bad_frames_ == 0 && flows;
  if (moves) {
    view_ = motion_.view();
    vertices_are_current_ = false;
  }
  expected_view_ = view_;
  for (std::size_t i = 0; i < cascade_.parameter_count(); ++i) {
    const Parameter& p = model().parameters()[i];
    if (moves && range_[i] > 0) q_[i] = clamp(motion_.parameters()[i], p.minimum, p.maximum);
    expected_q_[i] = q_[i];
    sd_[i] = options_.expression_rate * (p.maximum - p.minimum) * min(seconds_, 0.5f);
  }
  expect_motion(seconds_);
  row_count_ = looked_for_ = patches_looked_for_ = patch_inliers_ = 0;
  solves_ = 0;
  had_first_pass_ = needs_another_round_ = rejected_forces_ = false;
  result_.tracked = result_.inliers = result_.iterations = 0;
  result_.rms_px = result_.score = 0;
  result_.pose_is_observed = false;
  ++frame_;
  const std::uint32_t share = options_.tangent_interval_frames > 0 ? options_.tangent_interval_frames : 1;
  cascade_.select(q_, kTangentSlackMm);
  for (std::uint16_t i = 0; i < limits_.points; ++i)
    if (kind_[i] != PointKind::none && (i + frame_) % share == 0) update_tangents(i);
  place_silhouette();
}

/// How far the view may be from where it is expected: the filter's word, held within what heads do, and more after every
/// bad frame. Where its velocity is not used, that motion is uncertain as well.
void Estimator::expect_motion(float seconds) {
  constexpr float kLeast[kPoseUnknowns] = {0.03f, 0.03f, 0.03f, 0.02f, 4, 4};
  constexpr float kMost[kPoseUnknowns] = {0.2f, 0.2f, 0.2f, 0.2f, 40, 40};
  const auto frames = static_cast<float>(1 + bad_frames_);
  for (int k = 0; k < kPoseUnknowns; ++k) {
    const MotionState& s = motion_.pose(k);
    const float still = options_.predicts_motion ? 0.0f : seconds * s.velocity;
    pose_variance_[k] =
        frames * frames * clamp(s.xx + still * still, kLeast[k] * kLeast[k], kMost[k] * kMost[k]);
  }
}

/// Tells the filters how a good frame went.
void Estimator::note_motion() {
  for (std::size_t i = 0; i < cascade_.parameter_count(); ++i) {
    const std::uint16_t column = cascade_.column_of(i);
    trial_q_[i] = column == kNone ? 0.0f : variance_[kPoseUnknowns + column];
  }
  // Both refuse what is not finite, and then stay as they were.
  if (motion_.correct(view_, q_, variance_, trial_q_) != Status::ok)
    motion_.move_to(trusted_view_, trusted_q_);
  if (!options_.smooths) return;
  const Status status =
      smoother_.add(pose_of(view_), q_, range_, cascade_.parameter_count(), seconds_, options_.smoothing);
  if (status == Status::ok) result_.smoothed_pose = smoother_.pose();
}

void Estimator::translate(Vec2 px) {
  if (!is_finite(px)) return;
  view_.tau = view_.tau + (1.0f / view_.s) * px;
  expected_view_.tau = view_.tau;
  vertices_are_current_ = false;
}

void Estimator::propose(const View& view) {
  view_ = expected_view_ = view;
  for (std::size_t i = 0; i < cascade_.parameter_count(); ++i) q_[i] = trusted_q_[i];
  update_vertices(1);
  place_silhouette();
}

/// What the last solve found: enough of what was looked for, near enough, alike enough, and seeing the whole pose.
bool Estimator::is_good() const {
  const float per_width = static_cast<float>(width_) / 320;
  const auto reaches = [](float share, std::size_t part, std::size_t all) {
    return static_cast<float>(part) >= share * static_cast<float>(all);
  };
  const float scale = view_.s / expected_view_.s;
  return result_.inliers >= options_.lost_points && result_.rms_px <= options_.lost_rms_px * per_width &&
         reaches(options_.lost_fraction, result_.inliers, looked_for_) &&
         reaches(options_.lost_fraction, patch_inliers_, patches_looked_for_) &&
         (result_.score == 0 || result_.score >= options_.lost_score) && result_.pose_is_observed &&
         scale <= 1 + options_.lost_scale_change && scale * (1 + options_.lost_scale_change) >= 1;
}

FrameResult Estimator::end() {
  if (!started_) return {};
  const bool good = is_good();
  if (good) {
    equations_.variances(variance_);
    update_cue_scales();
    note_motion();
    follow_view();
    bad_frames_ = 0;
    trusted_view_ = view_;
    for (std::size_t i = 0; i < cascade_.parameter_count(); ++i) trusted_q_[i] = q_[i];
    result_.state = TrackState::tracking;
  } else {
    // Nothing is believed of a bad frame: the next one starts from the last that was good.
    view_ = trusted_view_;
    for (std::size_t i = 0; i < cascade_.parameter_count(); ++i) q_[i] = trusted_q_[i];
    if (bad_frames_ < options_.lost_frames) ++bad_frames_;
    result_.state = bad_frames_ >= options_.lost_frames ? TrackState::lost : TrackState::degraded;
    if (result_.state == TrackState::lost) {
      motion_.move_to(view_, q_);
      smoother_.restart();
    }
  }
  result_.pose = pose_of(view_);
  result_.vertices = static_cast<std::uint16_t>(mesh_.vertex_count());
  update_vertices(good ? options_.vertex_interval_frames : 1);
  return result_;
}

}  // namespace pliant
