// In which frames a running track is checked. Detection and verification are a fake that knows the truth.
#include <doctest/doctest.h>

#include <cmath>

#include "fake_faces.hpp"
#include "model_builder.hpp"
#include "open_model.hpp"
#include "track/tracker_parts.hpp"
#include "track/tracker_sizes.hpp"

namespace face_checks_test {

using namespace pliant;

namespace {

constexpr std::size_t kFrames = 24;

const FaceFilm& film() {
  static const FaceFilm* one = new FaceFilm(drifting_face(kFrames));
  return *one;
}

/// Frames that are checked. \param before  is told of each frame, may change what the fake says and gives its picture.
template <class Before>
std::vector<std::size_t> checked(FakeFaces& fake, Before&& before) {
  const TrackerLimits limits = limits_with_fake();
  InArena<Tracker> tracker(baked_face().model, limits);
  std::vector<std::size_t> frames;
  for (std::size_t n = 0; n < kFrames; ++n) {
    const int asked = fake.verifications;
    FrameView view = film().view(n);
    before(n, view);
    FrameResult result;
    REQUIRE(tracker->update(view, &result) == Status::ok);
    CHECK(tracker->is_started());
    if (fake.verifications > asked) frames.push_back(n);
  }
  return frames;
}

using Frames = std::vector<std::size_t>;

/// A running track that is concluded again and again in its first frame, so that nothing but the checks changes.
class StandingTrack {
 public:
  StandingTrack() : tracker_(baked_face().model, limits_), scratch_(std::size_t{1} << 20) {
    REQUIRE(film().start_at_pose(tracker_.object) == Status::ok);
  }

  /// Frames for which `is_noted(checks)` holds, asked after each. \param before  is told of each, says whether it has room.
  template <class Before, class IsNoted>
  Frames play(float landmark_error, Before&& before, IsNoted&& is_noted) {
    FaceChecks checks;
    checks.lay_out(limits_);
    checks.begin_track(landmark_error, false);
    Frames frames;
    for (std::size_t n = 1; n < kFrames; ++n) {
      const bool has_room = before(n);
      FrameResult result;
      REQUIRE(checks.conclude(film().view(0), tracker_->estimator(), has_room && checks.is_due(),
                              {scratch_.data(), scratch_.size()}, &result));
      if (is_noted(checks)) frames.push_back(n);
    }
    return frames;
  }

  /// Ends one more good frame. \param goes_on  out: the track is not given up.
  FrameResult conclude(FaceChecks& checks, bool is_checked = true, bool* goes_on = nullptr) {
    FrameResult result;
    result.state = TrackState::tracking;
    const bool is_kept = checks.conclude(film().view(0), tracker_->estimator(), is_checked,
                                         {scratch_.data(), scratch_.size()}, &result);
    if (goes_on != nullptr) *goes_on = is_kept;
    return result;
  }
  FaceChecks begin(float landmark_error) const {
    FaceChecks checks;
    checks.lay_out(limits_);
    checks.begin_track(landmark_error, false);
    return checks;
  }

