#include "host/commands/face_finder.hpp"

#include <algorithm>

#include "face/rolled_detector.hpp"
#include "host/commands/image_fit.hpp"
#include "host/io/failure.hpp"
#include "host/learn/face_samples.hpp"
#include "track/face_search.hpp"
#include "vision/noise_filter.hpp"

namespace pliant::host {

namespace {

/// Most detections in one picture that are aligned, count. Round value, not tuned: a photograph of a large group.
constexpr std::size_t kMaxDetections = 256;
/// Windows of the detector for each of them, count: a face gives up to so many.
constexpr std::size_t kWindowsAFace = 40;
/// Two alignments are one face if their centres are closer than this fraction of the larger side. Round value, not tuned:
/// faces side by side have more distance.
constexpr float kSameFaceFraction = 0.4f;

bool are_one_face(const FoundFace& a, const FoundFace& b) {
  return length(a.box.center - b.box.center) < kSameFaceFraction * max(a.box.side, b.box.side);
}

/// What is turned must be a face as surely as for a tracker: text is upright where the verification has learnt it.
bool is_sure(const DetectedFace& candidate, const AlignedFace& face) {
  return evidence_of(candidate, face) >= kFaceSearchTuning.sure_start_odds;
}

/// The picture, smoothed if it is noisy, as a tracker does it.
Image quiet(const Image& grey) {
  Owned<NoiseFilter> filter(grey.width, grey.height);
  return image_of(filter->smoothed(frame_of(grey)));
}

}  // namespace

FaceFinder::FaceFinder(const ModelFile& file) : file_(file), aligner_(file.model(), file.model().aligner()) {
  if (file.model().detector().empty() || file.model().aligner().empty())
    fail_input(
        file.path(),
        file.model().print().empty()
            ? "has no learnt tables to find faces with: bake it with --learnt"
            : "has no learnt tables to find faces with; by its print a surface is found by pliant track, and "
              "pliant fit needs --points or --pose");
  require(aligner_->status(), file.path() + ": aligner");
}

std::optional<FoundFace> FaceFinder::align(const Image& grey, const FaceBox& box,
                                           const std::optional<Camera>& camera) {
  return align_in(quiet(grey), {box}, camera);
}

std::optional<FoundFace> FaceFinder::align_in(const Image& grey, const DetectedFace& at,
                                              const std::optional<Camera>& camera) {
  const Model& model = file_.model();
  const ImageSize size{grey.width, grey.height};
  FoundFace face;
  face.q.assign(model.parameters().count, 0.0f);
  face.landmarks.assign(model.landmarks().count, Vec2{});
  const Camera used = camera.value_or(centred_camera(size.width, size.height, default_focal(size)));
  const Status status = aligner_->align(frame_of(grey), at.box, used, &face.aligned, face.q.data(),
                                        {face.landmarks.data(), face.landmarks.size()}, {nullptr, at.roll});
  if (status != Status::ok) return std::nullopt;
  face.box = learn::face_box_in(model, face.landmarks, face.aligned.pose, face.aligned.camera);
  return face;
}

std::vector<FoundFace> FaceFinder::find(const Image& grey, const std::string& name, float min_score,
                                        const std::optional<Camera>& camera) {
  if (grey.width > kLargestFramePx || grey.height > kLargestFramePx)
    fail_input(name, "is larger than " + std::to_string(kLargestFramePx) + " pixels on a side");
  const Image picture = quiet(grey);
  FaceDetectorLimits limits;
  limits.width = static_cast<std::uint16_t>(grey.width);
  limits.height = static_cast<std::uint16_t>(grey.height);
  limits.hits = static_cast<std::uint16_t>(kWindowsAFace * kMaxDetections);
  Owned<RolledDetector> detector(file_.model().detector(), limits, Quat{}, camera ? camera->aspect : 1.0f);
  require(detector->status(), file_.path() + ": detector");
  std::vector<FoundFace> faces;
  for (int turn = 0; turn < kTurnsOfPicture && faces.empty(); ++turn) {
    std::vector<DetectedFace> detected(kMaxDetections);
    std::size_t count = 0;
    require(detector->find_at(turn, frame_of(picture), {detected.data(), detected.size()}, &count), name);
    for (std::size_t k = 0; k < count; ++k)
      if (auto face = align_in(picture, detected[k], camera);
          face && face->aligned.score >= min_score && (turn == 0 || is_sure(detected[k], face->aligned)))
        faces.push_back(std::move(*face));
  }
  std::stable_sort(faces.begin(), faces.end(),
                   [](const FoundFace& a, const FoundFace& b) { return a.aligned.score > b.aligned.score; });
  std::vector<FoundFace> distinct;
  for (FoundFace& face : faces)
    if (std::none_of(distinct.begin(), distinct.end(),
                     [&](const FoundFace& d) { return are_one_face(d, face); }))
      distinct.push_back(std::move(face));
  return distinct;
}

}  // namespace pliant::host
