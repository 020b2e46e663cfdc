#include "face/rolled_detector.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <set>
#include <vector>

#include "aligned_block.hpp"
#include "detector_pattern.hpp"
#include "texture.hpp"

namespace rolled_detector_test {

using namespace pliant;
using texture::Picture;

namespace {

constexpr int kWidth = 240, kHeight = 200, kPeriod = kRolledDetectorTuning.period;

struct Rig {
  detector_pattern::Bytes table = detector_pattern::table();
  AlignedBlock block;
  RolledDetector detector;

  explicit Rig(const Quat& expected = {}, float aspect = 1)
      : block(measured_bytes<RolledDetector>(table.span(), limits(), expected, aspect)) {
    Arena arena(block.data(), block.size());
    REQUIRE(create_in(arena, detector, table.span(), limits(), expected, aspect) == Status::ok);
    REQUIRE(detector.status() == Status::ok);
  }
  static FaceDetectorLimits limits() {
    FaceDetectorLimits l;
    l.width = kWidth;
    l.height = kHeight;
    return l;
  }
  /// The number of the search in which a face is found at this turn, from 0; -1: in none of two rounds. Others do not count: the
  /// pattern is round, and the table takes some turned ones for upright.
  int searches_until_found(const Picture& picture, int turn, std::uint32_t work, DetectedFace* face) {
    int searches = 0;
    for (bool is_complete = false; searches < 2 * kPeriod * kTurnsOfPicture;
         searches += is_complete ? 1 : 0) {
      std::size_t count = 0;
      REQUIRE(detector.search(picture.frame(), work, {face, 1}, &count, &is_complete) == Status::ok);
      if (count > 0 && face->roll == roll_of_turn(turn)) return searches;
    }
    return -1;
  }
};

/// A pattern whose middle is at `middle`, turned clockwise by so many eighths. \param side  along x.
Picture turned_pattern(int eighths, Vec2 middle, double side, double aspect = 1) {
  const double angle = static_cast<double>(roll_of_turn(eighths));
  Picture upright(400, 400, 120), out(kWidth, kHeight, 120);
  detector_pattern::draw(&upright, 200, 200, side);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const double dx = x - static_cast<double>(middle.x), dy = (y - static_cast<double>(middle.y)) / aspect;
      const int i = static_cast<int>(std::lround(200 + std::cos(angle) * dx + std::sin(angle) * dy));
      const int j = static_cast<int>(std::lround(200 - std::sin(angle) * dx + std::cos(angle) * dy));
      if (i >= 0 && j >= 0 && i < 400 && j < 400) out.at(x, y) = upright.at(i, j);
    }
  return out;
}

Quat rotation_of(int eighths) {
  return exp_rotation({0, 0, roll_of_turn(eighths)});
}

void check_is_at(const DetectedFace& face, Vec2 middle, double side, int turn) {
  CHECK(length(face.box.center - middle) < 0.1 * side);
  CHECK(static_cast<double>(face.box.side) == doctest::Approx(side).epsilon(0.15));
  CHECK(face.roll == doctest::Approx(static_cast<double>(roll_of_turn(turn))));
}

}  // namespace

TEST_CASE("a pattern is found at any eighth of a turn, where it is in the frame") {
  Rig rig;
  for (int turn = 0; turn < kTurnsOfPicture; ++turn) {
    CAPTURE(turn);
    DetectedFace faces[4];
    std::size_t count = 0;
    const Picture picture = turned_pattern(turn, {100, 110}, 110), empty(kWidth, kHeight, 99);
    REQUIRE(rig.detector.find_at(turn, picture.frame(), {faces, 4}, &count) == Status::ok);
    REQUIRE(count == 1);
    check_is_at(faces[0], {100, 110}, 110, turn);
    REQUIRE(rig.detector.find_at(turn, empty.frame(), {faces, 4}, &count) == Status::ok);
    CHECK(count == 0);
  }
}

