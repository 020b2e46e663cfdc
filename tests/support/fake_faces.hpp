#pragma once
// Detection and alignment that know the truth of a film: for tests of what a tracker makes of their results.
#include <doctest/doctest.h>

#include "face_film.hpp"
#include "pliant/tracker.hpp"
#include "track/detection_state.hpp"
#include "track/face_checks.hpp"
#include "track/face_search.hpp"

/// A face at 320 x 240 that drifts by 20 mm.
inline FaceFilm drifting_face(std::size_t frames) {
  return FaceFilm(
      320, 240, frames, [](float s, pliant::Pose& pose, auto&) { pose.t.x += 20 * s; }, 0.5f);
}

/// One at a time: a tracker calls its functions through a table.
struct FakeFaces {
  // What it does.
  const FaceFilm* film = nullptr;
  std::uint32_t calls_a_search = 1;  ///< calls until a bounded search is complete
  bool finds_early = false;          ///< each of these calls finds the face, not the last one alone
  float detection = 0.999f;          ///< score of the face in the detector
  float score = 0.999f;              ///< of an alignment
  float free_score = 1;              ///< the same with the identity free, if less
  float verification = 0.99f;        ///< score of a verification near the truth
  float error = 0.02f;               ///< landmark error of an alignment
  float tracked_error = 0;           ///< of a verification near the truth; 0: `error`
  float held_error = 0.02f;          ///< the same with the identity held
  float least_part = 0;              ///< of a verification, from frame `least_part_from` on
  std::size_t least_part_from = 0;
  pliant::Status status = pliant::Status::ok;  ///< of the tables
  float size_found = 1;                        ///< of the face in a search, over its size
  float roll_found = 0;                        ///< the same of the turn of the frame in which it is found
  bool has_ghost = false;                      ///< the detector also gives a box without a face
  int steps_an_alignment = 6;
  std::size_t blind_from = ~std::size_t{0};  ///< frame from which on no alignment begins
  std::size_t covered_frames = 0;  ///< at the beginning: the mouth is covered, alignments have it too low
  float covered_error = 0.05f;     ///< landmark error of those
  float lowered_px = 8;            ///< by how much they have the mouth too low
  /// By how much an alignment that begins near the right pose, but not at it, has the face too low.
  float refined_too_low_px = 0;
  float restless_px = 0;  ///< by how much every second alignment that begins in a box has the face too low
  // What was asked of it.
  int steps = 0;  ///< of alignments
  int searches = 0, alignments = 0, held_alignments = 0, verifications = 0;
  int refinements = 0;     ///< which are no `alignments`
  std::uint32_t work = 0;  ///< of the last search
  float roll = 0;          ///< of the last alignment
  bool is_scored_twice = false;  ///< the last alignment is to be
  pliant::Quat expected;   ///< rotation that the last detector was laid out for

  static constexpr std::size_t kDetectorBytes = 40'000, kAlignerBytes = 20'000;

  static FakeFaces*& current() {
    static FakeFaces* one = nullptr;
    return one;
  }
  explicit FakeFaces(const FaceFilm& of) : film(&of) { current() = this; }
  ~FakeFaces() { current() = nullptr; }

  /// Of a frame; side 0 where it shows no face.
  pliant::FaceBox box(std::size_t k) const {
    const pliant::Vec2 eyes[] = {film->truth("ibug36", k), film->truth("ibug45", k)};
    const pliant::Vec2 mouth[] = {film->truth("ibug48", k), film->truth("ibug54", k)};
    const pliant::FaceBox box = pliant::face_box_of(eyes[0], eyes[1], mouth[0], mouth[1],
                                                    pliant::view_of(film->poses[k], film->camera).s);
    const bool is_seen = box.center.x > 0 && box.center.y > 0 &&
                         box.center.x < static_cast<float>(film->width) &&
                         box.center.y < static_cast<float>(film->height);
    return is_seen ? box : pliant::FaceBox{};
  }

  static const pliant::Detection* table();
};

