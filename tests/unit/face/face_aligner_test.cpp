// The aligner's interface, with tables made by hand: what it accepts, what it returns, what it leaves unchanged. How well a learnt
// table aligns is tested on the host (learn_aligner_test.cpp).
#include "pliant/face_aligner.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include "aligned_block.hpp"
#include "aligner_pattern.hpp"
#include "baked_face.hpp"
#include "random.hpp"
#include "renderer.hpp"

namespace face_aligner_test {

using namespace pliant;
using aligner_pattern::Bytes;

namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// An aligner with its memory, and room for its results.
struct Rig {
  Bytes table;
  AlignedBlock block;
  Arena arena;
  FaceAligner aligner;
  AlignedFace face;
  std::vector<float> q;
  std::vector<Vec2> landmarks;

  explicit Rig(Bytes bytes = aligner_pattern::table(), const Model& model = baked_face().model)
      : table(std::move(bytes)),
        block(measured_bytes<FaceAligner>(model, table.span())),
        arena(block.data(), block.size()),
        q(model.parameters().count),
        landmarks(model.landmarks().count) {
    REQUIRE(create_in(arena, aligner, model, table.span()) == Status::ok);
  }
  Status align(const FrameView& frame, const FaceBox& box, const AlignOptions& options = {}) {
    return aligner.align(frame, box, camera_of_frame(frame), &face, q.data(),
                         {landmarks.data(), landmarks.size()}, options);
  }
  static Camera camera_of_frame(const FrameView& frame) {
    const int side = frame.width > frame.height ? frame.width : frame.height;
    return centred_camera(frame.width, frame.height, kDefaultFocalRatio * static_cast<float>(side));
  }
  Vec2 landmark(const char* name) const { return landmarks[baked_face().model.find_landmark(name)]; }
  FaceBox box() const {
    const Camera camera = face.camera;
    return face_box_of(landmark("ibug36"), landmark("ibug45"), landmark("ibug48"), landmark("ibug54"),
                       view_of(face.pose, camera).s);
  }
};

const Picture& backdrop() {
  static const Picture picture = make_backdrop(320, 240, 3);
  return picture;
}

bool are_equal(const Rig& a, const Rig& b) {
  return std::memcmp(&a.face.pose, &b.face.pose, sizeof(Pose)) == 0 && a.q == b.q &&
         std::memcmp(a.landmarks.data(), b.landmarks.data(), a.landmarks.size() * sizeof(Vec2)) == 0 &&
         a.face.score == b.face.score && a.face.landmark_error == b.face.landmark_error;
}

}  // namespace

TEST_CASE("without displacements the result is the frontal mean face in the box") {
  Rig rig;
  const FaceBox box{{150, 110}, 90};
  REQUIRE(rig.align(backdrop().view(), box) == Status::ok);
  CHECK(length(rig.box().center - box.center) < 1.5f);
  CHECK(rig.box().side == doctest::Approx(90).epsilon(0.03));
  CHECK(length(log_rotation(rig.face.pose.q)) < 0.05f);
  CHECK(rig.face.score == 0.75f);
  CHECK(rig.face.landmark_error == doctest::Approx(0.05));
}

TEST_CASE("with a roll the face is turned about the middle of the box, and moves to its own right") {
  const FaceBox box{{150, 110}, 90};
  for (const float roll : {-2.5f, -0.8f, 0.8f, 1.57f, 3.1f}) {
    CAPTURE(roll);
    Rig still, moving(aligner_pattern::table(6, 0));
    REQUIRE(still.align(backdrop().view(), box, {nullptr, roll}) == Status::ok);
    CHECK(length(still.box().center - box.center) < 1.5f);
    CHECK(still.box().side == doctest::Approx(90).epsilon(0.03));
    CHECK(length(log_rotation(still.face.pose.q) - Vec3{0, 0, roll}) < 0.05f);
    REQUIRE(moving.align(backdrop().view(), box, {nullptr, roll}) == Status::ok);
    const Vec2 moved = moving.box().center - still.box().center, right{std::cos(roll), std::sin(roll)};
    CHECK(dot(moved, right) == doctest::Approx(7.2).epsilon(0.1));
    CHECK(length(moved - dot(moved, right) * right) < 0.6f);
  }
  Rig plain, nowhere;
  REQUIRE(plain.align(backdrop().view(), box) == Status::ok);
  REQUIRE(nowhere.align(backdrop().view(), box, {nullptr, std::nanf("")}) == Status::ok);
  CHECK(are_equal(plain, nowhere));
}

