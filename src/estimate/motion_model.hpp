#pragma once
// The prediction of the next frame: state, uncertainty, and smoothed output (docs/algorithms.md, section 7.10).
#include <cstdint>

#include "estimate/model_state.hpp"
#include "pliant/cascade.hpp"
#include "pliant/estimator_options.hpp"
#include "pliant/filter.hpp"

namespace pliant {

/// The expected state of a frame: the mean and standard deviations of the temporal prior.
struct ExpectedState {
  ModelState mean;
  float pose_variance[kPoseUnknowns] = {};  ///< in PoseUnknown's order and units
  float* parameter_sd = nullptr;            ///< of each parameter
};

/// Tuning of the temporal prior.
struct MotionModelTuning {
  /// Least and largest standard deviation of the expected pose: turns (rad), log scale, shifts (mm). The least values keep
  /// the prior weak at high frame rates. The largest keep the search ranges bounded after a pause. Chosen by hand from
  /// what heads do in a thirtieth of a second; not optimised.
  float least_sd[kPoseUnknowns] = {0.03f, 0.03f, 0.03f, 0.02f, 4, 4};
  float most_sd[kPoseUnknowns] = {0.2f, 0.2f, 0.2f, 0.2f, 40, 40};
  /// Ranges per second by which a parameter misses what its velocity leads to, one standard deviation. What misses by more counts
  /// by Huber's loss. What crosses its range in a tenth of a second is followed better than with 2.5 and a mean without velocity,
  /// and the recorded face trembles less (docs/experiments.md, Change of parameters).
  float parameter_rate = 2.2f;
  /// s. Longest time over which `parameter_rate` acts. Round value, not tuned.
  float longest_parameter_time = 0.5f;
  /// Least standard deviation of a parameter's change, in its unit: it divides, and a range may be empty. Round value.
  float least_parameter_sd = 1e-6f;
  /// s. Time step of a first frame, and of one whose time does not follow the frame before.
  float nominal_step = 1.0f / 30;
  /// ns. A frame that follows by less repeats the frame before.
  std::int64_t least_step_ns = 1'000'000;
  /// ns. A frame that follows by this or more is a new scene: velocities are forgotten. Round value, not tuned.
  std::int64_t jump_ns = 2'000'000'000;
};
inline constexpr MotionModelTuning kMotionModelTuning{};

/// Motion filter, expected state and smoothed output. Bytes: 44 a parameter.
class MotionModel {
 public:
  void lay_out(Arena& arena, std::size_t parameters);

  /// Starts at rest at `state`, with the options on time, prediction and smoothing. Parameters without a column in `cascade` are
  /// not filtered. \return the statuses of MotionFilter::start.
  Status start(const Cascade& cascade, const ModelState& state, const EstimatorOptions& options);
  /// Predicts the state at `time_ns`. If the options ask for it and the last frame was good, `state` is moved there;
  /// otherwise it stays. The expected state is `state` afterwards, but for parameters: after a good frame they are expected where
  /// their velocities lead.
  /// \param bad_frames  frames since the last good one; widens the uncertainty.
  /// \return whether `state` moved.
  bool predict(std::int64_t time_ns, int bad_frames, const Cascade& cascade, ModelState* state);
  /// Replaces the mean of the expected view, of its offset alone, or of one parameter.
  void expect(const View& view) { expected_.mean.view = view; }
  void expect_offset(Vec2 tau) { expected_.mean.view.tau = tau; }
  void expect(std::size_t parameter, float value) { expected_.mean.q[parameter] = value; }
  void expect(std::size_t parameter, float value, float sd) {
    expected_.mean.q[parameter] = value;
    expected_.parameter_sd[parameter] = sd;
  }
  /// Corrects the filter by the result of a good frame.
  /// \param variance  of each unknown of the solve: pose, then the columns of `cascade`.
  /// \param trusted   the state to continue from, at rest, if the result is not finite.
  void correct(const Cascade& cascade, const ModelState& state, const float* variance,
               const ModelState& trusted);
  /// Continues from `state` at rest: it was measured in another way.
  void move(const ModelState& state);
  /// The model has been turned by this rotation, in the axes of Pose::q: a filter at rest, and a smoothed output that turns with
  /// it.
  void turn(const ModelState& state, Quat by);
  /// As `move`, without a sample of the smoothed output: the track is lost.
  void rest(const ModelState& state);

  const ExpectedState& expected() const { return expected_; }
  const MotionFilter& filter() const { return filter_; }
  /// The smoothed pose, if `start` asked for it; else the default pose.
  Pose smoothed_pose() const { return smooths_ ? smoother_.pose() : Pose{}; }
  const float* smoothed_parameters() const { return smoother_.parameters(); }

 private:
  void smooth(const ModelState& state);
  void expect_parameter_sd(const Cascade& cascade);
  void expect_pose_variance(int bad_frames);

  MotionFilter filter_;
  Smoother smoother_;
  ExpectedState expected_;
  std::int64_t time_ns_ = kNoTime;  // of the last frame
  float seconds_ = 0;               // since the last frame
  float since_sample_ = 0;          // s, since the smoother's last sample: bad frames give none
  float* scratch_ = nullptr;        // a value a parameter
  std::size_t count_ = 0;
  bool predicts_motion_ = false, smooths_ = false;
};

}  // namespace pliant
