#include "track/face_start.hpp"

#include "track/key_frames.hpp"
#include "track/landmark_fit.hpp"
#include "track/self_start.hpp"

namespace pliant {

namespace {

constexpr const FaceStartTuning& kTuning = kFaceStartTuning;

FaceDetectorLimits detector_limits(const TrackerLimits& limits) {
  FaceDetectorLimits l;
  l.width = limits.width;
  l.height = limits.height;
  l.smallest_px = limits.smallest_face_px;
  return l;
}

bool are_of_one_face(const FaceBox& a, const FaceBox& b) {
  const float small = min(a.side, b.side), large = max(a.side, b.side);
  return length(a.center - b.center) < kTuning.same_face_distance * large &&
         large < kTuning.same_face_ratio * small;
}

/// Of a probability; at most 10,000.
float odds(float probability) {
  return probability / max(1 - probability, 1e-4f);
}

}  // namespace

void FaceStart::lay_out(Arena& arena, const Model& model, const TrackerLimits& limits) {
  modules_ = limits.detection->modules;
  model_ = model;
  limits_ = detector_limits(limits);
  work_ = limits.search_work;
  most_bad_frames_ = kTuning.most_bad_frames + limits.key_frames;
  const std::size_t parameters = model.parameters().count;
  q_ = arena.take<float>(parameters);
  reference_ = arena.take<float>(parameters);
  is_expression_ = arena.take<std::uint8_t>(parameters);
  landmarks_ = arena.take_span<Vec2>(model.landmarks().count);
  if (is_expression_ == nullptr) return;
  for (std::size_t k = 0; k < parameters; ++k)
    is_expression_[k] = model.parameters()[k].group == Group::expression;
}

Status FaceStart::lay_out_search(Span<unsigned char> block) {
  Arena arena(block.data, block.count);
  detector_ = modules_->lay_out_detector(arena, model_, limits_);
  is_search_complete_ = true;
  aligner_ = modules_->lay_out_aligner(arena, model_);
  PLIANT_ASSERT(detector_ != nullptr && aligner_ != nullptr);  // search_bytes
  const Status status = modules_->status(*detector_, *aligner_);
  if (status != Status::ok) detector_ = nullptr;
  return status == Status::not_found ? Status::bad_table : status;
}

// --- The search ---

void FaceStart::begin_search() {
  detector_ = nullptr;
  begin_search_again();
  if (last_.side > 0 && spreads_work()) {
    candidates_[0] = {last_, 0};
    candidate_count_ = 1;
    phase_ = FacePhase::aligning;
    whom_ = Whom::known;
    is_of_one_frame_ = false;
  }
  last_ = {};
}

Status FaceStart::search(const SearchInput& input, KnownPerson* person, StartPose* start,
                         float* landmark_error) {
  PLIANT_ASSERT(!has_track());
  Status status = detector_ == nullptr ? lay_out_search(input.block) : Status::ok;
  const bool was_searching = phase_ == FacePhase::searching;
  if (status == Status::ok && was_searching) status = run_detector(input.frame);
  if (status != Status::ok) return status;
  if (was_searching && spreads_work()) return Status::not_found;
  int steps = work_ < kTuning.cells_a_step ? 1 : static_cast<int>(work_ / kTuning.cells_a_step);
  Answer answer = Answer::no;
  while (steps > 0 && phase_ == FacePhase::aligning && answer == Answer::no)
    answer = align(input, &steps, person, start, landmark_error);
  return answer == Answer::yes ? Status::ok : Status::not_found;
}

/// Goes on with the search where the last frame's ended.
Status FaceStart::run_detector(const FrameView& frame) {
  DetectedFace found[kMostCandidates];
  std::size_t count = 0;
  const bool begins = is_search_complete_;
  const Status status =
      modules_->search(*detector_, frame, work_, {found, kMostCandidates}, &count, &is_search_complete_);
  if (status != Status::ok) return status;
  is_of_one_frame_ = begins && is_search_complete_;
  for (std::size_t k = 0; k < count; ++k) add_candidate(found[k]);
  if (candidate_count_ == 0) return status;
  if (is_search_complete_ || candidates_[0].score >= kTuning.sure_detection) {
    phase_ = FacePhase::aligning;
    next_candidate_ = 0;
    whom_ = first_question();
  }
  return status;
}

/// Keeps the candidates best first, one a face.
void FaceStart::add_candidate(const DetectedFace& face) {
  if (!(face.score >= kTuning.least_detection)) return;
  std::size_t at = 0;
  for (; at < candidate_count_ && candidates_[at].score >= face.score; ++at)
    if (are_of_one_face(candidates_[at].box, face.box)) return;
  std::size_t kept = at;
  for (std::size_t k = at; k < candidate_count_; ++k)
    if (!are_of_one_face(candidates_[k].box, face.box)) candidates_[kept++] = candidates_[k];
  if (at == kMostCandidates) return;
  candidate_count_ = kept < kMostCandidates ? kept + 1 : kMostCandidates;
  for (std::size_t k = candidate_count_ - 1; k > at; --k) candidates_[k] = candidates_[k - 1];
  candidates_[at] = face;
}

/// Where an alignment takes several frames, the person who comes back is not asked for: that would take as many again.
FaceStart::Whom FaceStart::first_question() const {
  return has_reference_ && !spreads_work() ? Whom::anybody : Whom::known;
}

/// Goes on with the alignment of the next candidate: as anybody, to see whether it is the known person; as the known person; as
/// another one. \param steps  that may be taken; those taken are subtracted.
FaceStart::Answer FaceStart::align(const SearchInput& input, int* steps, KnownPerson* person,
                                   StartPose* start, float* landmark_error) {
  if (!person->is_known) whom_ = Whom::another;
  Status status = Status::ok;
  if (steps_left_ == 0) {
    // A search over several frames may have seen the face at some sizes only, and it may have moved since.
    DetectedFace& face = candidates_[next_candidate_];
    if (!is_of_one_frame_) status = modules_->search_near(*detector_, input.frame, face.box, &face);
    if (!(face.score > 0)) {  // the place of the last track, where the detector sees no face
      begin_search_again();
      return Answer::no;
    }
    if (status == Status::ok || status == Status::not_found) status = begin_alignment(input, *person);
  }
  AlignedFace face;
  if (status == Status::ok) {
    int taken = *steps < steps_left_ ? *steps : steps_left_;
    // Where the work is spread, the last step leaves its frame to the start of the track.
    if (spreads_work() && taken == steps_left_ && taken > 1) *steps = --taken;
    status = modules_->advance(*aligner_, input.frame, taken, &face, q_, landmarks_);
    steps_left_ -= taken;
    *steps -= taken;
    if (status == Status::ok && steps_left_ > 0) return Answer::later;
  }
  steps_left_ = 0;
  if (status != Status::ok || !is_accepted(face)) {
    go_on();
    return Answer::no;
  }
  const float evidence = evidence_of(face);
  if (evidence < kTuning.sure_start_odds && ++times_seen_ < kTuning.doubtful_frames) return Answer::later;
  if (whom_ == Whom::anybody && may_be_known(face)) {
    whom_ = Whom::known;
    times_seen_ = 0;
    return Answer::no;
  }
  set_person(input.options, face, person, start);
  *landmark_error = face.landmark_error;
  return Answer::yes;
}

Status FaceStart::begin_alignment(const SearchInput& input, const KnownPerson& person) {
  const StartOptions& o = input.options;
  const bool is_known = whom_ == Whom::known;
  const Camera camera =
      is_known ? person.camera : start_camera(o.camera, o.focal_px, input.frame.width, input.frame.height);
  for (std::size_t k = 0; k < model_.parameters().count; ++k)
    q_[k] = is_known && is_expression_[k] == 0 ? person.q[k] : 0;
  return modules_->begin(*aligner_, input.frame, candidates_[next_candidate_].box, camera,
                         {is_known ? is_expression_ : nullptr}, q_, &steps_left_);
}

/// Odds of detector and alignment that the next candidate is a face.
float FaceStart::evidence_of(const AlignedFace& face) const {
  return odds(candidates_[next_candidate_].score) * odds(face.score);
}

bool FaceStart::is_accepted(const AlignedFace& face) const {
  return face.score >= kTuning.least_start && evidence_of(face) >= kTuning.least_start_odds &&
         (whom_ != Whom::known || face.landmark_error <= kTuning.most_known_error);
}

bool FaceStart::is_frontal(const AlignedFace& face) {
  return camera_direction(view_of(face.pose, face.camera)).z >= kTuning.least_frontal;
}

/// Whether the identity of the last alignment, which was free, does not tell another person from the known one.
bool FaceStart::may_be_known(const AlignedFace& face) const {
  if (!is_frontal(face)) return true;
  float sum = 0, count = 0;
  for (std::size_t k = 0; k < model_.parameters().count; ++k) {
    if (is_expression_[k] != 0) continue;
    const float off = (q_[k] - reference_[k]) / model_.parameters()[k].sd;
    sum += off * off;
    ++count;
  }
  return sum <= count * kTuning.most_identity_distance * kTuning.most_identity_distance;
}

/// To the same candidate as the known person, then as another one, then to the next candidate.
void FaceStart::go_on() {
  times_seen_ = 0;
  const bool is_last = whom_ == Whom::another;
  whom_ = whom_ == Whom::anybody ? Whom::known : is_last ? first_question() : Whom::another;
  if (is_last && ++next_candidate_ == candidate_count_) begin_search_again();
}

/// The person as aligned: pose and parameters; of a new one also the landmarks, where the alignment found them.
void FaceStart::set_person(const StartOptions& options, const AlignedFace& face, KnownPerson* person,
                           StartPose* start) {
  *start = {face.camera, face.pose};
  for (std::size_t k = 0; k < model_.parameters().count; ++k) person->q[k] = q_[k];
  if (whom_ == Whom::known) return;
  for (std::size_t k = 0; k < model_.parameters().count; ++k) reference_[k] = q_[k];
  has_reference_ = is_frontal(face);
  person->is_known = false;
  person->offsets->clear();
  if (options.keeps_landmark_offsets) person->offsets->set_pending(landmarks_, model_);
}

// --- A start of the caller's ---

void FaceStart::refine(const SearchInput& input, const FaceBox* box, KnownPerson* person, StartPose* start,
                       float* landmark_error) {
  begin_search();
  whom_ = Whom::another;
  if (lay_out_search(input.block) != Status::ok) return;
  for (std::size_t k = 0; k < model_.parameters().count; ++k) q_[k] = person->q[k];
  AlignedFace face;
  int steps = 0;
  Status status = Status::ok;
  if (box != nullptr) {
    status = modules_->begin(*aligner_, input.frame, *box, start->camera, {}, q_, &steps);
    if (status == Status::ok)
      status = modules_->advance(*aligner_, input.frame, steps, &face, q_, landmarks_);
  } else {
    status = modules_->refine(*aligner_, input.frame, start->camera, start->pose, {}, &face, q_, landmarks_);
  }
  if (status != Status::ok || !(face.score >= kTuning.least_refined)) return;
  set_person(input.options, face, person, start);
  *landmark_error = face.landmark_error;
}

// --- The running track ---

void FaceStart::begin_track(float landmark_error) {
  phase_ = FacePhase::tracking;
  last_ = {};
  detector_ = nullptr;
  landmark_error_ = landmark_error;
  is_aligned_ = landmark_error > 0;
  // A start that nothing has verified is checked in its own frame.
  frames_since_check_ = is_aligned_ ? 0 : kTuning.check_interval_frames;
  bad_checks_ = good_checks_ = 0;
}

/// Of a frame that is tracked: how well the landmarks are known, and what that makes of its state.
void FaceStart::tell_worth(const View& view, FrameResult* result) const {
  result->landmark_error = landmark_error_;
  const bool is_turned_away = camera_direction(view).z < kTuning.least_facing;
  if (is_turned_away || landmark_error_ > kTuning.most_landmark_error) result->state = TrackState::degraded;
}

bool FaceStart::conclude(const FrameView& frame, Estimator& estimator, int bad_frames, bool has_room,
                         Span<unsigned char> scratch, FrameResult* result) {
  PLIANT_ASSERT(has_track());
  const bool checks = has_room && is_check_due();
  ++frames_since_check_;
  if (bad_frames > 0) {
    frames_since_check_ = kTuning.known_interval_frames;  // the next good frame is checked
    return bad_frames < most_bad_frames_;
  }
  if (checks) {
    frames_since_check_ = 0;
    if (!check(frame, estimator, scratch)) return false;
  }
  tell_worth(estimator.view(), result);
  return true;
}

bool FaceStart::is_check_due() const {
  const bool is_sure = has_confirmed() && landmark_error_ <= kTuning.doubtful_error;
  const int interval = is_sure ? kTuning.known_interval_frames : kTuning.check_interval_frames;
  return bad_checks_ > 0 || frames_since_check_ + 1 >= interval;
}

/// \return false after too many bad checks in a row.
bool FaceStart::check(const FrameView& frame, Estimator& estimator, Span<unsigned char> scratch) {
  Arena arena(scratch.data, scratch.count);
  FaceAligner* const aligner = modules_->lay_out_verifier(arena, model_);
  AlignedFace face;
  if (aligner == nullptr || modules_->verify(*aligner, frame, estimator.camera(), pose_of(estimator.view()),
                                             estimator.parameters().data, &face) != Status::ok)
    return true;
  if (face.score < (has_confirmed() ? kTuning.least_check : kTuning.least_first_check)) {
    if (!has_confirmed()) good_checks_ = 0;
    return ++bad_checks_ < kTuning.most_bad_checks;
  }
  bad_checks_ = 0;
  ++good_checks_;
  landmark_error_ = landmark_error_ > 0
                        ? landmark_error_ + kTuning.error_rate * (face.landmark_error - landmark_error_)
                        : face.landmark_error;
  return true;
}

// --- Memory ---

std::size_t search_bytes(const Model& model, const TrackerLimits& limits) {
  const FaceModules& modules = *limits.detection->modules;
  Arena trial;
  modules.lay_out_detector(trial, model, detector_limits(limits));
  modules.lay_out_aligner(trial, model);
  return trial.used_bytes();
}

std::size_t check_bytes(const Model& model, const TrackerLimits& limits) {
  Arena trial;
  limits.detection->modules->lay_out_verifier(trial, model);
  return trial.used_bytes();
}

}  // namespace pliant
