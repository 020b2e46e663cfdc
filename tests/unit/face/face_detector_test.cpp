// Detection of rendered faces, and of no face in other images.
#include "pliant/face_detector.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "baked_face.hpp"
#include "heap_trap.hpp"
#include "model_builder.hpp"
#include "random.hpp"
#include "renderer.hpp"

using namespace pliant;

namespace {

constexpr int kWidth = 320, kHeight = 240;
const Camera kCamera = centred_camera(kWidth, kHeight, 1.4f * kWidth);

/// Boxes and ellipses of all sizes on a textured background.
Picture clutter(Random& random, std::uint32_t seed, int things) {
  Picture image = make_backdrop(kWidth, kHeight, seed);
  for (int k = 0; k < things; ++k) {
    const float cx = random.uniform(0, kWidth), cy = random.uniform(0, kHeight);
    const float a = random.uniform(3, 60), b = random.uniform(2, 40), angle = random.uniform(0, 3.14f);
    const float c = std::cos(angle), s = std::sin(angle), grey = random.uniform(20, 235);
    const bool is_box = random.uniform(0, 1) < 0.5f;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const float dx = static_cast<float>(x) - cx, dy = static_cast<float>(y) - cy;
        const float u = (c * dx + s * dy) / a, v = (c * dy - s * dx) / b;
        const bool is_in = is_box ? std::fabs(u) < 1 && std::fabs(v) < 1 : u * u + v * v < 1;
        if (is_in) image.at(x, y) = static_cast<std::uint8_t>(0.3f * float(image.at(x, y)) + 0.7f * grey);
      }
  }
  return image;
}

struct Sitting {
  std::vector<float> q;
  Pose pose;
  Picture picture;
};

/// A random identity at a random place in clutter, with random brightness and noise.
Sitting someone(Random& random, std::uint32_t seed, float size) {
  static Renderer renderer(baked_face().cascade, 120);
  Sitting s;
  for (const Parameter& p : baked_face().model.parameters())
    s.q.push_back(p.group == Group::identity ? std::clamp(random.normal(), -2.0f, 2.0f) : 0.0f);
  s.pose = frontal_pose(baked_face().cascade, s.q.data(), kCamera, kHeight, size / kHeight);
  const float yaw = random.uniform(-0.35f, 0.35f), pitch = random.uniform(-0.26f, 0.26f),
              roll = random.uniform(-0.35f, 0.35f);
  s.pose.q = normalised(exp_rotation({0, 0, roll}) * exp_rotation({0, yaw, 0}) * exp_rotation({pitch, 0, 0}));
  const Vec3 aside{0.5f * (kWidth - size) * random.uniform(-1, 1),
                   0.5f * (kHeight - size) * random.uniform(-1, 1), 0};
  s.pose.t = s.pose.t + (s.pose.t.z / kCamera.f) * aside;
  s.picture =
      renderer.draw(s.q.data(), s.pose, kCamera, clutter(random, seed, 12), random.uniform(0.5f, 1.2f));
  add_noise(s.picture, random.uniform(1, 4), seed);
  return s;
}

/// Mean distance of the 51 inner landmarks, px.
float landmark_error(const Sitting& truth, const Pose& pose, const float* q) {
  BakedModel& face = baked_face();
  const Projector a(view_of(truth.pose, kCamera), true), b(view_of(pose, kCamera), true);
  float sum = 0;
  for (int l = 17; l < 68; ++l) {
    const Vec2 uv = face.uv("ibug" + std::to_string(l));
    Vec2 x, y;
    REQUIRE(a.project(face.cascade.surface_point(uv, truth.q.data()), &x));
    REQUIRE(b.project(face.cascade.surface_point(uv, q), &y));
    sum += length(x - y);
  }
  return sum / 51;
}

struct Finding {
  InArena<FaceDetector> detector{baked_face().model, FaceDetectorLimits{}};
  FaceDetectorReport report;
  Finding() { REQUIRE(detector->begin(kCamera, {}) == Status::ok); }
  void search(const Picture& image) { REQUIRE(detector->find(image.view(), &report) == Status::ok); }
};

}  // namespace

TEST_CASE("rendered faces within 20 degrees of yaw and roll and 15 of pitch, 80 to 200 px high, are found") {
  Finding f;
  Random random(7);
  std::vector<float> turns;
  const int people = 16;
  int found = 0;
  for (int k = 0; k < people; ++k) {
    const float size = random.uniform(80, 200);
    const Sitting s = someone(random, static_cast<std::uint32_t>(k + 1), size);
    f.search(s.picture);
    CAPTURE(k);
    CAPTURE(size);
    CAPTURE(f.report.similarity);
    if (!f.report.is_found) continue;
    ++found;
    CHECK(landmark_error(s, f.report.pose, f.detector->parameters().data) < 0.04f * size);
    turns.push_back(57.29578f * length(log_rotation(f.report.pose.q * conjugate(s.pose.q))));
  }
  CHECK(found >= people - 1);
  std::sort(turns.begin(), turns.end());
  CHECK(turns[turns.size() / 2] < 8);
}