TEST_CASE("displacements of all landmarks to the right move the face to the right") {
  Rig still, moving(aligner_pattern::table(6, 0));
  const FaceBox box{{150, 110}, 90};
  REQUIRE(still.align(backdrop().view(), box) == Status::ok);
  REQUIRE(moving.align(backdrop().view(), box) == Status::ok);
  // 6 mm in each of two stages, of 0.6 px a mm.
  const Vec2 moved = moving.box().center - still.box().center;
  CHECK(moved.x == doctest::Approx(7.2).epsilon(0.1));
  CHECK(magnitude(moved.y) < 0.6f);
}

TEST_CASE("the text form only lowers the score, and leaves the estimated error and the parts as they are") {
  const auto scored_by_appearance = [] {
    Bytes bytes = aligner_pattern::table();
    AlignerCheck& check = aligner_pattern::check(bytes);
    check.score.weight[1] = check.error.weight[1] = 1;
    for (int k = 0; k < kCheckKnots; ++k) check.score.at[k] = check.error.at[k] = static_cast<float>(k) / 15;
    check.usual[4] = 1;
    aligner_pattern::seal(bytes);
    return bytes;
  };
  Bytes with_text = scored_by_appearance();
  aligner_pattern::add_text(with_text, -0.01f);
  Rig plain(scored_by_appearance()), textual(with_text);
  const FaceBox box{{150, 110}, 90};
  REQUIRE(plain.align(backdrop().view(), box) == Status::ok);
  REQUIRE(textual.align(backdrop().view(), box) == Status::ok);
  CHECK(plain.face.score == 0.5f);
  CHECK(textual.face.score < 0.4f);
  CHECK(textual.face.landmark_error == plain.face.landmark_error);
  CHECK(textual.face.least_part == plain.face.least_part);
  Bytes against_text = scored_by_appearance();
  aligner_pattern::add_text(against_text, 0.01f);
  Rig sure(against_text);
  REQUIRE(sure.align(backdrop().view(), box) == Status::ok);
  CHECK(sure.face.score == plain.face.score);
}

TEST_CASE("equal calls give equal bits, whatever came between") {
  Rig a(aligner_pattern::table(3, 2)), b(aligner_pattern::table(3, 2));
  REQUIRE(b.align(backdrop().view(), {{40, 30}, 200}) == Status::ok);
  REQUIRE(a.align(backdrop().view(), {{150, 110}, 90}) == Status::ok);
  REQUIRE(b.align(backdrop().view(), {{150, 110}, 90}) == Status::ok);
  CHECK(are_equal(a, b));
}

TEST_CASE("a frame with two bytes a pixel is read like one without gaps") {
  Rig a(aligner_pattern::table(3, 2)), b(aligner_pattern::table(3, 2));
  Picture packed(640, 240);
  for (int y = 0; y < 240; ++y)
    for (int x = 0; x < 320; ++x) packed.at(2 * x, y) = backdrop().at(x, y);
  FrameView frame = packed.view();
  frame.width = 320;
  frame.pixel_step_bytes = 2;
  REQUIRE(a.align(backdrop().view(), {{150, 110}, 90}) == Status::ok);
  REQUIRE(b.align(frame, {{150, 110}, 90}) == Status::ok);
  CHECK(are_equal(a, b));
}

