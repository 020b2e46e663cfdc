#pragma once
// The points that the part readers see, in a model, and what is known of the person (docs/algorithms.md, section 7.19).
#include <cstdint>

#include "face/part_table.hpp"
#include "pliant/camera.hpp"
#include "pliant/model.hpp"

namespace pliant {

constexpr std::size_t kMostPartReadings = 48;    // points of all parts, both sides
constexpr std::size_t kMostPartParameters = 32;  // that they move

/// One side of a part, as a model has it.
struct PartSide {
  std::uint8_t part = 0, count = 0;  // of the table; points
  bool is_left = false;
  bool is_seen = false;     // in the last frame, by an uncut crop
  std::uint16_t first = 0;  // of its points
  Vec2 anchor[2];           // (u,v)
  Vec2 centre_mm;           // of the crop, from where the model puts it; upright crop
  float open_mm = 0;        // between the lids, as read when the offsets were noted; 0: not yet, or the part is no eye
};

/// The points that the table's parts read, in a model; and what is known of the person. Kept while there is a track.
struct PartPoints {
  PartTable table;
  PartSide side[2 * kMostParts];
  std::size_t side_count = 0, count = 0;
  Vec2 uv[kMostPartReadings];                      // finite; unused for a pupil
  std::uint16_t landmark[kMostPartReadings] = {};  // of the model; kNone: the point is not fitted
  std::int8_t lid[kMostPartReadings] = {};         // 1: of the upper lid, -1: of the lower one
  // Of the reading from the model's point in the start's frame, upright crop.
  Vec2 offset_mm[kMostPartReadings] = {};
  std::uint16_t parameter[kMostPartParameters] = {};
  float last[kMostPartParameters] = {};   // values
  float sd[kMostPartParameters] = {};     // of `last`; 0: nothing was read
  float start[kMostPartParameters] = {};  // values in the start's frame
  // The right eye's lids more than the left one's, a unit of the parameter.
  float opens_mm[kMostPartParameters] = {};
  std::size_t parameter_count = 0;
  Vec3 gaze;                   // smoothed, in the model's axes; 0: not seen
  bool are_seen = false;       // all sides
  bool is_calibrated = false;  // false: the offsets are unknown and 0

  /// \return the table's status; not_found if the model lacks points.
  Status open(const Model& model);
  bool is_fitted(std::size_t k) const { return landmark[k] != kNone; }
  /// Weight of a point's height in the gap between the lids, which have two points each.
  float in_gap(std::size_t k) const { return 0.5f * static_cast<float>(lid[k]); }
  /// The model's points have moved against the readings, as landmarks against theirs. \param moved  of each
  /// landmark of the model, mm, model's axes.
  void move(const View& view, const Vec3* moved);
};

}  // namespace pliant