TEST_CASE("a pattern in a frame whose pixels are not square is found at any turn, and near its box") {
  for (const float aspect : {0.5f, 0.8f, 1.6f, 2.0f})
    for (int turn = 0; turn < kTurnsOfPicture; ++turn) {
      CAPTURE(aspect);
      CAPTURE(turn);
      const double side = aspect < 1 ? 140 : 85;
      const Vec2 middle{110, 105};
      Rig rig(rotation_of(turn), aspect);
      DetectedFace faces[4];
      std::size_t count = 0;
      const Picture picture = turned_pattern(turn, middle, side, static_cast<double>(aspect));
      REQUIRE(rig.detector.find_at(turn, picture.frame(), {faces, 4}, &count) == Status::ok);
      REQUIRE(count >= 1);
      check_is_at(faces[0], middle, side, turn);
      DetectedFace face;
      REQUIRE(rig.detector.search_near(picture.frame(), faces[0].box, &face) == Status::ok);
      check_is_at(face, middle, side, turn);
    }
}

TEST_CASE("most searches are at the expected turn; the others follow, each once in a round") {
  std::set<int> when;
  DetectedFace face;
  for (int turn = 0; turn < kTurnsOfPicture; ++turn) {
    CAPTURE(turn);
    const Picture picture = turned_pattern(turn, {100, 110}, 110);
    CHECK(Rig(rotation_of(turn)).searches_until_found(picture, turn, 1000000, &face) == 0);
    const int searches = Rig().searches_until_found(picture, turn, 1000000, &face);
    check_is_at(face, {100, 110}, 110, turn);
    CHECK(searches % kPeriod == (turn == 0 ? 0 : kPeriod - 1));
    CHECK(searches < kPeriod * (kTurnsOfPicture - 1));
    when.insert(searches);
  }
  CHECK(when.size() == kTurnsOfPicture);
}

TEST_CASE("a search in parts stays at its turn until the whole frame has been searched") {
  for (const int turn : {0, 2, 7}) {
    CAPTURE(turn);
    DetectedFace whole, parts;
    const Picture picture = turned_pattern(turn, {120, 100}, 90);
    const int at = Rig().searches_until_found(picture, turn, 1000000, &whole);
    CHECK(at >= 0);
    CHECK(Rig().searches_until_found(picture, turn, 300, &parts) == at);
    CHECK(length(parts.box.center - whole.box.center) < 10);
  }
}

TEST_CASE(
    "near a box a pattern is found at the roll of the face that was there, and nothing in an empty frame") {
  Rig rig;
  const Picture empty(kWidth, kHeight, 120);
  for (int turn = 0; turn < kTurnsOfPicture; ++turn) {
    CAPTURE(turn);
    const Picture picture = turned_pattern(turn, {100, 110}, 110);
    const FaceBox near{{108, 103}, 120};
    const DetectedFace seen{near, 0.5f, roll_of_turn(turn) + 0.2f};
    DetectedFace face = seen;
    CHECK(rig.detector.search_near(picture.frame(), near, &face) == Status::ok);
    check_is_at(face, {100, 110}, 110, turn);
    face = seen;
    CHECK(rig.detector.search_near(empty.frame(), near, &face) == Status::not_found);
  }
}

TEST_CASE("near a place where no face was detected a pattern is found at the expected turn") {
  for (int turn = 0; turn < kTurnsOfPicture; ++turn) {
    CAPTURE(turn);
    Rig rig(rotation_of(turn));
    DetectedFace face;
    const Picture picture = turned_pattern(turn, {100, 110}, 110);
    CHECK(rig.detector.search_near(picture.frame(), {{108, 103}, 120}, &face) == Status::ok);
    check_is_at(face, {100, 110}, 110, turn);
  }
}

TEST_CASE("nothing is found in frames that are too small for a face, of any size from 1 x 1 on") {
  Rig rig;
  DetectedFace face;
  std::size_t count = 7;
  for (const int side : {1, 2, 30}) {
    const Picture small(side, side, 9);
    CHECK(rig.detector.find_at(3, small.frame(), {&face, 1}, &count) == Status::ok);
    CHECK(count == 0);
  }
}

}  // namespace rolled_detector_test
