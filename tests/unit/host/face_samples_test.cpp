// Training samples: reproducible, and their truth is what their picture shows.
#include "host/learn/face_samples.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "baked_face.hpp"
#include "host/render/scene.hpp"

namespace face_samples_test {

using namespace pliant;
using namespace pliant::host;
using namespace pliant::host::learn;

namespace {

/// A render of the built-in face, turned a little, with its iBUG landmarks as annotation.
AnnotatedPicture annotated_render() {
  BakedModel& face = baked_face();
  const auto q = face.posed("jawOpen", 0.3f);
  const Camera camera = centred_camera(240, 240, 900);
  const Pose pose{exp_rotation({0.05f, 0.2f, 0.05f}), {5, -10, 1500}};
  AnnotatedPicture out{
      "render", Scene(face.model, 240, 240, 96).draw(q.data(), pose, camera, Image(240, 240, 1, 90)), {}};
  const Projector projector(view_of(pose, camera), true);
  for (const Landmark& landmark : face.model.landmarks()) {
    const std::string name = landmark.name;
    Vec2 x;
    if (name.compare(0, 4, "ibug") == 0 && name > "ibug16" &&
        projector.project(face.at(landmark.uv(), q), &x))
      out.landmarks.push_back({name, x});
  }
  return out;
}

const std::vector<Photograph>& photographs() {
  static const std::vector<Photograph> list = [] {
    std::vector<Photograph> made(2);
    const AnnotatedPicture render = annotated_render();
    REQUIRE(fit_photograph(baked_face().model, render, &made[0]));
    REQUIRE(fit_photograph(baked_face().model, mirror_image(render), &made[1]));
    return made;
  }();
  return list;
}

const OtherPictures no_others;

float distance(Vec2 a, Vec2 b) {
  return length(a - b);
}

}  // namespace

TEST_CASE("photographs are held out by the hash of their name alone") {
  CHECK(is_held_out("a") == (0xe40c292cu % 3 == 0));  // published values of FNV-1a
  CHECK(is_held_out("foobar") == (0xbf9cf968u % 3 == 0));
  int held_out = 0;
  for (int k = 0; k < 300; ++k) held_out += is_held_out("name-" + std::to_string(k)) ? 1 : 0;
  CHECK(held_out > 70);
  CHECK(held_out < 130);
}

TEST_CASE("mirrored landmark names are symmetric, and change where the face has two sides") {
  CHECK(mirrored_landmark("ibug36") == "ibug45");
  CHECK(mirrored_landmark("ibug00") == "ibug16");
  CHECK(mirrored_landmark("ibug17") == "ibug26");
  CHECK(mirrored_landmark("ibug31") == "ibug35");
  CHECK(mirrored_landmark("ibug30") == "ibug30");
  CHECK(mirrored_landmark("ibug60") == "ibug64");
  CHECK(mirrored_landmark("ibug58") == "ibug56");
  CHECK(mirrored_landmark("ibug66") == "ibug66");
  CHECK(mirrored_landmark("mouth_left") == "mouth_right");
  CHECK(mirrored_landmark("pupil_r") == "pupil_l");
  for (const Landmark& landmark : baked_face().model.landmarks()) {
    const std::string name = landmark.name;
    CAPTURE(name);
    CHECK(mirrored_landmark(mirrored_landmark(name)) == name);
    const std::uint16_t other = baked_face().model.find_landmark(mirrored_landmark(name).c_str());
    REQUIRE(other != kNone);
    CHECK(baked_face().model.landmarks()[other].u ==
          doctest::Approx(1 - static_cast<double>(landmark.u)).epsilon(0.01));
  }
}

TEST_CASE("fitted photograph has the annotated landmarks, and the others where the model has them") {
  const AnnotatedPicture render = annotated_render();
  const Photograph& photograph = photographs()[0];
  const Model& model = baked_face().model;
  for (const AnnotatedLandmark& a : render.landmarks) {
    const std::size_t k = model.find_landmark(a.name.c_str());
    CHECK(distance(photograph.landmarks[k], a.x) == 0);
    CHECK(photograph.trust[k] == kTrustAnnotated);
  }
  CHECK(photograph.trust[model.find_landmark("ibug08")] == kTrustFitted);
  // The mirror image is the same face.
  const std::size_t chin = model.find_landmark("ibug08");
  CHECK(distance(photographs()[1].landmarks[chin],
                 {239 - photograph.landmarks[chin].x, photograph.landmarks[chin].y}) < 2);
}

TEST_CASE("samples depend on seed and index alone") {
  const FaceSamples samples(baked_face().model, photographs(), no_others, 7),
      other_seed(baked_face().model, photographs(), no_others, 8);
  const FaceSample third = samples.draw(3);
  (void)samples.draw(4);
  const FaceSample again = samples.draw(3);
  CHECK(again.picture.pixels == third.picture.pixels);
  CHECK(again.q == third.q);
  CHECK(other_seed.draw(3).picture.pixels != third.picture.pixels);
  CHECK(samples.draw(4).picture.pixels != third.picture.pixels);
}

TEST_CASE("landmarks of a sample are where its pose, camera and parameters put them") {
  BakedModel& face = baked_face();
  const FaceSamples samples(face.model, photographs(), no_others, 7);
  for (std::uint64_t index = 0; index < 40; ++index) {
    CAPTURE(index);
    const FaceSample sample = samples.draw(index);
    const Projector projector(view_of(sample.pose, sample.camera), true);
    REQUIRE(sample.landmarks.size() == face.model.landmarks().count);
    for (std::size_t k = 0; k < sample.landmarks.size(); ++k) {
      const Landmark& landmark = face.model.landmarks()[k];
      Vec2 x;
      REQUIRE(projector.project(face.at(landmark.uv(), sample.q), &x));
      // Annotated points in the plane keep the residual of the fit.
      CHECK(distance(sample.landmarks[k], x) <
            (sample.trust[k] == kTrustFitted ? 0.02f : 0.03f * sample.box.side));
    }
    const FaceBox box = face_box_in(face.model, sample.landmarks, sample.pose, sample.camera);
    CHECK(box.side == doctest::Approx(static_cast<double>(sample.box.side)).epsilon(1e-3));
    CHECK(distance(box.center, sample.box.center) < 0.02f * box.side);
    const float room = min(min(box.center.x, box.center.y), 159 - max(box.center.x, box.center.y));
    CHECK(room > 0.5f * box.side);
  }
}

TEST_CASE("photograph turned in depth is drawn as the model projects, and shows what the photograph shows") {
  BakedModel& face = baked_face();
  FaceSampleTuning tuning;
  tuning.turned_fraction = 1;
  const FaceSamples samples(face.model, photographs(), no_others, 11, tuning);
  bool is_some_hidden = false, is_some_turned = false;
  for (std::uint64_t index = 0; index < 40; ++index) {
    CAPTURE(index);
    const FaceSample sample = samples.draw(index);
    const Projector projector(view_of(sample.pose, sample.camera), true);
    for (std::size_t k = 0; k < sample.landmarks.size(); ++k) {
      const Landmark& landmark = face.model.landmarks()[k];
      Vec2 x;
      REQUIRE(projector.project(face.at(landmark.uv(), sample.q), &x));
      CHECK(distance(sample.landmarks[k], x) < 0.05f);
      is_some_hidden |= sample.trust[k] == kTrustNone;
    }
    const Vec3 ahead = rotation_matrix(sample.pose.q) * Vec3{0, 0, -1};
    is_some_turned |= magnitude(ahead.x) > 0.5f;
    for (std::size_t k = 0; k < sample.q.size(); ++k) {
      CHECK(sample.q[k] >= face.model.parameters()[k].minimum);
      CHECK(sample.q[k] <= face.model.parameters()[k].maximum);
    }
  }
  CHECK(is_some_hidden);
  CHECK(is_some_turned);
}

TEST_CASE("without photographs samples are of drawn portraits, each of a person of its own") {
  BakedModel& face = baked_face();
  const std::vector<Photograph> none;
  FaceSampleTuning tuning;
  tuning.drawn_people_alone = 3;
  const FaceSamples samples(face.model, none, no_others, 5, tuning),
      again(face.model, none, no_others, 5, tuning);
  std::vector<int> people;
  for (std::uint64_t index = 0; index < 12; ++index) {
    const FaceSample sample = samples.draw(index);
    CHECK(sample.picture.pixels == again.draw(index).picture.pixels);
    CHECK(sample.person >= 0);
    CHECK(sample.person < 3);
    people.push_back(sample.person);
  }
  CHECK(*std::min_element(people.begin(), people.end()) < *std::max_element(people.begin(), people.end()));
}

TEST_CASE("crops of other pictures lie within the picture, at any size") {
  Image wide(300, 20, 1, 100), small(10, 10, 3, 100);
  const OtherPictures others({wide, small});
  SampleRandom random(1, 2);
  for (int k = 0; k < 20; ++k) {
    const Image crop = others.crop(64, 48, random);
    CHECK(crop.width == 64);
    CHECK(crop.height == 48);
    CHECK(std::all_of(crop.pixels.begin(), crop.pixels.end(),
                      [](std::uint8_t p) { return p >= 98 && p <= 101; }));
  }
}

}  // namespace face_samples_test