namespace fake_faces {

using namespace pliant;

inline FakeFaces& fake() {
  return *FakeFaces::current();
}

inline bool is_available(const Model&) {
  return true;
}

/// Memory that is written to, so that what shares it must not rely on it.
template <class Part>
Part* take(Arena& arena, std::size_t bytes) {
  auto* const room = arena.take<unsigned char>(bytes);
  for (std::size_t k = 0; room != nullptr && k < bytes; ++k) room[k] = 0xA5;
  return reinterpret_cast<Part*>(room);
}

inline FaceDetector* lay_out_detector(Arena& arena, const Model&, const FaceDetectorLimits&,
                                      const Quat& expected, float) {
  if (FakeFaces::current() != nullptr) fake().expected = expected;  // null: the arena measures
  return take<FaceDetector>(arena, FakeFaces::kDetectorBytes);
}

inline FaceAligner* lay_out_aligner(Arena& arena, const Model&) {
  return take<FaceAligner>(arena, FakeFaces::kAlignerBytes);
}

inline Status status(const FaceDetector&, const FaceAligner&) {
  return fake().status;
}

inline Status search(FaceDetector&, const FrameView& frame, std::uint32_t work, Span<DetectedFace> room,
                     std::size_t* count, bool* is_complete) {
  FakeFaces& f = fake();
  f.work = work;
  ++f.searches;
  *count = 0;
  *is_complete = work >= 24000 || static_cast<std::uint32_t>(f.searches) % f.calls_a_search == 0;
  const FaceBox box = f.box(frame.sequence);
  if (!*is_complete && !f.finds_early) return Status::ok;
  if (f.has_ghost) room[(*count)++] = {{{60, 60}, 50}, 0.9995f};
  if (box.side > 0) room[(*count)++] = {{box.center, f.size_found * box.side}, f.detection, f.roll_found};
  return Status::ok;
}

inline Status search_near(FaceDetector&, const FrameView& frame, const FaceBox& box, DetectedFace* face) {
  const FaceBox truth = fake().box(frame.sequence);
  if (!(truth.side > 0 && length(truth.center - box.center) < 0.5f * truth.side)) return Status::not_found;
  *face = {truth, fake().detection};
  return Status::ok;
}

/// What an alignment has been given, and how many of its steps are left.
struct Alignment {
  FaceBox box;
  Camera camera;
  AlignOptions options;
  int steps = 0;
};

inline Alignment& alignment() {
  static Alignment one;
  return one;
}

inline bool is_black(const FrameView& frame) {
  const std::uint8_t* const row =
      frame.data + static_cast<std::size_t>(frame.height / 2) * frame.stride_bytes;
  return std::all_of(row, row + frame.width, [](std::uint8_t pixel) { return pixel == 0; });
}

inline Status begin(FaceAligner&, const FrameView& frame, const FaceBox& box, const Camera& camera,
                    const AlignOptions& options, const float*, int* steps) {
  FakeFaces& f = fake();
  if (frame.sequence >= f.blind_from) return Status::not_found;
  ++f.alignments;
  f.held_alignments += options.is_free != nullptr;
  f.roll = options.roll;
  f.is_scored_twice = options.is_scored_twice;
  *steps = f.steps_an_alignment;
  alignment() = {box, camera, options, *steps};
  return Status::ok;
}

/// What an alignment makes of a covered mouth.
inline void lower_mouth(AlignedFace* face, Span<Vec2> landmarks) {
  face->landmark_error = fake().covered_error;
  for (std::size_t i = 0; i < landmarks.count; ++i)
    if (const std::string name = baked_face().model.landmarks()[i].name; name >= "ibug48" && name <= "ibug67")
      landmarks[i].y += fake().lowered_px;
}

inline void lower(float px, AlignedFace* face, Span<Vec2> landmarks) {
  View view = view_of(face->pose, face->camera);
  view.tau.y += px / view.s;
  face->pose = pose_of(view);
  for (Vec2& x : landmarks) x.y += px;
}

/// The last step gives the truth of its frame, if the box is of its face.
inline Status advance(FaceAligner&, const FrameView& frame, int steps, AlignedFace* face, float* q,
                      Span<Vec2> landmarks) {
  FakeFaces& f = fake();
  const auto& [box, camera, options, left] = alignment();
  CHECK(steps <= left);
  f.steps += steps;
  alignment().steps -= steps;
  if (left > 0) return Status::ok;
  const std::size_t k = frame.sequence;
  const FaceBox truth = f.box(k);
  *face = {camera, {}, 0.01f, 0.5f, 0};
  if (!(truth.side > 0) || length(truth.center - box.center) > 0.5f * truth.side ||
      magnitude(truth.side - box.side) > 0.2f * truth.side)
    return Status::ok;
  View view = view_of(f.film->poses[k], f.film->camera);
  view.rho = view.s / camera.f;
  const float score = options.is_free == nullptr ? min(f.score, f.free_score) : f.score;
  *face = {camera, pose_of(view), score, options.is_free != nullptr ? f.held_error : f.error, 0};
  for (std::size_t i = 0; i < f.film->parameters[k].size(); ++i)
    if (options.is_free == nullptr || options.is_free[i] != 0) q[i] = f.film->parameters[k][i];
  for (std::size_t i = 0; i < landmarks.count; ++i)
    landmarks[i] = f.film->truth(baked_face().model.landmarks()[i].name, k);
  if (k < f.covered_frames) lower_mouth(face, landmarks);
  if (options.is_free == nullptr && f.alignments % 2 == 0) lower(f.restless_px, face, landmarks);
  return Status::ok;
}

inline Status refine(FaceAligner& aligner, const FrameView& frame, const Camera& camera, const Pose& start,
                     const AlignOptions& options, AlignedFace* face, float* q, Span<Vec2> landmarks) {
  FakeFaces& f = fake();
  ++f.refinements;
  if (is_black(frame)) return Status::not_found;
  const View view = view_of(start, camera);
  const FaceBox near{view.c + view.s * view.tau, kFaceBoxMm * view.s};
  int steps = 0;
  const int alignments = f.alignments, held = f.held_alignments;
  Status status = begin(aligner, frame, near, camera, options, q, &steps);
  f.alignments = alignments;
  f.held_alignments = held;
  if (status == Status::ok) status = advance(aligner, frame, steps, face, q, landmarks);
  if (status != Status::ok) return status;
  const View found = view_of(face->pose, camera);
  if (length(view.s * view.tau - found.s * found.tau) > 1) lower(f.refined_too_low_px, face, landmarks);
  return status;
}

inline Status verify(FaceAligner&, const FrameView& frame, const Camera& camera, const Pose& pose,
                     const float*, AlignedFace* face) {
  FakeFaces& f = fake();
  ++f.verifications;
  const FaceBox truth = f.box(frame.sequence);
  const View view = view_of(pose, camera), right = view_of(f.film->poses[frame.sequence], f.film->camera);
  const Vec2 off = view.s * view.tau - right.s * right.tau;
  const bool is_right = truth.side > 0 && length(off) < 0.2f * truth.side;
  *face = {camera, pose, is_right ? f.verification : 0.01f,
           !is_right             ? 0.5f
           : f.tracked_error > 0 ? f.tracked_error
                                 : f.error,
           frame.sequence < f.least_part_from ? 0.0f : f.least_part};
  return Status::ok;
}

}  // namespace fake_faces

