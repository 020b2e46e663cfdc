#pragma once
// Tuned constants of the patch tracker.

namespace pliant::patch {

/// Tuning of template matching. Each constant: unit, reason, experiment. The experiments are the unit tests of the
/// patch tracker (band-limited textures with known motion) and `pliant bench klt` (docs/experiments.md, section
/// Tuning).
struct PatchTuning {
  /// Smallest texture that is matched: eigenvalue of the mean structure tensor without light, (grey/px)^2. Usual
  /// corners have 4 to 100; below 0.5 the noise of a camera dominates. Round value, not tuned.
  float min_eigenvalue = 0.5f;
  /// Smallest variance of a template, grey^2. Below it the gain cannot be distinguished from noise. Round
  /// value, not tuned.
  float min_variance = 4.0f;
  /// Smallest ratio of the eigenvalues for which a 2 x 2 system is solved in float. Guard against singular systems.
  float min_eigenvalue_ratio = 1e-4f;
  /// Ratio of the eigenvalues below which a patch counts as an edge, where edges are accepted. The value that separates
  /// edges from corners in `CornerOptions::min_ratio`.
  float edge_eigenvalue_ratio = 0.05f;
  /// A template is used if at least one pixel in this many is not clipped. Round value, not tuned.
  int min_pixel_divisor = 2;
  /// Grey levels at or beyond which a pixel counts as clipped and is left out. Without this the error on clipped
  /// highlights (gain 1.3, bias -40) was 0.07 px instead of under 0.04 (test "clipped highlights and shadows cost
  /// little").
  int lowest_grey = 5, highest_grey = 250;

  /// Steps of `align` on each level, at most. Round value, not tuned; textures converge in about four.
  int max_align_steps = 10;
  /// Steps of `refine`, at most. Starts within `near_start_px` converge within them; others are diverged.
  int max_refine_steps = 4;
  /// Aimed distance of a result from the minimum, px at full size.
  float epsilon_px = 0.01f;
  /// `align` stops at a step below this times epsilon_px. `refine` continues from there.
  float align_stop_ratio = 20;
  /// `refine` stops at a step below this times epsilon_px. The error after a step is about a tenth of the step.
  float refine_stop_ratio = 10;
  /// A last step of `refine` longer than this times its stopping step means divergence.
  float diverged_step_ratio = 3;
  /// Factor on each step. Scharr gradients smooth: they fall short of the slope by about a tenth on most textures, so
  /// that steps computed from them are too long by as much.
  float step_scale = 0.9f;

  /// Standard deviation of a start up to which the full-size level is refined at once, px. `refine` converges from
  /// there.
  float near_start_px = 0.5f;
  /// Standard deviation of a start up to which one step of `refine` is the rule, px: its first step is then sampled by
  /// cubic convolution, otherwise bilinearly, which is cheaper.
  float one_step_start_px = 0.1f;
  /// A warp that moves the window's edge by no more is not resampled into the template, px of the level. `refine`
  /// allows for it, which costs less and is as exact (test "a template made for another warp serves").
  float unwarped_strain_px = 0.5f;
  /// Standard deviation of the entries of a warp that was not predicted. Allowing for it costs a tenth of the
  /// precision and removes nearly all of the error of a rotation by 1.5 degrees or a stretch by 1 %, which would
  /// exceed that of noise of three grey levels. No sweep of the value itself is recorded.
  float warp_sd = 0.03f;
  /// Ratio of the ramps that a kept template's equations allow for and that a search asks for, at least. Round value,
  /// not tuned.
  float least_ramp_ratio = 0.6f;
  /// Noise of a pixel that the weights of the priors of warp and ramp assume, grey levels.
  float prior_noise_grey = 2.0f;
  /// A pivot below this fraction of its diagonal entry means a singular system. Guard, not tuned.
  float min_pivot_ratio = 1e-4f;

  /// Gain and bias of the light that are accepted. With 0.5 to 2 a recorded face was lost when the light fell
  /// to 0.48 of that of the templates, as long as it lasted; with 0.2 to 5 it is tracked through 0.3 and 3
  /// with the error of even light (docs/evaluation.md, Faults). Beyond, a template of 8 bits has few grey
  /// levels left.
  float min_gain = 0.2f, max_gain = 5.0f;
  /// Least gain that a step of `align` assumes. Far from the minimum the gain that fits is small whatever the
  /// light, and its steps would be too long: with 0.2 five of the shifts by 9 px (test "shifts of 0.1 to 9
  /// pixels") are not found. In weaker light its steps are short instead.
  float least_step_gain = 0.5f;
  float max_bias_grey = 80.0f;
  /// Noise of a pixel that the information assumes at least, grey levels: rounding and small model errors.
  float noise_floor_grey = 1.0f;
  /// Standard deviation that no result claims to be better than, px: the error on textures without noise is 0.01 to
  /// 0.02 (test "shifts of 0.1 to 9 pixels").
  float position_floor_px = 0.02f;
  /// Gradients must exceed what noise alone makes by this factor for a row of information. 2 gives no rows on noise
  /// alone (test "on even grey, on noise and on one pixel no flow is found").
  float min_gradient_to_noise = 2;
};
inline constexpr PatchTuning kPatchTuning{};

}  // namespace pliant::patch