TEST_CASE("parameters that are held keep their value, and the others follow") {
  Rig rig(aligner_pattern::table(4, 3));
  const Span<const Parameter> parameters = baked_face().model.parameters();
  std::vector<std::uint8_t> is_free(parameters.count);
  for (std::size_t k = 0; k < parameters.count; ++k) {
    is_free[k] = parameters[k].group == Group::expression;
    rig.q[k] = is_free[k] != 0 ? kNan : 0.7f;
  }
  REQUIRE(rig.align(backdrop().view(), {{150, 110}, 90}, {is_free.data()}) == Status::ok);
  for (std::size_t k = 0; k < parameters.count; ++k) {
    if (is_free[k] == 0) CHECK(rig.q[k] == 0.7f);
    CHECK(rig.q[k] >= parameters[k].minimum);
    CHECK(rig.q[k] <= parameters[k].maximum);
  }
  rig.q[0] = kNan;
  CHECK(rig.align(backdrop().view(), {{150, 110}, 90}, {is_free.data()}) == Status::bad_argument);
}

TEST_CASE("parameters that are held outside their range count as its nearer limit, and are told so") {
  const Span<const Parameter> parameters = baked_face().model.parameters();
  const std::vector<std::uint8_t> none_is_free(parameters.count, 0);
  const AlignOptions held{none_is_free.data()};
  Rig outside(aligner_pattern::table(4, 3)), limit(aligner_pattern::table(4, 3));
  for (std::size_t k = 0; k < parameters.count; ++k) {
    const bool is_above = k % 2 == 0;
    limit.q[k] = is_above ? parameters[k].maximum : parameters[k].minimum;
    outside.q[k] = limit.q[k] + (is_above ? 100.0f : -1e30f);
  }
  REQUIRE(outside.align(backdrop().view(), {{150, 110}, 90}, held) == Status::ok);
  REQUIRE(limit.align(backdrop().view(), {{150, 110}, 90}, held) == Status::ok);
  CHECK(are_equal(outside, limit));
  for (std::size_t k = 0; k < parameters.count; ++k)
    CHECK(outside.q[k] == (k % 2 == 0 ? parameters[k].maximum : parameters[k].minimum));
}

TEST_CASE("verification moves nothing, and refinement of a table without displacements stays") {
  Rig rig;
  REQUIRE(rig.align(backdrop().view(), {{150, 110}, 90}) == Status::ok);
  const AlignedFace before = rig.face;
  AlignedFace face;
  REQUIRE(rig.aligner.verify(backdrop().view(), before.camera, before.pose, rig.q.data(), &face) ==
          Status::ok);
  CHECK(std::memcmp(&face.pose, &before.pose, sizeof(Pose)) == 0);
  CHECK(face.score == before.score);
  REQUIRE(rig.aligner.refine(backdrop().view(), before.camera, before.pose, &face, rig.q.data()) ==
          Status::ok);
  // The blocks' middles are whole pixels of the crop, so that the pose moves by a part of them.
  CHECK(length(log_rotation(face.pose.q * conjugate(before.pose.q))) < 0.05f);
  CHECK(face.pose.t.z == doctest::Approx(static_cast<double>(before.pose.t.z)).epsilon(0.2));
}

