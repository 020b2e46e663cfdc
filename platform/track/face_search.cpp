#include "track/face_search.hpp"

#include "base/arrays.hpp"
#include "face/box_selection.hpp"
#include "face/ibug_landmarks.hpp"
#include "track/detection_state.hpp"
#include "track/landmark_fit.hpp"

namespace pliant {

namespace {

constexpr const FaceSearchTuning& kTuning = kFaceSearchTuning;

FaceDetectorLimits detector_limits(const TrackerLimits& limits) {
  FaceDetectorLimits l;
  l.width = limits.width;
  l.height = limits.height;
  l.smallest_px = limits.smallest_face_px;
  return l;
}

/// Of a probability.
float odds(float probability) {
  return probability / max(1 - probability, kTuning.least_contrary);
}

}  // namespace

void FaceSearch::lay_out(Arena& arena, const Model& model, const TrackerLimits& limits) {
  modules_ = limits.detection->modules;
  model_ = model;
  limits_ = detector_limits(limits);
  work_ = limits.search_work;
  const std::size_t parameters = model.parameters().count;
  q_ = arena.take<float>(parameters);
  reference_.lay_out(arena, model);
  is_expression_ = arena.take<std::uint8_t>(parameters);
  landmarks_ = arena.take_span<Vec2>(model.landmarks().count);
  if (is_expression_ == nullptr) return;
  for (std::size_t k = 0; k < parameters; ++k)
    is_expression_[k] = model.parameters()[k].group == Group::expression;
}

Status FaceSearch::lay_out_search(const SearchInput& input) {
  Arena arena(input.block.data, input.block.count);
  const Camera* const camera = input.options.camera;
  detector_ = modules_->lay_out_detector(arena, model_, limits_, last_rotation_,
                                         camera == nullptr ? 1 : camera->aspect);
  is_complete_ = true;
  aligner_ = modules_->lay_out_aligner(arena, model_);
  PLIANT_ASSERT(detector_ != nullptr && aligner_ != nullptr);  // search_bytes
  const Status status = modules_->status(*detector_, *aligner_);
  if (status != Status::ok) detector_ = nullptr;
  return status == Status::not_found ? Status::bad_table : status;
}

/// The next frame is searched, whatever was found before.
void FaceSearch::begin_again() {
  is_aligning_ = false;
  candidates_.clear();
  times_seen_ = steps_left_ = 0;
}

void FaceSearch::begin() {
  detector_ = nullptr;
  begin_again();
  if (last_.side > 0 && spreads_work()) {
    candidates_.add_place(last_);
    is_aligning_ = true;
    whom_ = Whom::known;
    is_of_one_frame_ = false;
  }
  last_ = {};
}

Status FaceSearch::search(const SearchInput& input, KnownPerson* person, StartPose* start,
                          float* landmark_error) {
  Status status = detector_ == nullptr ? lay_out_search(input) : Status::ok;
  const bool was_searching = !is_aligning_;
  if (status == Status::ok && was_searching) status = run_detector(input.frame);
  if (status != Status::ok) return status;
  if (was_searching && spreads_work()) return Status::not_found;
  int steps = steps_of(work_);
  Answer answer = Answer::no;
  while (steps > 0 && is_aligning_ && answer == Answer::no)
    answer = align(input, &steps, person, start, landmark_error);
  return answer == Answer::yes ? Status::ok : Status::not_found;
}

/// Goes on with the search where the last frame's ended.
Status FaceSearch::run_detector(const FrameView& frame) {
  DetectedFace found[kFaceCandidatesTuning.most_candidates];
  std::size_t count = 0;
  const bool begins = is_complete_;
  const Status status = modules_->search(
      *detector_, frame, work_, {found, kFaceCandidatesTuning.most_candidates}, &count, &is_complete_);
  if (status != Status::ok) return status;
  is_of_one_frame_ = begins && is_complete_;
  for (std::size_t k = 0; k < count; ++k) candidates_.add(found[k]);
  if (candidates_.empty()) return status;
  if (is_complete_ || candidates_.next().score >= kTuning.sure_detection) {
    is_aligning_ = true;
    whom_ = first_whom();
  }
  return status;
}

/// Where an alignment takes several frames, the known person is tried first: a free alignment before it would double the time.
FaceSearch::Whom FaceSearch::first_whom() const {
  return reference_.tells() && !spreads_work() ? Whom::anybody : Whom::known;
}

/// Goes on with the alignment of the next candidate: as anybody, to see whether it is the known person; as the known person; as
/// another one. \param steps  that may be taken; those taken are subtracted.
FaceSearch::Answer FaceSearch::align(const SearchInput& input, int* steps, KnownPerson* person,
                                     StartPose* start, float* landmark_error) {
  if (!person->is_known) whom_ = Whom::another;
  Status status = Status::ok;
  if (steps_left_ == 0) {
    // A search over several frames may have seen the face at some sizes only, and it may have moved since.
    DetectedFace& face = candidates_.next();
    if (!is_of_one_frame_) status = modules_->search_near(*detector_, input.frame, face.box, &face);
    if (!(face.score > 0)) {  // the place of the last track, where the detector sees no face
      begin_again();
      return Answer::no;
    }
    if (status == Status::ok || status == Status::not_found) status = begin_alignment(input, *person);
  }
  AlignedFace face;
  if (status == Status::ok) status = advance(input.frame, steps, &face);
  if (status == Status::ok && steps_left_ > 0) return Answer::later;
  steps_left_ = 0;
  const float evidence = evidence_of(candidates_.next(), face);
  if (status != Status::ok || !is_accepted(face, evidence)) {
    go_on();
    return Answer::no;
  }
  if (evidence < kTuning.sure_start_odds && ++times_seen_ < kTuning.doubtful_frames) return Answer::later;
  if (whom_ == Whom::anybody && reference_.may_be(face, q_)) {
    whom_ = Whom::known;
    times_seen_ = 0;
    return Answer::no;
  }
  set_person(face, person, start);
  *landmark_error = face.landmark_error;
  return Answer::yes;
}

Status FaceSearch::begin_alignment(const SearchInput& input, const KnownPerson& person) {
  const StartOptions& o = input.options;
  const bool is_known = whom_ == Whom::known;
  const Camera camera =
      is_known ? person.camera : start_camera(o.camera, o.focal_px, input.frame.width, input.frame.height);
  copy(person.q, model_.parameters().count, q_);  // those that are free are not read
  return modules_->begin(*aligner_, input.frame, candidates_.next().box, camera,
                         {is_known ? is_expression_ : nullptr, candidates_.next().roll, spreads_work()}, q_,
                         &steps_left_);
}

/// Goes on with the alignment that has begun.
Status FaceSearch::advance(const FrameView& frame, int* steps, AlignedFace* face) {
  int taken = *steps < steps_left_ ? *steps : steps_left_;
  // Where the work is spread, the last step leaves its frame to the start of the track.
  if (spreads_work() && taken == steps_left_ && taken > 1) *steps = --taken;
  const Status status = modules_->advance(*aligner_, frame, taken, face, q_, landmarks_);
  steps_left_ -= taken;
  *steps -= taken;
  return status;
}

float evidence_of(const DetectedFace& candidate, const AlignedFace& face) {
  return odds(candidate.score) * odds(face.score);
}

bool FaceSearch::is_accepted(const AlignedFace& face, float evidence) const {
  const bool is_turned = candidates_.next().roll != 0;
  return face.score >= kTuning.least_start &&
         evidence >= (is_turned ? kTuning.sure_start_odds : kTuning.least_start_odds) &&
         (whom_ != Whom::known || face.landmark_error <= kTuning.most_known_error);
}

/// To the same candidate as the known person, then as another one, then to the next candidate.
void FaceSearch::go_on() {
  times_seen_ = 0;
  const bool is_last = whom_ == Whom::another;
  whom_ = whom_ == Whom::anybody ? Whom::known : is_last ? first_whom() : Whom::another;
  if (is_last && !candidates_.pass()) begin_again();
}

/// The person as aligned: pose and parameters; of a new one also the landmarks, where the alignment found them.
void FaceSearch::set_person(const AlignedFace& face, KnownPerson* person, StartPose* start) {
  *start = {face.camera, face.pose};
  copy(q_, model_.parameters().count, person->q);
  if (whom_ == Whom::known) return;
  reference_.set(face, q_);
  person->is_known = false;
  person->offsets->clear();
  person->offsets->set_pending(landmarks_, model_);
}

/// Aligns the mean face in a box. \param found  the box of the result.
Status FaceSearch::align_in(const FaceBox& box, const FrameView& frame, const Camera& camera,
                            AlignedFace* face, FaceBox* found) {
  const Status status = align_in_box(*modules_, *aligner_, frame, box, 0, camera, room(), face);
  if (status == Status::ok)
    *found = box_at_landmarks(model_, view_of(face->pose, face->camera).s, places_of(landmarks_));
  return status;
}

/// Aligns the face in a box of the caller's, and again in the box of the result until the two are the same: in a box that is too
/// large the mouth may be aligned to the nose. Then the detector is asked for its box.
Status FaceSearch::align_near(FaceBox box, const FrameView& frame, const Camera& camera, AlignedFace* face) {
  FaceBox found;
  Status status = align_in(box, frame, camera, face, &found);
  for (int k = 1; status == Status::ok && k < kTuning.most_box_alignments &&
                  !is_same(found, box, kTuning.most_box_shift, kTuning.most_box_ratio);
       ++k) {
    box = found;
    status = align_in(box, frame, camera, face, &found);
  }
  DetectedFace seen{found, 1};  // upright, as the alignments are
  if (status != Status::ok || modules_->search_near(*detector_, frame, found, &seen) != Status::ok ||
      !(seen.score > 0) || is_same(seen.box, found, kTuning.most_box_shift, kTuning.most_box_ratio))
    return status;
  return align_in(seen.box, frame, camera, face, &found);
}

void FaceSearch::refine(const SearchInput& input, const FaceBox* box, KnownPerson* person, StartPose* start,
                        float* landmark_error) {
  whom_ = Whom::another;
  if (lay_out_search(input) != Status::ok) return;
  copy(person->q, model_.parameters().count, q_);
  AlignedFace face;
  const Status status = box != nullptr ? align_near(*box, input.frame, start->camera, &face)
                                       : modules_->refine(*aligner_, input.frame, start->camera, start->pose,
                                                          {}, &face, q_, landmarks_);
  if (status != Status::ok || !(face.score >= kTuning.least_refined)) return;
  set_person(face, person, start);
  *landmark_error = face.landmark_error;
}

std::size_t search_bytes(const Model& model, const TrackerLimits& limits) {
  const FaceModules& modules = *limits.detection->modules;
  Arena trial;
  modules.lay_out_detector(trial, model, detector_limits(limits), {}, 1);
  modules.lay_out_aligner(trial, model);
  return trial.used_bytes();
}

}  // namespace pliant
