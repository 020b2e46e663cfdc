// Templates over the whole picture, then landmarks around where they are drawn, then the likeness of the whole.
#include "pliant/face_detector.hpp"

#include <new>

#include "face/part_search.hpp"
#include "face/template_search.hpp"

namespace pliant {

namespace {

constexpr int kRoughRounds = 2, kFullRounds = 3;
constexpr std::size_t kRoughStep = 2;  // of the landmarks, one in so many is looked for then
constexpr std::size_t kFullPlaces = 2;
constexpr float kWorth = 0.6f;  // of the first place's likeness, for a second to be fitted
constexpr int kReaches[kRoughRounds + kFullRounds] = {6, 5, 4, 3, 3};  // px of the drawing, a round
constexpr int kIterations = 12;                                        // of a fit

/// An object in the arena, laid out there; null where it only measures.
template <class T, class... Args>
T* create(Arena& arena, const Args&... args) {
  T* object = arena.take<T>(1);
  T measured;
  if (object != nullptr) new (object) T();
  (object != nullptr ? *object : measured).lay_out(arena, args...);
  return object;
}

}  // namespace

void FaceDetector::lay_out(Arena& arena, const Model& model, const FaceDetectorLimits& limits) {
  limits_ = limits;
  limits_.smallest_fraction = clamp(limits.smallest_fraction, 0.15f, 0.6f);
  model_ = model;
  parameter_count_ = model.parameters().count;
  PyramidLimits pyramid;
  pyramid.width = limits.width;
  pyramid.height = limits.height;
  pyramid.levels = 4;
  pyramid_.lay_out(arena, pyramid);
  FitLimits fit;
  fit.points = PartSearch::kParts;
  fitter_.lay_out(arena, model, fit);
  picture_ = create<ModelPicture>(arena, model);
  search_ = create<PictureSearch>(arena, int{limits.width}, int{limits.height},
                                  limits_.smallest_fraction * static_cast<float>(limits.height));
  parts_ = create<PartSearch>(arena);
  places_ = arena.take<Place>(PictureSearch::kCandidates);
  pairs_ = arena.take<Correspondence>(PartSearch::kParts);
  q_ = arena.take<float>(parameter_count_);
  best_q_ = arena.take<float>(parameter_count_);
  none_free_ = arena.take<std::uint8_t>(parameter_count_);
  started_ = false;
}

Status FaceDetector::begin(const Camera& camera, const FaceDetectorOptions& options) {
  started_ = false;
  const bool is_camera = is_finite(camera.f) && camera.f > 0 && is_finite(Vec2{camera.cx, camera.cy});
  if (!is_camera || !(options.largest_fraction >= limits_.smallest_fraction && options.largest_fraction <= 1) ||
      !(options.min_similarity > 0 && options.min_similarity < 1))
    return Status::bad_argument;
  const Status status = picture_->prepare();
  if (status != Status::ok) return status;
  camera_ = camera;
  options_ = options;
  for (std::size_t k = 0; k < parameter_count_; ++k) {
    best_q_[k] = 0;
    none_free_[k] = 0;
  }
  constexpr float kUsualShare = 0.35f;  // how far away a head is taken to be when templates are drawn
  search_->prepare(*picture_,
                   camera.f * picture_->inner_size() / (kUsualShare * static_cast<float>(limits_.height)));
  started_ = true;
  return Status::ok;
}

/// Looks where the parts are and moves the model there; q_ are its parameters. The place has the likeness before.
void FaceDetector::align(Place& place, int round, const std::uint8_t* is_free) {
  picture_->set(q_);
  parts_->look(pyramid_, *picture_, place.view);
  place.likeness = parts_->likeness();
  const std::size_t n =
      parts_->find(*picture_, kReaches[round], round < kRoughRounds ? kRoughStep : 1, pairs_);
  FitOptions options;
  options.width = limits_.width;
  options.height = limits_.height;
  options.camera = &camera_;
  options.start = &place.view;
  options.is_free = is_free;
  options.iterations = kIterations;
  FitReport report;
  if (fitter_.fit({pairs_, n}, options, q_, &report) == Status::ok)
    place.view = report.view;
}

/// As the model at rest.
void FaceDetector::align_roughly(const Candidate& c, Place* place) {
  for (std::size_t k = 0; k < parameter_count_; ++k) q_[k] = 0;
  place->view = view_at(c.x, c.scale, c.turn, picture_->middle(),
                        clamp(c.scale / camera_.f, kMinRho, kMaxRho), {camera_.cx, camera_.cy});
  for (int round = 0; round < kRoughRounds; ++round) align(*place, round, none_free_);
  picture_->set(q_);
  parts_->look(pyramid_, *picture_, place->view);
  place->likeness = parts_->likeness();
}

/// With all parameters, into q_.
void FaceDetector::align_fully(Place& place) {
  for (std::size_t k = 0; k < parameter_count_; ++k) q_[k] = 0;
  for (int round = 0; round < kFullRounds; ++round) align(place, kRoughRounds + round, nullptr);
  picture_->set(q_);
  parts_->look(pyramid_, *picture_, place.view);
  place.likeness = parts_->likeness();
}

Status FaceDetector::look_at(const FrameView& frame) {
  if (!started_) return Status::not_started;
  const Status status = check(frame);
  if (status != Status::ok) return status;
  if (frame.width != limits_.width || frame.height != limits_.height) return Status::size_mismatch;
  return pyramid_.build(frame);
}

Status FaceDetector::find(const FrameView& frame, FaceDetectorReport* report) {
  if (report == nullptr) return Status::bad_argument;
  const Status status = look_at(frame);
  if (status != Status::ok) return status;
  const float height = static_cast<float>(limits_.height);
  const Span<const Candidate> found =
      search_->find(pyramid_, limits_.smallest_fraction * height, options_.largest_fraction * height);
  for (std::size_t k = 0; k < found.count; ++k) align_roughly(found[k], &places_[k]);
  *report = {};
  float first = 0;
  for (std::size_t n = 0; n < kFullPlaces && n < found.count; ++n) {
    std::size_t best = n;
    for (std::size_t k = n + 1; k < found.count; ++k)
      if (places_[k].likeness > places_[best].likeness) best = k;
    if (n > 0 && places_[best].likeness < kWorth * first) break;
    Place place = places_[best];
    if (n == 0) first = place.likeness;
    places_[best] = places_[n];
    align_fully(place);
    if (place.likeness <= report->similarity) continue;
    report->similarity = place.likeness;
    report->pose = pose_of(place.view);
    for (std::size_t k = 0; k < parameter_count_; ++k) best_q_[k] = q_[k];
  }
  report->is_found = report->similarity >= options_.min_similarity;
  return Status::ok;
}

Status FaceDetector::compare(const FrameView& frame, const Pose& pose, const float* q, float* likeness) {
  if (q == nullptr || likeness == nullptr || !is_finite(pose)) return Status::bad_argument;
  const float nearest = 1 / kMaxRho, farthest = 1 / kMinRho;
  if (!(pose.t.z > nearest && pose.t.z < farthest && length(pose.t) < 2 * farthest))
    return Status::bad_argument;
  const Status status = look_at(frame);
  if (status != Status::ok) return status;
  picture_->set(q);
  parts_->look(pyramid_, *picture_, view_of(pose, camera_));
  *likeness = parts_->likeness();
  return Status::ok;
}

}  // namespace pliant
