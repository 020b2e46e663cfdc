#pragma once
// A change of the tracked person: prepared in several frames and made in one (docs/algorithms.md, section 7.20).
#include "pliant/arena.hpp"
#include "pliant/model.hpp"
#include "pliant/tracker_limits.hpp"

namespace pliant {

struct TrackerParts;

/// A change of the person during a track, which is prepared over several frames.
struct PersonStep {
  bool is_under_way = false;
  Vec3 turn;                        // rotation of the start that the step adds
  float* q = nullptr;               // all parameters; the identity is that after the step
  std::uint32_t count = 0;          // of the steps made
  std::uint32_t changed_frame = 0;  // in which the last one was

  Vec2* uv = nullptr;                // of templates after the step, by slot
  std::size_t prepared = 0;          // slots
  std::uint32_t prepared_frame = 0;  // in which this began

  void lay_out(Arena& arena, const Model& model, const TrackerLimits& limits);
  /// A track begins: no step yet.
  void start();
};

/// Where landmarks and markers are seen in frame 0 before a step, so that they stay there.
struct StepPlaces {
  Vec2 *landmarks = nullptr, *markers = nullptr;
  Vec3* moved = nullptr;  // by how much that changes the landmarks' offsets

  void lay_out(Arena& arena, const Model& model, const TrackerLimits& limits);
};

/// Of one record's work, that of a whole cascade.
inline float of_cascade(const Model& model, float work) {
  return work * static_cast<float>(model.cascade().count);
}

/// Begins a step whose q and turn are set.
void begin_step(TrackerParts& tracker, PersonStep* step);
/// Prepares templates, as many as a frame may and has room for. A key frame that is kept meanwhile has others: then all are
/// prepared again. \return whether all are.
bool prepare_step(TrackerParts& tracker, PersonStep* step);
/// Whether no vertex is still to be sampled again after the last step. A step in such a frame would add to that work.
bool is_settled(const TrackerParts& tracker, const PersonStep& step);
/// Changes the person. Every template, landmark, marker and part of the face stays where its key frame showed it.
/// \return false: the estimator refused it, and nothing but templates has moved.
bool take_step(TrackerParts& tracker, PersonStep* step);

}  // namespace pliant