TEST_CASE("bad input gets a status and changes nothing") {
  Rig rig;
  REQUIRE(rig.align(backdrop().view(), {{150, 110}, 90}) == Status::ok);
  const Rig& result = rig;
  const std::vector<float> q = rig.q;
  const AlignedFace face = rig.face;
  const std::vector<Vec2> landmarks = rig.landmarks;
  const FrameView frame = backdrop().view();
  const Camera camera = Rig::camera_of_frame(frame);
  const float huge = 1e30f;
  for (const FaceBox& box : {FaceBox{{kNan, 110}, 90}, FaceBox{{150, huge}, 90}, FaceBox{{150, 110}, 0},
                             FaceBox{{150, 110}, -5}, FaceBox{{150, 110}, kNan}, FaceBox{{150, 110}, huge}})
    CHECK(rig.align(frame, box) != Status::ok);
  CHECK(rig.align(frame, {{-500, 110}, 90}) == Status::not_found);
  CHECK(rig.align(frame, {{150, 500}, 90}) == Status::not_found);
  CHECK(rig.align({}, {{150, 110}, 90}) == Status::bad_argument);
  FaceAligner& aligner = rig.aligner;
  const Span<Vec2> few{rig.landmarks.data(), 3};
  CHECK(aligner.align(frame, {{150, 110}, 90}, camera, &rig.face, nullptr) == Status::bad_argument);
  CHECK(aligner.align(frame, {{150, 110}, 90}, camera, nullptr, rig.q.data()) == Status::bad_argument);
  CHECK(aligner.align(frame, {{150, 110}, 90}, camera, &rig.face, rig.q.data(), few) == Status::bad_argument);
  for (const float f : {0.0f, -1.0f, kNan, std::numeric_limits<float>::infinity()}) {
    Camera bad = camera;
    bad.f = f;
    CHECK(aligner.align(frame, {{150, 110}, 90}, bad, &rig.face, rig.q.data()) == Status::bad_argument);
    CHECK(aligner.verify(frame, bad, face.pose, rig.q.data(), &rig.face) == Status::bad_argument);
  }
  for (const float z : {0.0f, -100.0f, 1e9f, kNan}) {
    Pose bad = face.pose;
    bad.t.z = z;
    CHECK(aligner.refine(frame, camera, bad, &rig.face, rig.q.data()) == Status::bad_argument);
  }
  Pose far = face.pose;
  far.t.x = 1e5f;
  CHECK(aligner.verify(frame, camera, far, rig.q.data(), &rig.face) == Status::not_found);
  CHECK(result.q == q);
  CHECK(std::memcmp(&result.face.pose, &face.pose, sizeof(Pose)) == 0);
  CHECK(std::memcmp(result.landmarks.data(), landmarks.data(), landmarks.size() * sizeof(Vec2)) == 0);
}

TEST_CASE("an alignment in steps has the bits of one in one call where all are taken in one frame") {
  Rig whole(aligner_pattern::table(3, 2)), steps(aligner_pattern::table(3, 2));
  const FrameView frame = backdrop().view();
  const Camera camera = Rig::camera_of_frame(frame);
  const FaceBox box{{150, 110}, 90};
  int count = 0;
  FaceAligner& aligner = steps.aligner;
  const Span<Vec2> landmarks{steps.landmarks.data(), steps.landmarks.size()};
  const auto advance = [&](const FrameView& of, int n) {
    return aligner.advance(of, n, &steps.face, steps.q.data(), landmarks);
  };
  CHECK(advance(frame, 1) == Status::not_started);
  CHECK(aligner.begin(frame, box, camera, steps.q.data(), nullptr) == Status::bad_argument);
  CHECK(advance(frame, 1) == Status::not_started);
  REQUIRE(whole.align(frame, box) == Status::ok);
  REQUIRE(aligner.begin(frame, box, camera, steps.q.data(), &count) == Status::ok);
  REQUIRE(count == 3);  // two stages, and what concludes
  const std::vector<float> untouched = steps.q;
  for (const Picture& other : {Picture(64, 64, 9), Picture(320, 64, 9), Picture(64, 240, 9)})
    CHECK(advance(other.view(), 1) == Status::size_mismatch);
  CHECK(aligner.advance(frame, 1, nullptr, steps.q.data()) == Status::bad_argument);
  CHECK(advance({}, 1) == Status::bad_argument);
  CHECK(advance(frame, 0) == Status::ok);
  CHECK(advance(frame, -1) == Status::ok);
  CHECK(steps.q == untouched);
  REQUIRE(advance(frame, count) == Status::ok);
  CHECK(are_equal(whole, steps));
  CHECK(advance(frame, 1) == Status::not_started);
  // In frames of their own, the face 3 px further right in each.
  REQUIRE(aligner.begin(frame, box, camera, steps.q.data(), &count) == Status::ok);
  for (int k = 0; k < count; ++k) {
    CHECK(steps.face.score == whole.face.score);  // of before
    Picture moved(320, 240);
    for (int y = 0; y < 240; ++y)
      for (int x = 0; x < 320; ++x) moved.at(x, y) = backdrop().at(x < 3 * k ? 0 : x - 3 * k, y);
    REQUIRE(advance(moved.view(), 1) == Status::ok);
  }
  // This table does not look at the picture: only what the face has moved from frame to frame counts.
  CHECK(length(steps.box().center - (whole.box().center + Vec2{3.0f * static_cast<float>(count - 1), 0})) <
        1);
  CHECK(steps.q != untouched);
  REQUIRE(aligner.begin(frame, box, camera, steps.q.data(), &count) == Status::ok);
  CHECK(aligner.verify(frame, camera, steps.face.pose, steps.q.data(), &steps.face) == Status::ok);
  CHECK(advance(frame, 1) == Status::not_started);  // any other call ends it
}