inline const pliant::Detection* FakeFaces::table() {
  static const pliant::FaceModules modules{fake_faces::is_available,    fake_faces::lay_out_detector,
                                           fake_faces::lay_out_aligner, fake_faces::lay_out_aligner,
                                           fake_faces::status,          fake_faces::search,
                                           fake_faces::search_near,     fake_faces::begin,
                                           fake_faces::advance,         fake_faces::refine,
                                           fake_faces::verify};
  static pliant::Detection table = pliant::kUprightFaceDetection;
  table.modules = &modules;
  return &table;
}

/// Without second looks, whose alignments would be counted.
inline pliant::TrackerLimits limits_with_fake() {
  pliant::TrackerLimits l = without_second_look(pliant::TrackerLimits{});
  l.detection = FakeFaces::table();
  return l;
}

/// The same with second looks.
inline pliant::TrackerLimits limits_with_looks() {
  pliant::TrackerLimits l = limits_with_fake();
  l.second_look = &pliant::kSecondLook;
  return l;
}

/// The result of frame k of a film.
inline pliant::FrameResult update(pliant::Tracker& tracker, const FaceFilm& film, std::size_t k) {
  pliant::FrameResult result;
  REQUIRE(tracker.update(film.view(k), &result) == pliant::Status::ok);
  return result;
}