TEST_CASE("no face is found in clutter, black, noise, an upside-down face and one that is too small") {
  Finding f;
  Random random(3);
  const auto check_no_face = [&](const Picture& image) {
    f.search(image);
    CHECK_FALSE(f.report.is_found);
    CHECK(f.report.similarity < FaceDetectorOptions{}.min_similarity);
  };
  for (std::uint32_t seed = 1; seed < 8; ++seed) {
    CAPTURE(seed);
    Picture image = clutter(random, 50 + seed, static_cast<int>(10 * seed));
    add_noise(image, 3, seed);
    check_no_face(image);
  }
  check_no_face(Picture(kWidth, kHeight, 0));
  check_no_face(Picture(kWidth, kHeight, 255));
  Picture noise(kWidth, kHeight, 128);
  add_noise(noise, 40, 9);
  check_no_face(noise);
  Sitting s = someone(random, 5, 160);
  std::reverse(s.picture.pixels.begin(), s.picture.pixels.end());
  check_no_face(s.picture);
  check_no_face(someone(random, 6, 30).picture);
}

TEST_CASE("the same frame gives the same bits, whatever was searched before, and no heap is used") {
  Finding f;
  Random random(11);
  const Sitting s = someone(random, 2, 150);
  f.search(s.picture);
  REQUIRE(f.report.is_found);
  const FaceDetectorReport first = f.report;
  const std::vector<float> q(f.detector->parameters().begin(), f.detector->parameters().end());
  f.search(clutter(random, 9, 20));
  {
    const heap_trap::Armed armed;
    (void)f.detector->find(s.picture.view(), &f.report);
  }
  CHECK(heap_trap::calls == 0);
  CHECK(f.report.similarity == first.similarity);
  CHECK(f.report.pose.t.z == first.pose.t.z);
  CHECK(f.report.pose.q.x == first.pose.q.x);
  CHECK(std::equal(q.begin(), q.end(), f.detector->parameters().begin()));
}

TEST_CASE("compare tells a right pose from one beside the face and from a frame without it") {
  Finding f;
  Random random(13);
  const Sitting s = someone(random, 4, 140);
  float there = 0, beside = 0, nowhere = 0;
  REQUIRE(f.detector->compare(s.picture.view(), s.pose, s.q.data(), &there) == Status::ok);
  Pose pose = s.pose;
  pose.t.x += 40;
  REQUIRE(f.detector->compare(s.picture.view(), pose, s.q.data(), &beside) == Status::ok);
  REQUIRE(f.detector->compare(clutter(random, 4, 15).view(), s.pose, s.q.data(), &nowhere) == Status::ok);
  CHECK(there > 0.6f);
  CHECK(beside < 0.35f);
  CHECK(nowhere < 0.35f);
}

TEST_CASE("bad arguments get a named status, and a block that is a byte too small is refused") {
  InArena<FaceDetector> detector(baked_face().model, FaceDetectorLimits{});
  FaceDetectorReport report;
  const Picture grey(kWidth, kHeight, 90);
  FrameView frame = grey.view();
  CHECK(detector->find(frame, &report) == Status::not_started);
  FaceDetectorOptions options;
  options.largest_fraction = 0.1f;
  CHECK(detector->begin(kCamera, options) == Status::bad_argument);
  CHECK(detector->begin(Camera{}, {}) == Status::bad_argument);
  REQUIRE(detector->begin(kCamera, {}) == Status::ok);
  CHECK(detector->find(frame, nullptr) == Status::bad_argument);
  CHECK(detector->compare(frame, Pose{}, nullptr, nullptr) == Status::bad_argument);
  float similarity;
  std::vector<float> q = baked_face().rest();
  for (const float z : {-400.0f, 0.0f, 1e-30f, 1e30f, NAN}) {
    const Pose pose{{}, {0, 0, z}};
    CHECK(detector->compare(frame, pose, q.data(), &similarity) == Status::bad_argument);
  }
  frame.width = 100;
  CHECK(detector->find(frame, &report) == Status::size_mismatch);
  frame.data = nullptr;
  CHECK(detector->find(frame, &report) == Status::bad_argument);

  const auto words = egg_model(3).table();
  Model egg;
  REQUIRE(Model::open(words.data(), words.size() * 4, &egg) == Status::ok);
  InArena<FaceDetector> none(egg, FaceDetectorLimits{});
  CHECK(none->begin(kCamera, {}) == Status::not_found);

  const std::size_t bytes = measured_bytes<FaceDetector>(baked_face().model, FaceDetectorLimits{});
  MESSAGE("bytes " << bytes);
  std::vector<std::uint64_t> block(bytes / 8 + 4);
  auto* memory = reinterpret_cast<unsigned char*>(block.data());
  memory += (16 - reinterpret_cast<std::uintptr_t>(memory) % 16) % 16;
  Arena arena(memory, bytes - 1);
  FaceDetector small;
  CHECK(create_in(arena, small, baked_face().model, FaceDetectorLimits{}) == Status::out_of_memory);
}