TEST_CASE("cameras beyond all measure give a status, or a finite result") {
  Rig rig(aligner_pattern::table(40, -40));
  const FrameView frame = backdrop().view();
  for (const float f : {1e-38f, 1e-20f, 1e-3f, 1e3f, 1e9f, 1e20f, 1e38f})
    for (const float cx : {0.0f, 160.0f, -1e5f, 1e5f, 1e9f, -3e38f}) {
      CAPTURE(f);
      CAPTURE(cx);
      for (const float k1 : {0.0f, 0.2f}) {
        const Camera camera{f, cx, 120, k1};
        const Status status = rig.aligner.align(frame, {{150, 110}, 90}, camera, &rig.face, rig.q.data(),
                                                {rig.landmarks.data(), rig.landmarks.size()});
        if (magnitude(cx) > 1e5f) CHECK(status == Status::bad_argument);
        if (f == 1e3f && cx == 160) CHECK(status == Status::ok);
        CHECK(is_finite(rig.face.pose));
        for (const float x : rig.q) CHECK(is_finite(x));
        for (const Vec2 x : rig.landmarks) CHECK(is_finite(x));
      }
    }
}

TEST_CASE("frames from one pixel to 8192 x 8192 are read without going beyond them") {
  Rig rig(aligner_pattern::table(5, -4));
  const Picture dot(1, 1, 77);
  CHECK(rig.align(dot.view(), {{0, 0}, 1}) == Status::ok);
  CHECK(rig.align(dot.view(), {{0, 0}, 1000}) == Status::ok);
  const Picture large(8192, 8192, 20);
  for (const float side : {48.0f, 3000.0f, 20000.0f})
    CHECK(rig.align(large.view(), {{8000, 100}, side}) == Status::ok);
  for (const float x : rig.q) CHECK(is_finite(x));
  for (const Vec2 x : rig.landmarks) CHECK(is_finite(x));
}

TEST_CASE("a face whose light is brighter or darker is aligned alike") {
  // The table reads one byte of a block, so that its result depends on the picture.
  Bytes bytes = aligner_pattern::table();
  const std::size_t local = aligner_pattern::stage(bytes, 1).first_byte;
  for (std::size_t k = 0; k < 2 * aligner_pattern::kLandmarks; ++k) {
    aligner_pattern::weight(bytes, 1, k) = 0.02f;
    const std::size_t rows = local + 4 * 8 * aligner_pattern::kLandmarks;
    for (std::size_t i = 0; i < 32; ++i)
      bytes.data()[rows + 32 * k + i] = i % 3 == 0 ? 1 : i % 3 == 1 ? 255 : 0;
  }
  aligner_pattern::seal(bytes);
  Rig bright(bytes), dark(bytes);
  Picture dimmed = backdrop(), plain = backdrop();
  for (std::size_t k = 0; k < plain.pixels.size(); ++k) {
    plain.pixels[k] = static_cast<std::uint8_t>(plain.pixels[k] / 2 * 2);
    dimmed.pixels[k] = static_cast<std::uint8_t>(plain.pixels[k] / 2 + 20);
  }
  REQUIRE(bright.align(plain.view(), {{150, 110}, 90}) == Status::ok);
  REQUIRE(dark.align(dimmed.view(), {{150, 110}, 90}) == Status::ok);
  CHECK(length(bright.box().center - dark.box().center) < 2);
}

