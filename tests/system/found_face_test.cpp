// Faces that nobody pointed at: found in pictures, aligned and verified, with the learnt tables of the built-in face.
#include <doctest/doctest.h>

#include <cstring>

#include "aligned_block.hpp"
#include "host/bench/annotated_faces.hpp"
#include "host/bench/still_film.hpp"
#include "host/commands/face_finder.hpp"
#include "host/io/points_file.hpp"
#include "host/render/scene.hpp"
#include "random.hpp"

namespace found_face_test {

using namespace pliant;
using namespace pliant::host;

namespace {

const std::string kAstronaut = PLIANT_FIXTURES "/astronaut";

const ModelFile& face_file() {
  static const ModelFile file(PLIANT_DETECTING_FACE);
  return file;
}

NamedLandmarks named(const FoundFace& face) {
  NamedLandmarks out;
  for (std::size_t k = 0; k < face.landmarks.size(); ++k)
    out[face_file().model().landmarks()[k].name] = face.landmarks[k];
  return out;
}

NamedLandmarks astronaut_truth() {
  NamedLandmarks truth;
  for (const host::NamedPoint& p : read_points(kAstronaut + "/points.csv")) truth[p.name] = p.x;
  return truth;
}

const Image& astronaut() {
  static const Image grey = to_grey(read_image(kAstronaut + "/astronaut.png"));
  return grey;
}

Image cut_out(const Image& grey, int x, int y, int width, int height) {
  Image out(width, height, 1, 0);
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i)
      if (grey.contains(x + i, y + j)) *out.at(i, j) = *grey.at(x + i, y + j);
  return out;
}

Image noise(int width, int height, std::uint64_t seed) {
  Random random(seed);
  Image out(width, height, 1, 0);
  for (std::uint8_t& pixel : out.pixels) pixel = static_cast<std::uint8_t>(random.bits() >> 24);
  return out;
}

}  // namespace

TEST_CASE("one face is found in a photograph, and its landmarks are where people put them") {
  FaceFinder finder(face_file());
  const NamedLandmarks truth = astronaut_truth();
  for (const float scale : {0.6f, 1.0f, 1.7f}) {
    CAPTURE(scale);
    const auto faces = finder.find(resized(astronaut(), scale), "astronaut", 0.5f);
    REQUIRE(faces.size() == 1);
    const double error = landmark_error(named(faces[0]), moved(truth, scale, {0, 0}));
    MESSAGE("landmarks " << 100 * error << " %, expected " << 100 * faces[0].aligned.landmark_error << " %");
    CHECK(error < 0.05);
    CHECK(faces[0].aligned.landmark_error < 0.08f);
  }
}

TEST_CASE("all faces of a large group are found") {
  FaceFinder finder(face_file());
  const FaceBox box = finder.find(astronaut(), "astronaut", 0.5f).at(0).box;
  const float scale = 80 / box.side;
  const Image one = resized(astronaut(), scale);
  constexpr int kAcross = 15, kDown = 10, kStep = 127;
  Image group(kAcross * kStep, kDown * kStep, 1, 0);
  for (int j = 0; j < group.height; ++j)
    for (int i = 0; i < group.width; ++i)
      *group.at(i, j) = *one.at(static_cast<int>(scale * box.center.x) - kStep / 2 + i % kStep,
                                static_cast<int>(scale * box.center.y) - kStep / 2 + j % kStep + 10);
  CHECK(finder.find(group, "group", 0.5f).size() == kAcross * kDown);
}

TEST_CASE(
    "a mask over the mouth and dark glasses show in the least part, and a picture in low light does not") {
  const NamedLandmarks truth = astronaut_truth();
  const float eyes = eye_distance(truth);
  FaceFinder finder(face_file());
  const auto least_part = [&](const Image& picture) {
    const auto faces = finder.find(picture, "astronaut", 0.5f);
    REQUIRE(faces.size() == 1);
    MESSAGE("least part " << faces[0].aligned.least_part << ", landmarks "
                          << 100 * landmark_error(named(faces[0]), truth) << " %, expected "
                          << 100 * faces[0].aligned.landmark_error << " %");
    return faces[0].aligned.least_part;
  };
  // Two landmarks, how far around them, over the eyes' distance, and with what.
  const auto covered = [&](const char* a, const char* b, float up, float down, int grey) {
    Image picture = astronaut();
    const Vec2 left = truth.at(a), right = truth.at(b);
    for (int j = static_cast<int>(min(left.y, right.y) - up * eyes);
         j < static_cast<int>(max(left.y, right.y) + down * eyes); ++j)
      for (int i = static_cast<int>(left.x - 0.3f * eyes); i < static_cast<int>(right.x + 0.3f * eyes); ++i)
        if (picture.contains(i, j)) *picture.at(i, j) = static_cast<std::uint8_t>(grey + (3 * i + j) % 9);
    return picture;
  };
  Image dark = astronaut();
  for (std::uint8_t& grey : dark.pixels) grey = static_cast<std::uint8_t>(grey / 4);
  CHECK(least_part(astronaut()) > -1);
  CHECK(least_part(dark) > -1);
  CHECK(least_part(covered("ibug48", "ibug54", 0.2f, 0.3f, 150)) < -2);
  CHECK(least_part(covered("ibug36", "ibug45", 0.15f, 0.15f, 60)) < -2);
}

