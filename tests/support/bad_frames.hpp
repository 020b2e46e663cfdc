#pragma once
// Films of a face in which templates fail from a frame on while alignment still sees it, and a tracker of them. Detection and
// alignment are a fake that knows the truth.
#include "fake_faces.hpp"
#include "model_builder.hpp"
#include "track/realignment.hpp"

namespace bad_frames {

using namespace pliant;

inline constexpr std::size_t kChange = 10, kFrames = 50;
inline constexpr float kWidth = 1.5f;

/// A face that moves. From frame kChange to frame `back` the picture is a negative, which no template matches.
/// \param person_after  identity parameter from frame kChange on; before it is faceWidth.
inline FaceFilm film_of(std::size_t back, const char* person_after = "faceWidth", float turn = 0) {
  FaceFilm film(
      320, 240, kFrames,
      [=](float s, Pose& pose, auto& q) {
        const auto k = static_cast<std::size_t>(s * (kFrames - 1) + 0.5f);
        FaceFilm::set(q, k < kChange ? "faceWidth" : person_after, kWidth);
        pose.q = exp_rotation({0, turn, 0});
        pose.t.x += 150 * s - 75;
      },
      0.5f);
  for (std::size_t k = kChange; k < back; ++k)
    for (std::uint8_t& grey : film.frames[k]) grey = static_cast<std::uint8_t>(255 - grey);
  return film;
}

inline const FaceFilm& changed_film() {
  static const FaceFilm* made = new FaceFilm(film_of(kFrames));
  return *made;
}

/// The same, but it comes back as the face of another person.
inline const FaceFilm& film_of_another() {
  static const FaceFilm* made = new FaceFilm(film_of(kFrames, "noseLength"));
  return *made;
}

/// In dim light from frame kChange on, which no template matches either; it is no other picture.
inline const FaceFilm& dim_film() {
  static const FaceFilm* made = [] {
    auto* film = new FaceFilm(film_of(kChange));
    for (std::size_t k = kChange; k < kFrames; ++k)
      for (std::uint8_t& grey : film->frames[k]) grey = static_cast<std::uint8_t>(100 + grey / 10);
    return film;
  }();
  return *made;
}

/// A tracker that has tracked a film up to frame kChange.
struct Tracked {
  const FaceFilm& film;
  FakeFaces fake{film};
  InArena<Tracker> tracker;
  float eyes_px;

  explicit Tracked(const FaceFilm& of, const TrackerLimits& limits = limits_with_looks())
      : film(of),
        tracker(baked_face().model, limits),
        eyes_px(length(of.truth("ibug45", kChange) - of.truth("ibug36", kChange))) {
    for (std::size_t k = 0; k < kChange; ++k) update(tracker.object, film, k);
  }
  TrackState state(std::size_t k) { return update(tracker.object, film, k).state; }
  /// Alignments from the last place end elsewhere from now on, and the mean face is seen surely where the face is.
  void cut() {
    fake.refined_too_low_px = 1.5f * kRealignmentTuning.most_disagreement * eyes_px;
    fake.held_error = 0.06f;
    fake.error = 0.02f;
  }
};

}  // namespace bad_frames
