#pragma once
// What a FaceAligner keeps in the arena: the table, the pass over a face, and the alignment that is under way.
#include "face/aligner_pass.hpp"
#include "pliant/face_aligner.hpp"

namespace pliant {

/// Tuning of an alignment. Each constant: unit, reason, experiment.
struct AlignmentTuning {
  /// Fraction of the table's landmarks that a model needs. Not tuned.
  float least_landmarks = 0.75f;
  /// Largest side of a box, and largest principal point, px: beyond, single precision has no pixels.
  float most_px = 1e5f;
  /// Second score, at least, for the first one to count (AlignOptions::is_scored_twice). With 0.1 as many frames of films of
  /// portraits are right, with 0.7 up to 7 % fewer in shadows of trees (docs/experiments.md, Searches and first checks).
  float least_second_score = 0.3f;
};
inline constexpr AlignmentTuning kAlignmentTuning{};

/// One alignment or verification: input, start, steps, result. Calls check nothing that `check_input` has checked.
struct Alignment {
  AlignerTable* table = nullptr;  // in the arena, so that this object stays small
  Status status = Status::not_found;
  AlignerUse use = AlignerUse::alignment;
  AlignerPass pass;
  float* start_q = nullptr;
  /// An alignment that has begun: from where, and the steps that are left.
  struct Begun {
    Lens lens;
    View start_view;
    Camera camera;
    int width = 0, height = 0;  // of its frames
    bool refines = false;
    std::size_t next_stage = 0;
    int steps_left = 0;
    bool is_scored_twice = false;  // as AlignOptions; the score as it was taken first
    float first_score = 0;
  };
  Begun* begun = nullptr;  // in the arena, for the same reason

  void lay_out(Arena& arena, const Model& model, Span<const std::uint8_t> bytes, AlignerUse use);
  const Model& model() { return pass.shape().cascade().model(); }

  /// Ends the alignment begun, and sets `begun->camera` and `begun->lens`: what the calls below take.
  Status check_input(const FrameView& frame, const Camera& camera, const float* q, const AlignedFace* face);
  bool has_room(Span<Vec2> landmarks) {
    return landmarks.empty() || landmarks.count >= model().landmarks().count;
  }
  /// Sets begun->start_view, for the parameters start_q.
  Status start_in_box(const FrameView& frame, const FaceBox& box, float roll);
  Status start_at_pose(const FrameView& frame, const Pose& pose);

  /// Begins at begun->start_view, with start_q.
  Status begin(const FrameView& frame, const AlignOptions& options, bool refines);
  Status begin_in_box(const FrameView& frame, const FaceBox& box, const float* q,
                      const AlignOptions& options);
  /// Takes steps in a frame; the last one writes the results.
  Status take_steps(const FrameView& frame, int steps, AlignedFace* face, float* q, Span<Vec2> landmarks);
  /// Score and landmark error at the present pose.
  AlignedFace conclude();

 private:
  bool run_next_step();
  void write_landmarks(Span<Vec2> landmarks);
};

}  // namespace pliant
