#pragma once
// The parameters that move the parts of a face, from what the part readers see (docs/algorithms.md, section 7.19).
#include <cstdint>

#include "face/gaze.hpp"
#include "face/part_points.hpp"
#include "face/part_reader.hpp"
#include "optim/point_row.hpp"
#include "pliant/cascade.hpp"
#include "pliant/lens.hpp"

namespace pliant {

/// Tuning of the fit of parts. Each constant: unit, reason, experiment.
struct PartFitTuning {
  /// A parameter that moves no point by this much over its range is not read, mm. Not tuned.
  float least_range_mm = 1;
  /// Standard deviation of the readings' common shift, mm: what landmarks of a long track are off by, 2.5 %
  /// of the eyes' distance. Not tuned.
  float shift_mm = 2.5f;
  /// The crop follows where the anchors are read: fraction of the way in each frame, and all of it, so many
  /// times, in the start's frame. Crops of portraits left out of training that are off by 0, 2 and 4 mm:
  /// median error of a gap 0.43, 0.50 and 0.60 mm without, 0.40, 0.41 and 0.42 mm with one move, 0.37, 0.39
  /// and 0.37 mm with two. 0.2 is not tuned.
  float centring = 0.2f;
  int start_centrings = 2;
  /// The farthest that a crop moves from where the model puts it, mm: less than from an eye to its brow. Not tuned.
  float most_off_centre_mm = 8;
  /// Standard deviation of a parameter's change in a frame of 1/30 s, fractions of its range: a lid closes in
  /// three frames. 0.25 and 0.5 find the same blinks on the Talking Face video.
  float change = 0.5f;
  /// A parameter that moves the lids against each other by more than this over its range shuts an eye, mm. Its prior
  /// weighs only so much here: it holds back lids that shut for a moment, which tell nothing of how the eye usually is.
  /// Films of 29 portraits left out of training, lids shut for 35 frames: eyeBlink 0.90 (median) with 0.2, 0.85 with 1
  /// (docs/experiments.md, Shut eyes). 5 mm is not tuned.
  float shutting_mm = 5, shutting_prior = 0.2f;
  /// Distance of a crop's middle from the frame's edge, at least, mm: half of an eye. A part that is cut off is read as something
  /// else. Not tuned.
  float least_room_mm = 16;
  /// The time that parameters have to change in before the start, s: long, so that the start does not hold
  /// them. Not tuned.
  float start_s = 1;
  /// A start contradicts the readings where a point is farther from where it is read, mm: half of the way of
  /// a lid that closes. After such a start the face is at rest where no point is farther from its place at
  /// rest. Not tuned.
  float contradiction_mm = 4, rest_mm = 2;
  /// Deviation that the track is given of a parameter, over that of the fit. The fit's own are those of
  /// single parameters, as if templates and edges could tell them apart, and these then outweigh the
  /// readings. On a film of another person, against another library's landmarks, 1 gives gaps with
  /// correlations of 0.870 and 0.815, 0.3 of 0.893 and 0.850.
  float trusted_sd = 0.3f;
  /// Standard deviation of how much more one eye opens than the other, against the start's frame, mm. More by
  /// what it was in the frame before, so that winks stay. Talking Face video, gaps right / left: without 0.83
  /// / 0.70, 0.3 mm 0.82 / 0.79, 0.5 mm 0.83 / 0.79, 1 mm 0.83 / 0.76. Chosen there; rendered people in
  /// docs/experiments.md, Lids.
  float unlike_mm = 0.5f;
};
inline constexpr PartFitTuning kPartFitTuning{};

/// One frame's readings and their fit. Laid out in scratch memory.
class PartFit {
 public:
  void lay_out(Arena& arena, const Model& model);

  /// Reads all parts at a pose.
  /// \param q         all parameters.
  /// \param centring  how far the next crops move to where the anchors are read, 0 to 1.
  void read(const FrameView& frame, const Lens& lens, const View& view, const float* q, float centring,
            PartPoints* points);
  /// Begins a track: which parameters move the points, and how the readings differ from the model at q. If
  /// the readings contradict q (a start with closed eyes, fitted to points that do not tell), the parameters
  /// are fitted instead, and the difference is noted in the first `fit` that finds the face at rest.
  void calibrate(PartPoints* points);
  /// Where the eyes look, by the pupils read: as find_gaze.
  Vec3 gaze(const PartPoints& points);
  /// Fits the parameters to the readings: sets their values and deviations, or leaves all as they are.
  /// \param seconds  since the last fit.
  void fit(float seconds, PartPoints* points);

 private:
  void sense_parameters(const PartPoints& points, const PartSide& side);
  void choose_parameters(PartPoints* points);
  Vec3 evaluate(Vec2 uv, Jacobian* j);
  Vec2 project(Vec2 uv);
  bool read_eye(const PartPoints& points, const PartSide& side, SeenEye* eye);
  Vec2 off_centre(const PartTable& table, const PartSide& side) const;
  float shut_offset(const PartPoints& points, const PartSide& side) const;
  void add_readings(const PartPoints& points, const PartSide& side);
  void step(float seconds, const PartPoints& points);
  void add_symmetry(const PartPoints& points);
  bool solve(float seconds, PartPoints* points);
  void set(const float* values, const PartPoints& points);
  bool is_near(float mm, const float* values, const PartPoints& points);
  void note_offsets(const float* values, PartPoints* points);

  Cascade cascade_;
  NormalEquations equations_;
  PartReader reader_;
  View view_;
  CropMap axes_;  // of an upright crop, px a millimetre
  Lens lens_;
  PartReading* readings_ = nullptr;  // without the lens' distortion
  Vec2* read_mm_ = nullptr;          // the same places, upright crop
  float *q_ = nullptr, *step_ = nullptr, *opens_mm_ = nullptr;
  Vec3* samples_ = nullptr;
  std::uint8_t* is_free_ = nullptr;
  PointRow row_;
};

}  // namespace pliant
