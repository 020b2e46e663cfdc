// Learns a small detector from drawn portraits: the properties that any learnt table must have.
#include "host/learn/learn_detector.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "baked_face.hpp"
#include "face/detector_table.hpp"
#include "host/io/aligned_table.hpp"
#include "host/io/failure.hpp"
#include "host/io/owned.hpp"
#include "host/learn/drawn_portraits.hpp"
#include "pliant/face_detector.hpp"
#include "sanitized.hpp"
#include "texture.hpp"

namespace learn_detector_test {

using namespace pliant;
using namespace pliant::host;
using namespace pliant::host::learn;

namespace {

OtherPictures textures(std::uint64_t seed) {
  std::vector<Image> pictures;
  for (std::uint64_t k = 0; k < 12; ++k) {
    Image picture(200, 150, 1);
    picture.pixels = texture::render(texture::Texture(seed + k), {}, picture.width, picture.height).pixels;
    pictures.push_back(picture);
  }
  return OtherPictures(pictures);
}

/// Upright faces in even light, of which a small training learns enough.
FaceSampleTuning easy() {
  FaceSampleTuning t;
  t.turned_fraction = 0;
  t.roll_degrees = 10;
  t.variation = {};
  t.variation.gain_low = 0.8f;
  t.variation.low_contrast_chance = 0;
  return t;
}

struct Samples {
  OtherPictures others = textures(1);
  std::vector<Photograph> portraits;
  FaceSamples samples;
  explicit Samples(std::uint64_t seed)
      : portraits(draw_portraits(baked_face().model, FaceSheet(baked_face().model, 2), others,
                                 kSanitized ? 4 : 14, seed, 0)),
        samples(baked_face().model, portraits, others, seed, easy()) {}
};

std::vector<std::uint8_t> learnt(int threads, double effort) {
  static const Samples s(5);
  LearnOptions options;
  options.threads = threads;
  options.effort = effort;
  return learn_detector(s.samples, s.others, options, {});
}

}  // namespace

TEST_CASE("a small training finds faces of other people, and little where there are none") {
  if (kSanitized) return;
  const std::vector<std::uint8_t> bytes = learnt(2, 0.01);
  const AlignedTable table(bytes);
  Owned<FaceDetector> detector(table.span(), FaceDetectorLimits{});
  REQUIRE(detector->status() == Status::ok);
  CHECK(bytes.size() <= 65536);
  DetectedFace face;
  std::size_t count = 0;
  int found = 0, false_hits = 0;
  const Samples others(77);
  for (std::uint64_t k = 0; k < 40; ++k) {
    const FaceSample sample = others.samples.draw(k);
    REQUIRE(detector->find(frame_of(sample.picture), {&face, 1}, &count) == Status::ok);
    const float distance = length(face.box.center - sample.box.center);
    found += count == 1 && distance < 0.2f * sample.box.side ? 1 : 0;
  }
  const OtherPictures empty = textures(900);
  for (std::size_t k = 0; k < empty.count(); ++k) {
    REQUIRE(detector->find(frame_of(empty.picture(k)), {&face, 1}, &count) == Status::ok);
    false_hits += count > 0 ? 1 : 0;
  }
  MESSAGE("found " << found << " of 40, false " << false_hits << " of " << empty.count());
  CHECK(found >= 32);
  CHECK(false_hits <= 4);
}

TEST_CASE("photographs of one person are refused: they only set the thresholds, and nothing trains") {
  const OtherPictures others = textures(1);
  std::vector<Photograph> portraits =
      draw_portraits(baked_face().model, FaceSheet(baked_face().model, 2), others, 2, 5, 0);
  const auto is_another = [&](const Photograph& p) { return p.person != portraits[0].person; };
  portraits.erase(std::remove_if(portraits.begin(), portraits.end(), is_another), portraits.end());
  portraits[0].person = 0;
  LearnOptions options;
  options.effort = 0.001;
  FaceSampleTuning tuning = easy();
  tuning.drawn_fraction = 0;
  const FaceSamples samples(baked_face().model, portraits, others, 5, tuning);
  CHECK_THROWS_AS(learn_detector(samples, others, options, {}), Failure);
}

TEST_CASE("the table is the same bytes whatever the number of threads") {
  const double effort = 0.001;
  CHECK(learnt(1, effort) == learnt(2, effort));
}

}  // namespace learn_detector_test
