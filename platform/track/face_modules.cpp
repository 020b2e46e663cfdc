#include "track/face_modules.hpp"

#include "face/rolled_detector.hpp"

namespace pliant {

namespace {

bool is_available(const Model& model) {
  return !model.detector().empty() && !model.aligner().empty();
}

FaceDetector* lay_out_detector(Arena& arena, const Model& model, const FaceDetectorLimits& limits,
                               const Quat&, float) {
  return create_part<FaceDetector>(arena, model.detector(), limits);
}

FaceAligner* lay_out_aligner(Arena& arena, const Model& model) {
  return create_part<FaceAligner>(arena, model, model.aligner());
}

FaceAligner* lay_out_for_known_person(Arena& arena, const Model& model) {
  FaceAligner* const aligner = arena.make<FaceAligner>();
  FaceAligner measured;
  (aligner == nullptr ? measured : *aligner).lay_out_for_known_person(arena, model);
  return aligner;
}

Status status(const FaceDetector& detector, const FaceAligner& aligner) {
  return detector.status() != Status::ok ? detector.status() : aligner.status();
}

Status search(FaceDetector& detector, const FrameView& frame, std::uint32_t work, Span<DetectedFace> room,
              std::size_t* count, bool* is_complete) {
  return detector.search(frame, work, room, count, is_complete);
}

Status search_near(FaceDetector& detector, const FrameView& frame, const FaceBox& box, DetectedFace* face) {
  return detector.search_near(frame, box, face);
}

Status begin(FaceAligner& aligner, const FrameView& frame, const FaceBox& box, const Camera& camera,
             const AlignOptions& options, const float* q, int* steps) {
  return aligner.begin(frame, box, camera, q, steps, options);
}

Status advance(FaceAligner& aligner, const FrameView& frame, int steps, AlignedFace* face, float* q,
               Span<Vec2> landmarks) {
  return aligner.advance(frame, steps, face, q, landmarks);
}

Status refine(FaceAligner& aligner, const FrameView& frame, const Camera& camera, const Pose& start,
              const AlignOptions& options, AlignedFace* face, float* q, Span<Vec2> landmarks) {
  return aligner.refine(frame, camera, start, face, q, landmarks, options);
}

Status verify(FaceAligner& aligner, const FrameView& frame, const Camera& camera, const Pose& pose,
              const float* q, AlignedFace* face) {
  return aligner.verify(frame, camera, pose, q, face);
}

}  // namespace

constexpr FaceModules kFaceModules{is_available, lay_out_detector, lay_out_aligner, lay_out_for_known_person,
                               status,       search,           search_near,     begin,
                               advance,      refine,           verify};

namespace {

FaceDetector* lay_out_rolled(Arena& arena, const Model& model, const FaceDetectorLimits& limits,
                             const Quat& expected, float aspect) {
  return create_part<RolledDetector>(arena, model.detector(), limits, expected, aspect);
}

Status search_rolled(FaceDetector& detector, const FrameView& frame, std::uint32_t work,
                     Span<DetectedFace> room, std::size_t* count, bool* is_complete) {
  return static_cast<RolledDetector&>(detector).search(frame, work, room, count, is_complete);
}

Status search_near_rolled(FaceDetector& detector, const FrameView& frame, const FaceBox& box,
                          DetectedFace* face) {
  return static_cast<RolledDetector&>(detector).search_near(frame, box, face);
}

constexpr FaceModules with_rolls(FaceModules modules) {
  modules.lay_out_detector = lay_out_rolled;
  modules.search = search_rolled;
  modules.search_near = search_near_rolled;
  return modules;
}

}  // namespace

constexpr FaceModules kRolledFaces = with_rolls(kFaceModules);

}  // namespace pliant