TEST_CASE("without a table, and for a model without the landmarks, every call says so") {
  FaceAligner none;
  AlignedFace face;
  std::vector<float> q(baked_face().model.parameters().count);
  CHECK(none.status() == Status::not_found);
  CHECK(none.align(backdrop().view(), {{150, 110}, 90}, {}, &face, q.data()) == Status::not_found);
  Bytes broken = aligner_pattern::table();
  broken.data()[300] ^= 1;
  Rig rig(broken);
  CHECK(rig.aligner.status() == Status::bad_checksum);
  CHECK(rig.align(backdrop().view(), {{150, 110}, 90}) == Status::bad_checksum);

  std::vector<std::uint32_t> words = baked_face().words;  // the same face with other names
  const Model& model = baked_face().model;
  auto* const bytes = reinterpret_cast<unsigned char*>(words.data());
  const auto* const first = reinterpret_cast<const unsigned char*>(baked_face().words.data());
  for (const Landmark& l : model.landmarks())
    bytes[reinterpret_cast<const unsigned char*>(l.name) - first] = 'x';
  const std::uint32_t crc = crc32(bytes + 16, model.table_bytes() - 16);
  std::memcpy(bytes + 12, &crc, sizeof crc);
  Model renamed;
  REQUIRE(Model::open(words.data(), model.table_bytes(), &renamed) == Status::ok);
  Rig other(aligner_pattern::table(), renamed);
  CHECK(other.aligner.status() == Status::not_found);
}

TEST_CASE("the memory is what is measured, below 150 KiB, and less of it fails cleanly") {
  const Bytes table = aligner_pattern::table();
  Bytes copy = table;
  const std::size_t bytes = measured_bytes<FaceAligner>(baked_face().model, copy.span());
  CHECK(bytes <= 150 * 1024);
  AlignedBlock block(bytes);
  for (const std::size_t less : {std::size_t{16}, bytes / 2, bytes - 16}) {
    Arena arena(block.data(), bytes - less);
    FaceAligner aligner;
    CHECK(create_in(arena, aligner, baked_face().model, copy.span()) == Status::out_of_memory);
    CHECK(arena.used_bytes() == 0);
    CHECK(aligner.status() == Status::not_found);
  }
}

namespace {

/// A table whose local stage and score, of random weights, depend on what is seen. \param bias  of the appearance.
Bytes seeing_table(float bias = 0) {
  Bytes bytes = aligner_pattern::table();
  Random random(9);
  const AlignerStage& local = aligner_pattern::stage(bytes, 1);
  const std::size_t rows = 2 * aligner_pattern::kLandmarks, floats = 8 * aligner_pattern::kLandmarks;
  for (std::size_t k = 0; k < rows; ++k) aligner_pattern::weight(bytes, 1, k) = 1e-4f;
  for (std::size_t k = 0; k < rows * block_bytes(local); ++k)
    bytes.data()[local.first_byte + 4 * floats + k] = static_cast<std::uint8_t>(random.below(256));
  AlignerCheck& check = aligner_pattern::check(bytes);
  for (int k = 0; k < kCheckKnots; ++k) check.score.at[k] = static_cast<float>(k) / (kCheckKnots - 1);
  check.score.weight[1] = 0.02f;
  for (std::size_t k = 0; k < aligner_pattern::kLandmarks; ++k) {
    bytes.at<float>(check.first_byte + 4 * k) = 4e-5f;
    bytes.at<float>(check.first_byte + 4 * (aligner_pattern::kLandmarks + k)) = bias;
  }
  for (std::size_t k = 0; k < aligner_pattern::kLandmarks * block_bytes(local); ++k)
    bytes.data()[check.first_byte + 8 * aligner_pattern::kLandmarks + k] =
        static_cast<std::uint8_t>(random.below(256));
  aligner_pattern::seal(bytes);
  return bytes;
}

}  // namespace

