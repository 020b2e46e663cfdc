#include "pliant/face_detector.hpp"

#include "face/face_detector_tuning.hpp"
#include "face/landmark_search.hpp"
#include "face/template_search.hpp"

namespace pliant {

namespace {

constexpr const FaceDetectorTuning& kTuning = kFaceDetectorTuning;

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
  fit.points = LandmarkSearch::kMaxLandmarks;
  fitter_.lay_out(arena, model, fit);
  rendered_ = create_part<RenderedTemplate>(arena, model);
  search_ = create_part<TemplateSearch>(arena, int{limits.width}, int{limits.height},
                                        limits_.smallest_fraction * static_cast<float>(limits.height));
  landmarks_ = create_part<LandmarkSearch>(arena);
  places_ = arena.take<Place>(TemplateSearch::kCandidates);
  pairs_ = arena.take<Correspondence>(LandmarkSearch::kMaxLandmarks);
  q_ = arena.take<float>(parameter_count_);
  best_q_ = arena.take<float>(parameter_count_);
  none_free_ = arena.take<std::uint8_t>(parameter_count_);
  started_ = false;
}

Status FaceDetector::begin(const Camera& camera, const FaceDetectorOptions& options) {
  started_ = false;
  const bool is_camera = is_finite(camera.f) && camera.f > 0 && is_finite(Vec2{camera.cx, camera.cy});
  if (!is_camera ||
      !(options.largest_fraction >= limits_.smallest_fraction && options.largest_fraction <= 1) ||
      !(options.min_similarity > 0 && options.min_similarity < 1))
    return Status::bad_argument;
  const Status status = rendered_->prepare();
  if (status != Status::ok) return status;
  camera_ = camera;
  options_ = options;
  for (std::size_t k = 0; k < parameter_count_; ++k) {
    best_q_[k] = 0;
    none_free_[k] = 0;
  }
  search_->prepare(*rendered_, camera.f * rendered_->inner_size() /
                                   (kTuning.usual_fraction * static_cast<float>(limits_.height)));
  started_ = true;
  return Status::ok;
}

// The similarity of the model with q_ at the place.
void FaceDetector::measure(Place& place) {
  rendered_->set(q_);
  landmarks_->load(pyramid_, *rendered_, place.view);
  place.similarity = landmarks_->similarity();
}

// Finds the landmarks and fits the view and q_ to them. The place keeps the similarity before the fit.
void FaceDetector::align(Place& place, int round, const std::uint8_t* is_free) {
  measure(place);
  const std::size_t step = round < kTuning.pose_rounds ? kTuning.pose_landmark_step : 1;
  const std::size_t n = landmarks_->find(*rendered_, kTuning.reach_px[round], step, pairs_);
  FitOptions options;
  options.width = limits_.width;
  options.height = limits_.height;
  options.camera = &camera_;
  options.start = &place.view;
  options.is_free = is_free;
  options.iterations = kTuning.fit_iterations;
  FitReport report;
  if (fitter_.fit({pairs_, n}, options, q_, &report) == Status::ok) place.view = report.view;
}

// The pose alone, of the model at rest.
void FaceDetector::align_pose(const Candidate& c, Place* place) {
  for (std::size_t k = 0; k < parameter_count_; ++k) q_[k] = 0;
  place->view = view_at(c.x, c.scale, c.rotation, rendered_->middle(),
                        clamp(c.scale / camera_.f, kMinRho, kMaxRho), {camera_.cx, camera_.cy});
  for (int round = 0; round < kTuning.pose_rounds; ++round) align(*place, round, none_free_);
  measure(*place);
}

// With all parameters, into q_.
void FaceDetector::align_fully(Place& place) {
  for (std::size_t k = 0; k < parameter_count_; ++k) q_[k] = 0;
  for (int round = 0; round < kTuning.full_rounds; ++round)
    align(place, kTuning.pose_rounds + round, nullptr);
  measure(place);
}

Status FaceDetector::load(const FrameView& frame) {
  if (!started_) return Status::not_started;
  const Status status = check(frame);
  if (status != Status::ok) return status;
  if (frame.width != limits_.width || frame.height != limits_.height) return Status::size_mismatch;
  return pyramid_.build(frame);
}

Status FaceDetector::find(const FrameView& frame, FaceDetectorReport* report) {
  if (report == nullptr) return Status::bad_argument;
  const Status status = load(frame);
  if (status != Status::ok) return status;
  const float height = static_cast<float>(limits_.height);
  const Span<const Candidate> found =
      search_->find(pyramid_, limits_.smallest_fraction * height, options_.largest_fraction * height);
  for (std::size_t k = 0; k < found.count; ++k) align_pose(found[k], &places_[k]);
  *report = {};
  float first = 0;
  for (std::size_t n = 0; n < kTuning.full_candidates && n < found.count; ++n) {
    std::size_t best = n;
    for (std::size_t k = n + 1; k < found.count; ++k)
      if (places_[k].similarity > places_[best].similarity) best = k;
    if (n > 0 && places_[best].similarity < kTuning.second_candidate_fraction * first) break;
    Place place = places_[best];
    if (n == 0) first = place.similarity;
    places_[best] = places_[n];
    align_fully(place);
    if (place.similarity <= report->similarity) continue;
    report->similarity = place.similarity;
    report->pose = pose_of(place.view);
    for (std::size_t k = 0; k < parameter_count_; ++k) best_q_[k] = q_[k];
  }
  report->is_found = report->similarity >= options_.min_similarity;
  return Status::ok;
}

Status FaceDetector::compare(const FrameView& frame, const Pose& pose, const float* q, float* similarity) {
  if (q == nullptr || similarity == nullptr || !is_finite(pose)) return Status::bad_argument;
  const float nearest = 1 / kMaxRho, farthest = 1 / kMinRho;
  if (!(pose.t.z > nearest && pose.t.z < farthest && length(pose.t) < 2 * farthest))
    return Status::bad_argument;
  const Status status = load(frame);
  if (status != Status::ok) return status;
  rendered_->set(q);
  landmarks_->load(pyramid_, *rendered_, view_of(pose, camera_));
  *similarity = landmarks_->similarity();
  return Status::ok;
}

}  // namespace pliant
