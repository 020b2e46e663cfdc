// The aligner's calls: each checks its input, then begins an alignment (alignment.hpp) and takes its steps.
#include "pliant/face_aligner.hpp"

#include "base/arrays.hpp"
#include "face/alignment.hpp"

namespace pliant {

struct FaceAligner::State : Alignment {};

void FaceAligner::lay_out(Arena& arena, const Model& model, Span<const std::uint8_t> table) {
  state_ = create_part<State>(arena, model, table, AlignerUse::alignment);
}

void FaceAligner::lay_out_spread(Arena& arena, const Model& model) {
  state_ = create_part<State>(arena, model, model.aligner(), AlignerUse::spread_alignment);
  if (state_ != nullptr && state_->status == Status::ok) state_->status = Status::capacity;
}

void FaceAligner::lay_out_scratch(Arena& scratch) {
  if (state_ == nullptr || state_->use != AlignerUse::spread_alignment) return;
  state_->pass.lay_out_scratch(scratch);
  if (state_->status == Status::ok || state_->status == Status::capacity)
    state_->status = scratch.exhausted() || scratch.is_measuring() ? Status::capacity : Status::ok;
}

std::size_t FaceAligner::scratch_bytes(const Model& model) {
  Arena arena;
  AlignerPass pass;
  pass.lay_out(arena, model, landmark_room(model.aligner()), AlignerUse::spread_alignment);
  const std::size_t kept = arena.used_bytes();
  pass.lay_out_scratch(arena);
  return arena.used_bytes() - kept;
}

void FaceAligner::lay_out_for_known_person(Arena& arena, const Model& model) {
  state_ = create_part<State>(arena, model, model.aligner(), AlignerUse::known_person);
}

Status FaceAligner::status() const {
  return state_ == nullptr ? Status::not_found : state_->status;
}

Status FaceAligner::begin(const FrameView& frame, const FaceBox& box, const Camera& camera, const float* q,
                          int* steps, const AlignOptions& options) {
  if (state_ == nullptr) return Status::not_found;
  State& s = *state_;
  AlignedFace unused;
  Status status = s.check_input(frame, camera, q, &unused);
  if (status == Status::ok && steps == nullptr) status = Status::bad_argument;
  if (status == Status::ok) status = s.begin_in_box(frame, box, q, options);
  if (status == Status::ok) *steps = s.begun->steps_left;
  return status;
}

Status FaceAligner::advance(const FrameView& frame, int steps, AlignedFace* face, float* q,
                            Span<Vec2> landmarks) {
  if (state_ == nullptr) return Status::not_found;
  State& s = *state_;
  if (s.status != Status::ok) return s.status;
  if (s.begun->steps_left == 0) return Status::not_started;
  if (q == nullptr || face == nullptr || check(frame) != Status::ok || !s.has_room(landmarks))
    return Status::bad_argument;
  if (frame.width != s.begun->width || frame.height != s.begun->height) return Status::size_mismatch;
  return s.take_steps(frame, steps, face, q, landmarks);
}

Status FaceAligner::align(const FrameView& frame, const FaceBox& box, const Camera& camera, AlignedFace* face,
                          float* q, Span<Vec2> landmarks, const AlignOptions& options) {
  if (state_ == nullptr) return Status::not_found;
  State& s = *state_;
  Status status = s.check_input(frame, camera, q, face);
  if (status == Status::ok && !s.has_room(landmarks)) status = Status::bad_argument;
  if (status == Status::ok) status = s.begin_in_box(frame, box, q, options);
  return status == Status::ok ? s.take_steps(frame, s.begun->steps_left, face, q, landmarks) : status;
}

Status FaceAligner::refine(const FrameView& frame, const Camera& camera, const Pose& start, AlignedFace* face,
                           float* q, Span<Vec2> landmarks, const AlignOptions& options) {
  if (state_ == nullptr) return Status::not_found;
  State& s = *state_;
  Status status = s.check_input(frame, camera, q, face);
  if (status != Status::ok) return status;
  const std::size_t parameters = s.model().parameters().count;
  if (!s.has_room(landmarks) || !are_finite(q, parameters)) return Status::bad_argument;
  status = s.start_at_pose(frame, start);
  if (status != Status::ok) return status;
  copy(q, parameters, s.start_q);
  status = s.begin(frame, options, true);
  return status == Status::ok ? s.take_steps(frame, s.begun->steps_left, face, q, landmarks) : status;
}

Status FaceAligner::verify(const FrameView& frame, const Camera& camera, const Pose& pose, const float* q,
                           AlignedFace* face) {
  if (state_ == nullptr) return Status::not_found;
  State& s = *state_;
  Status status = s.check_input(frame, camera, q, face);
  if (status != Status::ok) return status;
  if (!are_finite(q, s.model().parameters().count)) return Status::bad_argument;
  status = s.start_at_pose(frame, pose);
  if (status != Status::ok) return status;
  if (!s.pass.start(frame, s.begun->lens, s.begun->start_view, q, nullptr)) return Status::not_found;
  *face = s.conclude();
  face->pose = pose;
  return Status::ok;
}

}  // namespace pliant