TEST_CASE(
    "the least part is that with the least appearance in its own deviations, none that looks as usual") {
  // \param nose, mouth  appearance of each of their landmarks.
  const auto least_part = [](float nose, float mouth, float scale_of_mouth, float mean_of_mouth = 0) {
    Bytes bytes = aligner_pattern::table();
    AlignerCheck& check = aligner_pattern::check(bytes);
    for (int p = 0; p < kFaceParts; ++p) check.usual[kFaceParts + p] = p == 3 ? scale_of_mouth : 1;
    check.usual[3] = mean_of_mouth;
    for (std::size_t k = 10; k < aligner_pattern::kLandmarks; ++k) {
      float& bias = bytes.at<float>(check.first_byte + 4 * (aligner_pattern::kLandmarks + k));
      bias = k < 19 ? nose : k < 31 ? 0.0f : mouth;
    }
    aligner_pattern::seal(bytes);
    Rig rig(bytes);
    const Camera camera = Rig::camera_of_frame(backdrop().view());
    rig.q.assign(rig.q.size(), 0);
    REQUIRE(rig.aligner.refine(backdrop().view(), camera, {{}, {0, 0, 700}}, &rig.face, rig.q.data(),
                               {rig.landmarks.data(), rig.landmarks.size()}) == Status::ok);
    return rig.face.least_part;
  };
  CHECK(least_part(0, 0, 1) == 0);
  CHECK(least_part(0.1f, 0.1f, 1) == 0);
  CHECK(least_part(0.1f, -0.1f, 1) == doctest::Approx(-2).epsilon(0.02));
  CHECK(least_part(-0.05f, -0.1f, 1) == doctest::Approx(-2).epsilon(0.02));
  CHECK(least_part(-0.05f, -0.1f, 0.1f) == doctest::Approx(-0.45).epsilon(0.02));
  CHECK(least_part(0, 0.1f, 1, 0.2f) == doctest::Approx(-2).epsilon(0.02));
}

TEST_CASE("the mirror image of a picture gives the mirror image of the result, turned faces too") {
  Picture mirrored(320, 240);
  for (int y = 0; y < 240; ++y)
    for (int x = 0; x < 320; ++x) mirrored.at(x, y) = backdrop().at(319 - x, y);
  const Camera camera = Rig::camera_of_frame(backdrop().view());
  Rig plain, seeing(seeing_table()), there(seeing_table()), likely(seeing_table(0.2f)),
      unlikely(seeing_table(-0.2f));
  const auto refine = [&](Rig& rig, const Picture& picture, float turn, float x) {
    const Pose pose{exp_rotation({0, turn, 0}), {x, 0, 700}};
    rig.q.assign(rig.q.size(), 0);
    REQUIRE(rig.aligner.refine(picture.view(), camera, pose, &rig.face, rig.q.data(),
                               {rig.landmarks.data(), rig.landmarks.size()}) == Status::ok);
  };
  for (const float turn : {0.0f, 0.1f, -0.05f, -0.15f}) {
    CAPTURE(turn);
    refine(plain, backdrop(), turn, 9);
    refine(seeing, backdrop(), turn, 9);
    refine(there, mirrored, -turn, -9);
    refine(likely, backdrop(), turn, 9);
    refine(unlikely, backdrop(), turn, 9);
    float most = 0, moved = 0;
    for (int k = 17; k < 68; ++k) {
      const std::string here = "ibug" + std::to_string(k),
                        other = "ibug" + std::to_string(mirrored_landmark_number(k));
      const Vec2 a = seeing.landmark(here.c_str()), b = there.landmark(other.c_str());
      most = max(most, length(Vec2{319 - b.x, b.y} - a));
      moved = max(moved, length(a - plain.landmark(here.c_str())));
    }
    CHECK(moved > 1);
    CHECK(most < 0.1f * moved);
    CHECK(magnitude(there.face.score - seeing.face.score) < 0.02f);
    CHECK(unlikely.face.score < seeing.face.score - 0.05f);
    CHECK(likely.face.score > seeing.face.score + 0.05f);
  }
}

}  // namespace face_aligner_test