TEST_CASE("an aligner that borrows scratch memory keeps less, and finds the same landmarks") {
  FaceFinder finder(face_file());
  const Image picture = resized(astronaut(), 0.6f);
  const FaceBox box = finder.find(picture, "astronaut", 0.5f).at(0).box;
  const Model& model = face_file().model();
  const FrameView frame{picture.pixels.data(), picture.width, picture.height,
                        static_cast<std::size_t>(picture.width)};
  const Camera camera =
      centred_camera(picture.width, picture.height, 1.25f * static_cast<float>(picture.width));
  std::vector<Vec2> found[2];
  std::size_t bytes[2];
  for (const bool borrows : {false, true}) {
    AlignedBlock kept(200'000), lent(FaceAligner::scratch_bytes(model));
    Arena arena(kept.data(), kept.size()), scratch(lent.data(), lent.size());
    FaceAligner aligner;
    if (borrows)
      aligner.lay_out_spread(arena, model);
    else
      aligner.lay_out(arena, model);
    bytes[borrows] = arena.used_bytes();
    found[borrows].resize(model.landmarks().count);
    std::vector<float> q(model.parameters().count);
    AlignedFace face;
    const auto align = [&] {
      return aligner.align(frame, box, camera, &face, q.data(),
                           {found[borrows].data(), found[borrows].size()});
    };
    if (borrows) CHECK(align() == Status::capacity);
    aligner.lay_out_scratch(scratch);
    CHECK_FALSE(scratch.exhausted());
    CHECK((scratch.used_bytes() > 0) == borrows);
    REQUIRE(align() == Status::ok);
    Arena small(lent.data(), lent.size() / 2), measuring;
    for (Arena* of : {&small, &measuring}) {
      aligner.lay_out_scratch(*of);
      REQUIRE(aligner.status() == (borrows ? Status::capacity : Status::ok));
      CHECK(align() == aligner.status());
    }
  }
  CHECK(bytes[true] < 0.35 * static_cast<double>(bytes[false]));
  for (std::size_t k = 0; k < found[0].size(); ++k) CHECK(length(found[true][k] - found[false][k]) == 0);
}

TEST_CASE("a face in a noisy picture is found and aligned, since the picture is smoothed") {
  FaceFinder finder(face_file());
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    CAPTURE(seed);
    Image noisy = resized(astronaut(), 0.7f);
    add_noise(noisy, 36, seed);
    const auto faces = finder.find(noisy, "astronaut", 0.5f);
    REQUIRE_FALSE(faces.empty());  // noise is sometimes taken for another face
    CHECK(landmark_error(named(faces[0]), moved(astronaut_truth(), 0.7f, {0, 0})) < 0.05);
  }
}

TEST_CASE("a face that the border cuts is found, or it is not: the landmarks stay finite") {
  FaceFinder finder(face_file());
  for (const int x : {150, 190, 215, 230})
    for (const int y : {20, 90, 120}) {
      const auto faces = finder.find(cut_out(astronaut(), x, y, 200, 200), "cut", 0);
      for (const FoundFace& face : faces)
        for (const Vec2 p : face.landmarks) CHECK((is_finite(p) && length(p) < 2000));
    }
}

TEST_CASE("pictures of any size without a face have none") {
  FaceFinder finder(face_file());
  constexpr struct {
    int width, height;
  } kSizes[] = {{1, 1}, {1, 300}, {300, 1}, {47, 47}, {48, 48}, {8192, 49}, {49, 8192}, {640, 480}};
  for (const auto& size : kSizes) {
    CAPTURE(size.width);
    CAPTURE(size.height);
    CHECK(finder.find(Image(size.width, size.height, 1, 128), "even", 0.5f).empty());
    CHECK(finder.find(noise(size.width, size.height, 3), "noise", 0.5f).empty());
  }
  CHECK_THROWS(finder.find(Image(8193, 10, 1, 0), "too wide", 0.5f));
}

TEST_CASE("a box says which face is aligned; one outside the picture finds none") {
  FaceFinder finder(face_file());
  const auto faces = finder.find(astronaut(), "astronaut", 0.5f);
  REQUIRE(faces.size() == 1);
  const auto again = finder.align(astronaut(), faces[0].box);
  REQUIRE(again.has_value());
  CHECK(landmark_error(named(*again), astronaut_truth()) < 0.06);
  CHECK_FALSE(finder.align(astronaut(), {{-5000, -5000}, 100}).has_value());
}

}  // namespace found_face_test
