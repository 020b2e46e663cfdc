// Learns a small aligner from drawn portraits and aligns faces with it: the properties that any learnt table must have.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "baked_face.hpp"
#include "host/io/aligned_table.hpp"
#include "host/learn/aligner_cascade.hpp"
#include "host/learn/aligner_check.hpp"
#include "host/learn/drawn_portraits.hpp"
#include "pliant/face_aligner.hpp"
#include "sanitized.hpp"

namespace learn_aligner_test {

using namespace pliant;
using namespace pliant::host;
using namespace pliant::host::learn;

namespace {

const OtherPictures no_others;

/// People to learn from, and one who is left out.
const std::vector<Photograph>& portraits() {
  static const std::vector<Photograph> list = draw_portraits(
      baked_face().model, FaceSheet(baked_face().model, 2), no_others, kSanitized ? 3 : 12, 5, 0);
  return list;
}
const std::vector<Photograph>& left_out() {
  static const std::vector<Photograph> list = draw_portraits(
      baked_face().model, FaceSheet(baked_face().model, 2), no_others, kSanitized ? 1 : 6, 77, 100);
  return list;
}

/// Pictures that are varied less than for a real training, of which a small one learns enough.
FaceSampleTuning easy() {
  FaceSampleTuning t;
  t.turned_fraction = 0;
  t.roll_degrees = 15;
  t.box_low_px = 80;
  return t;
}

std::vector<std::uint8_t> learn_table(int threads) {
  const FaceSamples samples(baked_face().model, portraits(), no_others, 3, easy());
  LearnOptions options;
  options.threads = threads;
  AlignerCascadeTuning tuning;
  tuning.folds = 2;
  tuning.ridges = {1};
  std::vector<int> numbers;
  for (int k = 17; k < 68; ++k) numbers.push_back(k);
  AlignerCascade cascade(baked_face().model, numbers, options, tuning);
  AlignerExamples source(baked_face().model, samples, numbers, tuning.folds, 3);
  for (std::uint64_t k = 0; k < (kSanitized ? 10 : 150); ++k)
    for (AlignerExample& e : source.draw(k, 2)) cascade.examples().push_back(std::move(e));
  for (const AlignerStage& stage :
       {AlignerStage{2.4f, 96, 3, 8, 3, 12, 0, 3, 2, 0}, AlignerStage{2, 84, 4, 4, 0, 0, 1, 1, 2, 0},
        AlignerStage{1.6f, 104, 4, 4, 0, 0, 1, 1, 1, 0}})
    cascade.learn(stage);
  cascade.learn_blend();
  AlignerCheckTuning check;
  check.rounds = 4;
  const LearntCheck learnt = learn_check(cascade, no_others, no_others, {}, {}, check);
  return cascade.table(cascade.folds(), &learnt);
}

/// The learnt table, and an aligner that uses it.
struct Learnt {
  std::vector<std::uint8_t> bytes = learn_table(2);
  AlignedTable table{bytes};
};
const Learnt& learnt() {
  static const Learnt table;
  return table;
}

struct Rig {
  Owned<FaceAligner> aligner{baked_face().model, learnt().table.span()};
  AlignedFace face;
  std::vector<float> q = baked_face().rest();
  std::vector<Vec2> landmarks = std::vector<Vec2>(baked_face().model.landmarks().count);

