#pragma once
/// \file template_tuning.hpp
/// Tuning of template matching. Each constant: unit, reason, experiment (docs/experiments.md: what other values gave is in Budget
/// for a frame's work, in Templates and key frames for the rest).
#include <cstddef>
#include <cstdint>

namespace pliant {

/// The tracker as a whole.
struct TrackerTuning {
  /// Templates that a start needs, count: twelve coordinates for the six of the pose, and as many to reject
  /// outliers by.
  std::uint16_t least_templates = 6;
  /// The budget of a frame (FrameBudget): the work of so many search steps a template (in frames 320 px wide; in proportion to
  /// the width, since templates are that many more pixels away), passes over all observations, and factorisations. With it
  /// the slowest frame of films with the faults of `pliant bench faults` takes about twice the median (docs/evaluation.md, Work of
  /// a frame). With less turned heads had larger errors; with as few steps in larger frames searches ended early, and the face
  /// trembled.
  float most_steps_a_template = 5.6f, most_passes = 3, most_factorisations = 60;
  /// More of it for springs, passes. A sheet with 12 shapes takes 4 in a usual frame, and evaluates them twice as often. With 3 the
  /// frames that a key frame has waited for ended after one step.
  float most_spring_passes = 8;
  /// More of it where the person is estimated, instructions. With less and with more turned heads had larger errors.
  float most_for_person = 2.35e6f;
  /// Work of a key frame for each pixel that is searched for corners, and for each vertex under them, instructions as
  /// WorkCosts. Counted by callgrind.
  float corner_pixel = 20, corner_vertex = 1750;
  /// Places at which a later key frame tries to capture a template, for each of its slots: what it waits for, and what it makes
  /// if it has waited too long. Key frames of rendered heads need fewer. If they wait for room for 4 only, they come earlier, and
  /// an occluder (tests/system/corruption_test.cpp) and turns with profile S (tests/unit/track/tracker_keys_test.cpp) are followed
  /// worse.
  std::size_t tries_a_slot = 8, tries_if_overdue = 2;
};
inline constexpr TrackerTuning kTrackerTuning{};

/// Which surface points get templates, and when they get a second one.
struct TemplateStoreTuning {
  /// Cosine between surface normal and viewing direction, at least, where a template is captured. Nearer to
  /// the silhouette the window contains background, which does not move with the face. Chosen on the rendered
  /// film of large turns.
  float least_facing = 0.4f;
  /// Normalised cross-correlation below which a template that was found looks different, so that a key frame
  /// adds a second one. Round value, not tuned.
  float second_template_correlation = 0.9f;
  /// Distance from a template's middle at which its bend is measured, over the window's side: inside the
  /// window, near its edge. Round value, not tuned.
  float bend_reach = 0.4f;
  /// Depth of the surface in a window behind its middle, at most, mm. At least it is 0: around hollows, corners of
  /// the eyes and wings of the nose, positions do not follow the paraboloid, and turned heads had larger errors with negative
  /// depths. 3 is a round value: what lies deeper is no paraboloid.
  float most_depth_mm = 3;
  /// Standard deviation of the ramp of light over a window (PatchOptions::ramp_sd) where the head has turned by a right angle
  /// since the key frame, grey levels a mm; less by the sine of the turn. Lamps stay where they are, and so a surface that
  /// curves gets brighter on one side. With it turned heads have a quarter less error. The same ramp from every angle has as small
  /// errors there, but larger ones on the video: a ramp costs information (Tried at turned heads).
  float ramp_grey_per_mm = 1;
  /// The least one that is allowed for, grey levels a px. Round value, not tuned.
  float least_ramp_sd = 0.1f;
  /// Fraction of a key frame's slots that second templates may take, as a divisor: half. Round value, not tuned.
  std::size_t second_template_divisor = 2;
};
inline constexpr TemplateStoreTuning kTemplateStoreTuning{};

/// How templates are matched in a frame.
struct TemplateMatchTuning {
  /// Rounds of predict, match, solve in a frame. The second round matches points again whose predictions the
  /// first round has changed. Not tuned.
  int rounds = 2;
  /// Points in the first pass, count: enough to fix pose and jaw. Chosen on the rendered film with 500 points, where it
  /// saved a third of the instructions of a frame (docs/experiments.md).
  std::size_t first_pass_points = 40;
  /// Points found, for each in the first pass, below which there is none: with fewer it saves no work. Chosen
  /// on the recorded face.
  std::size_t first_pass_least_ratio = 3;
  /// The innovation of the first pass over that of the rest, at least, for a first pass. Below, the model
  /// leaves as much unexplained as the head moves, and a first pass does not make predictions better. Chosen
  /// on the Talking Face video, where a first pass in every frame made the mouth worse.
  float first_pass_least_gain = 1.5f;
  /// Interval in frames at which a first pass that was left out is tried again. Round value, not tuned.
  std::uint32_t first_pass_retry_frames = 16;
  /// Fraction of a point's residual in the last frame that is added to its prediction. Model errors last from frame to
  /// frame; less than all of it, so that a point that slips does not go on slipping. Not tuned.
  float residual_memory = 0.7f;
  /// Steps that the preparation of a search counts as: what callgrind counted for it over what it counted for a step (Budget).
  std::uint32_t preparation_steps = 3;
  /// Normalised cross-correlation with the template, at least, in the last round. Chosen on rendered films
  /// with occluders.
  float min_correlation = 0.55f;
  /// Less than that in earlier rounds, where the warp is predicted from the previous frame's state. Round
  /// value, not tuned.
  float early_correlation_slack = 0.1f;
  /// How far from its start a search may end, px at 320 px of image width: in a point's first search of a
  /// frame, and later. Round values, not tuned.
  float first_reach_px = 16, later_reach_px = 3;
  /// A point is matched again where the window's edge, warped as now predicted, moves by more than this, px.
  /// Not tuned.
  float rematch_warp_px = 0.3f;
  /// A point that was not found is matched again where its prediction moved by more than this, px. Round
  /// value, not tuned.
  float rematch_move_px = 1;
  /// A point that was found is matched again if it is farther than this from its prediction, px at 320 px of
  /// image width. Round value, not tuned.
  float rematch_distance_px = 3;
  /// Expected distance of a point from its prediction, px: this times the last innovation, plus a fraction of
  /// the coarse translation. It sets the first pyramid level of a search whose start is known. Round values,
  /// not tuned.
  float reach_per_innovation = 2, reach_per_coarse_px = 0.1f;
  /// Expected distance up to which the search starts on level 0, and on level 1, px: what each level reaches.
  /// Round values, not tuned.
  float level_0_reach_px = 2, level_1_reach_px = 4;
  /// Weight of an observation by frame-to-frame tracking. It drifts; a quarter lets templates outweigh it.
  /// Round value, not tuned.
  float frame_to_frame_weight = 0.25f;
  /// Frames in a row that a point may be tracked from frame to frame, without its template. Bounds the drift.
  /// Round value, not tuned.
  std::uint8_t frame_to_frame_most = 20;
  /// Forward-backward distance of frame-to-frame tracking, at most, px at 320 px of image width. Not tuned.
  float forward_backward_px = 0.7f;
};
inline constexpr TemplateMatchTuning kTemplateMatchTuning{};

/// Where templates are captured.
struct TemplatePlacementTuning {
  /// Side of a corner cell: the frame's width over this, px; less where a frame has fewer than so many cells a
  /// template, since a face fills a part of it; in any case within a range, px. Round values, not tuned.
  int cells_across = 40, least_cells_a_template = 9, least_cell_px = 4, most_cell_px = 64;
  /// Passes over the image, each with a smaller distance between points than the one before. Not tuned.
  int passes = 6;
  /// That distance, over the one before: about half the area each time. Not tuned.
  float spacing_factor = 0.7f;
  /// Range of that distance, px: two pixels are one corner; find_corners takes at most 256.
  float least_spacing_px = 2, most_spacing_px = 256;
  /// Margin around the image of a face of the mesh in which corners are under it, px: a lens bends its edges. Round value, not
  /// tuned.
  float bend_px = 1;
  /// Ratio of the eigenvalues of a corner's structure tensor, at least. Less than the default of
  /// CornerOptions: most texture of a face is weak, and the information matrix of a match has the direction
  /// in which it is reliable. Not tuned.
  float least_ratio = 0.02f;
  /// Smaller eigenvalue of a corner, at least, (grey/px)^2. As above.
  float least_score = 1;
  /// Fraction of the templates that a start captures whose work is spread over frames, as a divisor; and how many it captures at
  /// least, count, enough for a track where half of them are hidden. The others follow in the next frame (docs/experiments.md,
  /// Budget).
  std::uint16_t start_divisor = 4, least_at_start = 24;
};
inline constexpr TemplatePlacementTuning kTemplatePlacementTuning{};

}  // namespace pliant
