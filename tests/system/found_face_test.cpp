// Faces that nobody pointed at: found in pictures, aligned and verified, with the learnt tables of the built-in face.
#include <doctest/doctest.h>

#include <cstring>

#include "host/bench/annotated_faces.hpp"
#include "host/bench/still_film.hpp"
#include "host/commands/face_finder.hpp"
#include "host/io/points_file.hpp"
#include "host/render/scene.hpp"
#include "random.hpp"

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