 private:
  TrackerLimits limits_ = limits_with_fake();
  InArena<Tracker> tracker_;
  AlignedBlock scratch_;
};

}  // namespace

TEST_CASE("checks are frequent until three were good, and rare from then on") {
  FakeFaces fake(film());
  CHECK(checked(fake, [](std::size_t, FrameView&) {}) == Frames{1, 3, 5, 11, 17, 23});
}

TEST_CASE("checks stay frequent while the landmark error is large") {
  FakeFaces fake(film());
  fake.error = 1.5f * kFaceChecksTuning.doubtful_error;
  CHECK(checked(fake, [](std::size_t, FrameView&) {}) == Frames{1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23});
}

TEST_CASE("a track that was found with a covered part is degraded until a check sees the whole face") {
  // A track that stays poor for longer is given up.
  constexpr std::size_t kFew = kFaceChecksTuning.check_interval_frames * (kFaceChecksTuning.poor_checks - 1);
  struct Seen {
    std::size_t degraded = 0;
    bool at_the_end = false;
  };
  // \param least_part  of checks, until frame `until`.
  const auto play = [](float least_part, float error, std::size_t until, bool is_found = true) {
    FakeFaces fake(film());
    fake.least_part = least_part;
    fake.error = error;
    InArena<Tracker> tracker(baked_face().model, limits_with_fake());
    if (!is_found) REQUIRE(film().start_at_pose(tracker.object) == Status::ok);
    Seen seen;
    for (std::size_t n = is_found ? 0 : 1; n < kFew; ++n) {
      if (n == until) fake.least_part = 0;
      const FrameResult result = update(tracker.object, film(), n);
      REQUIRE(result.state != TrackState::lost);
      seen.at_the_end = result.state == TrackState::degraded;
      seen.degraded += seen.at_the_end;
    }
    return seen;
  };
  constexpr float kCovered = kFaceChecksTuning.least_part - 0.1f, kSeen = kFaceChecksTuning.least_part + 0.1f;
  constexpr float kDoubtful = 1.1f * kFaceChecksTuning.doubtful_error, kSmall = 0.02f;
  CHECK(play(kCovered, kDoubtful, kFew).degraded == kFew - 1);  // the first check is in frame 1
  CHECK(play(kSeen, kDoubtful, kFew).degraded == 0);
  CHECK(play(kCovered, kSmall, kFew).degraded == 0);
  const Seen uncovered = play(kCovered, kDoubtful, 10);
  CHECK(uncovered.degraded >= 9);
  CHECK(!uncovered.at_the_end);
  CHECK(play(kCovered, kDoubtful, kFew, false).degraded == 0);  // the caller has said where the face is
}

TEST_CASE("a start of the caller's is checked in its own frame, however small the budget of a frame is") {
  FakeFaces fake(film());
  TrackerLimits limits = without_edges(without_person(limits_with_fake()));
  limits.patches = 24;
  limits.key_patches = limits.key_frames = 0;
  const std::vector<std::uint8_t> rigid(baked_face().model.parameters().count, 0);
  TrackerOptions options;
  options.is_free = rigid.data();
  InArena<Tracker> tracker(baked_face().model, limits);
  REQUIRE(film().start_at_truth(tracker.object, 0, options) == Status::ok);
  CHECK(most_frame_work(limits, tracker->estimator().work_costs(limits.patch_window), 0) <
        kFaceChecksTuning.check_work);
  CHECK(fake.verifications == 1);
}

TEST_CASE("after a bad check the next frame is checked") {
  FakeFaces fake(film());
  CHECK(checked(fake, [&fake](std::size_t n, FrameView&) { fake.verification = n == 11 ? 0.01f : 0.99f; }) ==
        Frames{1, 3, 5, 11, 12, 18});
}

TEST_CASE("after bad frames the next good one is checked") {
  FakeFaces fake(film());
  const std::vector<std::uint8_t> black(320 * 240, 0);
  const auto at = checked(fake, [&black](std::size_t n, FrameView& view) {
    if (n == 7 || n == 8) view.data = black.data();
  });
  CHECK(at == Frames{1, 3, 5, 9, 15, 21});
}

TEST_CASE(
    "a track without inliers ends when each key frame in use has been tried, one with some inliers later") {
  FakeFaces fake(film());
  const TrackerLimits limits = limits_with_fake();  // has room for four key frames
  // The bad frame in which a track ends. \param blind_from, blind_to  frames without inliers.
  const auto ends_at = [&](std::size_t key_frames, int blind_from, int blind_to) {
    FaceChecks checks;
    checks.lay_out(limits);
    for (int again = 0; again < 2; ++again) {
      checks.see();  // a frame in which the face is seen: counted anew
      for (int n = 1; n < 30; ++n) {
        FrameResult result;
        result.inliers = n >= blind_from && n <= blind_to ? 0 : 12;
        if (!checks.endure(result, n, key_frames)) {
          if (again == 1) return n;
          break;
        }
      }
    }
    return 0;
  };
  CHECK(ends_at(1, 1, 30) == 4);
  CHECK(ends_at(3, 1, 30) == 6);
  CHECK(ends_at(5, 1, 30) == 8);
  CHECK(ends_at(1, 3, 30) == 6);
  CHECK(ends_at(1, 2, 4) == 8);
  CHECK(ends_at(1, 0, 0) == 8);
}

TEST_CASE(
    "blind frames of earlier rows are forgotten when the face is seen, good or aligned, and by a new track") {
  FakeFaces fake(film());
  FaceChecks checks;
  checks.lay_out(limits_with_fake());
  const FrameResult blind;
  const auto is_kept = [&](int n) { return checks.endure(blind, n, 1); };
  for (int row = 0; row < 3; ++row) {
    CHECK(is_kept(1));
    CHECK(is_kept(2));
    CHECK(is_kept(3));
    row == 0 ? checks.see() : checks.begin_track(0.02f, false);
  }
  CHECK(is_kept(2));  // the first after an aligned one, which counts as bad
  CHECK(is_kept(3));
  CHECK(is_kept(4));
  CHECK_FALSE(is_kept(5));
}

TEST_CASE("a check that is due waits for a frame with room") {
  FakeFaces fake(film());
  StandingTrack track;
  int asked = 0;
  const auto checked_where = [&](auto&& has_room) {
    return track.play(
        0.02f, [&](std::size_t n) { return asked = fake.verifications, has_room(n); },
        [&](const FaceChecks&) { return fake.verifications > asked; });
  };
  CHECK(checked_where([](std::size_t) { return true; }) == Frames{2, 4, 6, 12, 18});
  CHECK(checked_where([](std::size_t n) { return n != 4 && n != 5 && n != 13; }) == Frames{2, 6, 8, 14, 20});
  CHECK(checked_where([](std::size_t n) { return n == 21; }) == Frames{21});
}

TEST_CASE(
    "until it is confirmed, an aligned start has urgent checks; a start from points has one after a bad "
    "check only") {
  FakeFaces fake(film());
  StandingTrack track;
  const auto urgent_after = [&](float landmark_error, std::size_t bad) {
    return track.play(
        landmark_error, [&](std::size_t n) { return fake.verification = n == bad ? 0.01f : 0.99f, true; },
        [](const FaceChecks& checks) { return checks.is_urgent(); });
  };
  CHECK(urgent_after(0.02f, 0) == Frames{1, 3, 5});
  CHECK(urgent_after(0.02f, 12) == Frames{1, 3, 5, 12});
  CHECK(urgent_after(0, 0).empty());
  CHECK(urgent_after(0, 11) == Frames{11});
}

TEST_CASE(
    "a person is known after so many good checks in a row, and has to become known anew in each track") {
  FakeFaces fake(film());
  StandingTrack track;
  FaceChecks checks = track.begin(0.02f);
  for (int good = 1; good <= kFaceChecksTuning.checks_of_known_person; ++good) {
    CHECK_FALSE(checks.has_confirmed());
    if (good == 2) {  // a bad one: all over again
      fake.verification = 0.9f * kFaceChecksTuning.least_first_check;
      CHECK(track.conclude(checks).state == TrackState::degraded);
      CHECK(checks.is_refuted());
      fake.verification = 1.1f * kFaceChecksTuning.least_first_check;
      track.conclude(checks);
      CHECK_FALSE(checks.is_refuted());
    }
    CHECK(track.conclude(checks).state == TrackState::tracking);
  }
  CHECK(checks.has_confirmed());
  fake.verification = 1.1f * kFaceChecksTuning.least_check;  // of a known person that is good
  track.conclude(checks);
  CHECK_FALSE(checks.is_refuted());
  fake.verification = 0.9f * kFaceChecksTuning.least_check;
  CHECK(track.conclude(checks).state == TrackState::tracking);  // once may be a mistake
  CHECK(checks.is_refuted());
  checks.begin_track(0.02f, true);
  CHECK_FALSE(checks.is_refuted());
  CHECK_FALSE(checks.has_confirmed());
}

TEST_CASE("a track is given up after so many bad checks in a row") {
  FakeFaces fake(film());
  StandingTrack track;
  FaceChecks checks = track.begin(0.02f);
  for (const bool is_last_row : {false, true}) {
    fake.verification = 0.01f;
    for (int bad = 1; bad <= kFaceChecksTuning.most_bad_checks - !is_last_row; ++bad) {
      bool goes_on = false;
      track.conclude(checks, true, &goes_on);
      CHECK(goes_on == (bad < kFaceChecksTuning.most_bad_checks));
    }
    fake.verification = 0.99f;
    if (!is_last_row) track.conclude(checks);
  }
}

TEST_CASE("the patience with poor tracks doubles with each, up to the most, and a good check restores it") {
  FakeFaces fake(film());
  StandingTrack track;
  FaceChecks checks = track.begin(0.02f);
  const auto play_poor = [&] {  // \return checks until the track has stayed poor
    fake.error = 0.2f;
    int count = 0;
    for (checks.begin_track(fake.error, false); !checks.has_stayed_poor(); ++count) track.conclude(checks);
    return count;
  };
  for (int most = kFaceChecksTuning.poor_checks; most < kFaceChecksTuning.most_poor_checks; most *= 2)
    CHECK(play_poor() == most);
  for (int k = 0; k < 2; ++k) CHECK(play_poor() == kFaceChecksTuning.most_poor_checks);
  fake.error = 0.01f;
  checks.begin_track(fake.error, false);
  track.conclude(checks);
  CHECK(play_poor() == kFaceChecksTuning.poor_checks);
}

TEST_CASE(
    "the landmark error begins with that of the alignment, or of the first check, and follows the checks "
    "slowly") {
  FakeFaces fake(film());
  StandingTrack track;
  for (const float at_start : {0.0f, 0.03f}) {
    FaceChecks checks = track.begin(at_start);
    CHECK(track.conclude(checks, false).landmark_error == at_start);
    fake.error = 0.02f;
    const float first = at_start > 0 ? at_start + kFaceChecksTuning.error_rate * (0.02f - at_start) : 0.02f;
    CHECK(track.conclude(checks).landmark_error == doctest::Approx(double(first)));
    fake.error = 0.06f;
    CHECK(track.conclude(checks).landmark_error ==
          doctest::Approx(double(first + kFaceChecksTuning.error_rate * (0.06f - first))));
  }
}

TEST_CASE("a person whose face was seen whole is not in doubt when a track of theirs begins anew") {
  FakeFaces fake(film());
  StandingTrack track;
  fake.error = 1.1f * kFaceChecksTuning.doubtful_error;
  fake.least_part = kFaceChecksTuning.least_part - 0.1f;
  FaceChecks checks = track.begin(fake.error);
  CHECK(track.conclude(checks).state == TrackState::degraded);  // covered
  fake.least_part = kFaceChecksTuning.least_part + 0.1f;
  CHECK(track.conclude(checks).state == TrackState::tracking);
  fake.least_part = kFaceChecksTuning.least_part - 0.1f;
  checks.begin_track(fake.error, true);
  CHECK(track.conclude(checks).state == TrackState::tracking);
  checks.begin_track(fake.error, false);
  CHECK(track.conclude(checks).state == TrackState::degraded);
}

TEST_CASE("a head that is turned by more than 50 degrees is degraded, and tracked on") {
  const FaceFilm film(
      320, 240, 2 * kFrames,
      [](float s, Pose& pose, auto&) {
        pose.q = exp_rotation({0, 1.05f * std::sin(3.1416f * s), 0}) * pose.q;
      },
      0.5f);
  FakeFaces fake(film);
  const TrackerLimits limits = limits_with_fake();
  InArena<Tracker> tracker(baked_face().model, limits);
  for (std::size_t n = 0; n < film.count(); ++n) {
    FrameResult result;
    REQUIRE(tracker->update(film.view(n), &result) == Status::ok);
    const float turn = 57.3f * length(log_rotation(film.poses[n].q * conjugate(film.poses[0].q)));
    CAPTURE(n);
    CAPTURE(turn);
    CHECK(film.turn_error(result.pose, n) < 3);
    if (turn < 46) CHECK(result.state == TrackState::tracking);
    if (turn > 54) CHECK(result.state == TrackState::degraded);
  }
}

TEST_CASE("a check fits into memory that is unused between frames, also beside second looks, which may take less") {
  for (const int expressions : {0, 100, 180}) {
    CAPTURE(expressions);
    ModelBuilder builder = egg_model(1);
    for (int k = 0; k < expressions; ++k) {
      const std::uint16_t q = builder.parameter("e" + std::to_string(k), Group::expression, 0, 1, 0.3f);
      builder.record(Operation::add_vector, {builder.last()}, {q}, 0);
    }
    builder.detector = builder.aligner = {0, 0, 0, 0};
    const OpenModel opened(builder);
    TrackerLimits limits = without_edges(without_person(TrackerLimits{}));
    limits.width = 160, limits.height = 120;
    limits.patches = 48;
    limits.free_parameters = 40;
    REQUIRE(limits.second_look != nullptr);
    InArena<ImageParts> parts(opened.model, limits);
    Arena arena(parts->unused_between_frames.data, parts->unused_between_frames.count);
    CHECK(limits.detection->modules->lay_out_for_known_person(arena, opened.model) != nullptr);
    CHECK(!arena.exhausted());
  }
}

}  // namespace face_checks_test
