#pragma once
/// \file template_matcher.hpp
/// Where templates are searched for in a frame, and what their matches become: observations for the solver.
#include <cstddef>
#include <cstdint>

#include "pliant/estimator.hpp"
#include "pliant/frame_work.hpp"
#include "pliant/tracker_limits.hpp"
#include "track/template_store.hpp"

namespace pliant {

/// Value of an unknown distance, px. Longer than any distance in a frame.
constexpr float kUnknownPx = 1e9f;

/// Predictions, found by the id of the surface point.
struct PredictionTable {
  Span<const Prediction> all;
  const std::uint16_t* index;  ///< by id
  const Prediction& operator[](std::uint16_t id) const { return all[index[id]]; }
};

/// What a frame's matching reads, and where its observations go: one a point, in order of slots.
struct MatchFrame {
  TemplateStore& templates;
  const FrameRegion& region;
  Span<Observation> observations;
  KeyDepths depths = {};  ///< of the estimator's view
};

/// Where the searches of a frame begin: where the filter expects the face; where an alignment of this frame has it, from which they
/// go on once, at full size; or there are none.
enum class SearchFrom : std::uint8_t { prediction, alignment, nowhere };

/// Matches the templates of a store, frame by frame: begin_frame, perhaps run_first_pass, rounds of match, end_frame.
class TemplateMatcher {
 public:
  void lay_out(Arena& arena, const TrackerLimits& limits);
  /// Before frame 1. \param uses_frame_to_frame  whether points may be tracked from the previous frame.
  void start(bool uses_frame_to_frame);

  /// \param is_trusted  the last frame was tracked.
  /// \param coarse_px   length of the coarse translation; kUnknownPx if none was found.
  void begin_frame(std::uint32_t frame, bool is_trusted, float coarse_px,
                   SearchFrom from = SearchFrom::prediction);
  /// \param most_steps  of the searches of this frame, over which they end.
  void limit_steps(std::uint32_t most_steps) { most_steps_ = most_steps; }
  /// Matches a subset of the points, spread over the surface and another one in each frame, and lets the
  /// estimator move to them, so that the other predictions become more accurate.
  /// \return false, and nothing has moved, where there are too few points, where it does not pay, or where
  ///         the estimator doubts the result.
  bool run_first_pass(const MatchFrame& frame, Estimator& estimator);
  /// Matches, in round 0 or 1, the points for which another search can give more than the last one did, and
  /// tracks points from the previous frame whose template was not found in the last round.
  /// \return how many points were searched for.
  std::size_t match(const MatchFrame& frame, const PredictionTable& predictions, int round);
  /// Searches and their steps, of this frame.
  const FrameWork& work() const { return work_; }
  /// Observations of the frame, one a point.
  std::size_t observation_count() const { return count_; }
  /// Notes in the store where points were found, as the last solve left them.
  void end_frame(const MatchFrame& frame, bool is_good);

 private:
  /// Of a point in this frame, by the slot of its first template.
  struct Search {
    std::uint16_t observation = 0;
    bool is_pending = false;     // not searched for yet
    bool is_first_pass = false;  // searched for in the first pass
    Vec2 expected;               // where the first search started, less the residual's place: px
    Vec2 prediction;             // of the last search, px
    Mat2 jacobian;               // and its dx/d(u,v)
  };
  enum class Action : std::uint8_t { none, search, track_from_previous };

  bool should_run_first_pass(std::size_t ratio) const;
  Action action(const Search& search, const Observation& last, const Prediction& p, int round) const;
  void search_for(const MatchFrame& frame, std::size_t k, const Prediction& p, int round);
  Observation search(const MatchFrame& frame, std::size_t k, const Prediction& p, int round);
  Observation track_from_previous(const MatchFrame& frame, std::size_t k, const Prediction& p);
  void count(const PatchResult& result, std::uint32_t searches);
  PatchOptions search_options(const Template& point, bool is_pending, int round) const;
  int first_level() const;

  FrameWork work_;
  std::uint32_t most_steps_ = 0;
  Search* searches_ = nullptr;  // of one frame: other parts may use the memory between frames
  std::size_t capacity_ = 0, count_ = 0;
  int frame_width_ = 0;    // px
  float half_window_ = 0;  // px
  bool uses_frame_to_frame_ = false, is_trusted_ = false, is_aligned_ = false, had_first_pass_ = false;
  std::uint32_t frame_ = 0;
  // Root mean square distance of points from where they were expected in the last frame, px: of those
  // searched for first, and of those after a first pass.
  float innovation_px_ = kUnknownPx, later_innovation_px_ = kUnknownPx;
  float coarse_px_ = kUnknownPx;
};

}  // namespace pliant