  Status align(const Image& picture, const FaceBox& box, const Camera& camera) {
    return aligner->align(frame_of(picture), box, camera, &face, q.data(),
                          {landmarks.data(), landmarks.size()});
  }
  /// Mean error of ibug17 to ibug67 over the distance of the outer eye corners.
  float error(const std::vector<Vec2>& truth) const {
    const auto inner = indices();
    float sum = 0;
    for (const std::uint16_t k : inner) sum += length(landmarks[k] - truth[k]);
    return sum / static_cast<float>(inner.size()) / length(truth[inner[19]] - truth[inner[28]]);
  }
  static std::vector<std::uint16_t> indices() {
    std::vector<int> numbers;
    for (int k = 17; k < 68; ++k) numbers.push_back(k);
    return landmark_indices(baked_face().model, numbers);
  }
};

FaceBox box_of(const Photograph& p) {
  return face_box_in(baked_face().model, p.landmarks, p.pose, p.camera);
}

/// A picture moved by whole pixels, smaller by `factor`, with another gain.
Image changed(const Image& from, int dx, int dy, float gain) {
  Image out(from.width, from.height, 1);
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) {
      const int sx = std::clamp(x - dx, 0, from.width - 1), sy = std::clamp(y - dy, 0, from.height - 1);
      *out.at(x, y) = static_cast<std::uint8_t>(std::lround(gain * static_cast<float>(*from.at(sx, sy))));
    }
  return out;
}

}  // namespace

TEST_CASE("the same seed learns the same bytes, whatever the threads") {
  CHECK(learn_table(1) == learnt().bytes);
}

TEST_CASE("faces of people that were not learnt are aligned from boxes that err") {
  if (kSanitized) return;  // so few examples teach nothing
  Rig rig;
  std::vector<float> errors;
  for (std::size_t k = 0; k < left_out().size(); ++k)
    for (const float shift : {-0.06f, 0.0f, 0.06f}) {
      const Photograph& p = left_out()[k];
      FaceBox box = box_of(p);
      box.center = box.center + (shift * box.side) * Vec2{1, -1};
      box.side *= 1 + shift;
      REQUIRE(rig.align(p.picture, box, p.camera) == Status::ok);
      errors.push_back(rig.error(p.landmarks));
    }
  std::sort(errors.begin(), errors.end());
  MESSAGE("mean errors: median " << errors[errors.size() / 2] << ", largest " << errors.back());
  CHECK(errors[errors.size() / 2] < 0.05f);
}

TEST_CASE("a face that is moved or darker is aligned at the place it has moved to") {
  Rig here, there, dark;
  const Photograph& p = left_out()[0];
  FaceBox box = box_of(p);
  REQUIRE(here.align(p.picture, box, p.camera) == Status::ok);
  REQUIRE(dark.align(changed(p.picture, 0, 0, 0.6f), box, p.camera) == Status::ok);
  Camera camera = p.camera;
  camera.cx += 17;
  camera.cy -= 9;
  box.center = box.center + Vec2{17, -9};
  REQUIRE(there.align(changed(p.picture, 17, -9, 1), box, camera) == Status::ok);
  const auto truth = p.landmarks;
  for (const std::uint16_t k : Rig::indices()) {
    CHECK(length(there.landmarks[k] - here.landmarks[k] - Vec2{17, -9}) < 0.05f * box.side);
    CHECK(length(dark.landmarks[k] - here.landmarks[k]) < 0.05f * box.side);
  }
}

TEST_CASE("refinement from the truth stays at the truth, and is believed more than a pose beside it") {
  if (kSanitized) return;
  Rig rig;
  float right = 0, wrong = 0;
  for (const Photograph& p : left_out()) {
    rig.q = p.q;
    REQUIRE(rig.aligner->refine(frame_of(p.picture), p.camera, p.pose, &rig.face, rig.q.data(),
                                {rig.landmarks.data(), rig.landmarks.size()}) == Status::ok);
    CHECK(rig.error(p.landmarks) < 0.06f);
    right += rig.face.score;
    Pose beside = rig.face.pose;
    beside.t.x += 35;
    AlignedFace face;
    REQUIRE(rig.aligner->verify(frame_of(p.picture), p.camera, beside, rig.q.data(), &face) == Status::ok);
    wrong += face.score;
    CHECK(face.landmark_error > rig.face.landmark_error);
  }
  const auto count = static_cast<float>(left_out().size());
  CHECK(right / count > 0.7f);
  CHECK(wrong / count < 0.3f);
}

}  // namespace learn_aligner_test
