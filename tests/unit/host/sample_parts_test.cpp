// Parts of the training samples: reading photographs, sampling and drawing pictures, brows, what changes a picture.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "baked_face.hpp"
#include "host/io/files.hpp"
#include "host/learn/brow_search.hpp"
#include "host/learn/expression_variation.hpp"
#include "host/learn/mipmap.hpp"
#include "host/learn/occluders.hpp"
#include "host/learn/painting.hpp"
#include "host/learn/photographs.hpp"
#include "host/learn/picture_variation.hpp"
#include "host/learn/sample_view.hpp"
#include "host/learn/texture_raster.hpp"
#include "host/render/scene.hpp"
#include "scratch_folder.hpp"

namespace sample_parts_test {

using namespace pliant;
using namespace pliant::host;
using namespace pliant::host::learn;

namespace {

const Camera kCamera = centred_camera(240, 240, 1000);
const Pose kPose{{}, {0, 0, 1200}};

/// A render of the built-in face with all iBUG landmarks.
AnnotatedPicture render(const std::vector<float>& q) {
  BakedModel& face = baked_face();
  AnnotatedPicture out{
      "render", Scene(face.model, 240, 240, 96).draw(q.data(), kPose, kCamera, Image(240, 240, 1, 90)), {}};
  const Projector projector(view_of(kPose, kCamera), true);
  for (const Landmark& landmark : face.model.landmarks()) {
    Vec2 x;
    if (std::string(landmark.name).compare(0, 4, "ibug") == 0 &&
        projector.project(face.at(landmark.uv(), q), &x))
      out.landmarks.push_back({landmark.name, x});
  }
  return out;
}

FaceSample sample_of(const AnnotatedPicture& picture) {
  const Model& model = baked_face().model;
  FaceSample sample;
  sample.picture = picture.picture;
  sample.camera = kCamera;
  sample.pose = kPose;
  sample.q = baked_face().rest();
  sample.landmarks.resize(model.landmarks().count);
  sample.trust.assign(model.landmarks().count, kTrustAnnotated);
  for (const AnnotatedLandmark& a : picture.landmarks)
    sample.landmarks[model.find_landmark(a.name.c_str())] = a.x;
  sample.box = face_box_in(model, sample.landmarks, kPose, kCamera);
  return sample;
}

std::vector<Vec3> landmarks_mm() {
  std::vector<Vec3> out;
  for (const Landmark& l : baked_face().model.landmarks())
    out.push_back(baked_face().at(l.uv(), baked_face().rest()));
  return out;
}

OccluderTuning nothing() {
  OccluderTuning tuning;
  tuning.glasses_chance = tuning.mask_chance = tuning.hand_chance = tuning.hair_chance = tuning.bar_chance =
      tuning.moustache_chance = 0;
  return tuning;
}

}  // namespace

TEST_CASE("photographs are read by portion, each followed by its mirror image") {
  const Folder folder("photographs");
  std::string rows = "name,landmark,x,y\n";
  std::vector<std::string> names;
  for (const char* name : {"ann", "bea", "cid", "dan", "eve", "fay"}) {
    const AnnotatedPicture picture = render(baked_face().rest());
    folder.put(std::string(name) + ".jpg", encode_jpeg(to_colour(picture.picture), 90));
    for (const AnnotatedLandmark& a : picture.landmarks)
      rows +=
          std::string(name) + "," + a.name + "," + std::to_string(a.x.x) + "," + std::to_string(a.x.y) + "\n";
    names.emplace_back(name);
  }
  folder.put("landmarks.csv", rows);
  std::vector<std::string> seen;
  for (const Portion portion : {Portion::training, Portion::held_out}) {
    const auto photographs = read_photographs(baked_face().model, folder.path.string(), portion);
    REQUIRE(photographs.size() % 2 == 0);
    for (std::size_t k = 0; k < photographs.size(); ++k) {
      CHECK(is_held_out(photographs[k].name) == (portion == Portion::held_out));
      CHECK(photographs[k].person == static_cast<int>(k / 2));
      if (k % 2 == 0) seen.push_back(photographs[k].name);
    }
  }
  std::sort(seen.begin(), seen.end());
  CHECK(seen == names);
  CHECK(unknown_landmarks(baked_face().model, folder.path.string()).empty());
  folder.put("landmarks.csv", rows + "fay,pupil_r,1,1\nfay,iBUG36,1,1\nfay,ibug36,1,1\nann,lip,1,1\nann,iBUG36,1,1\n");
  CHECK(unknown_landmarks(baked_face().model, folder.path.string()) == std::vector<std::string>{"iBUG36", "lip"});
}

TEST_CASE("brows that are not annotated are found in the picture") {
  BakedModel& face = baked_face();
  std::vector<float> q = face.rest();
  for (const char* name : {"browInnerUpLeft", "browInnerUpRight", "browOuterUpLeft", "browOuterUpRight"})
    q[face.model.find_parameter(name)] = 0.65f;
  const AnnotatedPicture all = render(q);
  AnnotatedPicture some = all;
  some.landmarks.erase(std::remove_if(some.landmarks.begin(), some.landmarks.end(),
                                      [](const AnnotatedLandmark& a) { return a.name <= "ibug26"; }),
                       some.landmarks.end());
  Photograph photograph;
  REQUIRE(fit_photograph(face.model, some, &photograph));
  float sum = 0, raised = 0;
  const AnnotatedPicture rest = render(face.rest());
  for (std::size_t k = 0; k < all.landmarks.size(); ++k) {
    const AnnotatedLandmark& a = all.landmarks[k];
    if (a.name < "ibug17" || a.name > "ibug26") continue;
    sum += length(photograph.landmarks[face.model.find_landmark(a.name.c_str())] - a.x);
    raised += length(rest.landmarks[k].x - a.x);
  }
  CHECK(raised / 10 > 2.5f);
  CHECK(sum < 0.5f * raised);
}

TEST_CASE("mipmap interpolates a gradient, and continues the border outside") {
  Image ramp(64, 32, 1);
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 64; ++x) *ramp.at(x, y) = static_cast<std::uint8_t>(3 * x + y);
  const Mipmap mipmap(ramp);
  for (const float step : {1.0f, 2.0f, 4.0f})
    CHECK(mipmap.at({20.25f, 12.5f}, mipmap.detail_for(step)) ==
          doctest::Approx(3 * 20.25 + 12.5).epsilon(0.02));
  CHECK(mipmap.at({-1, 10}, mipmap.detail_for(1)) == doctest::Approx(10).epsilon(0.05));
  CHECK(mipmap.at({900, 1000}, mipmap.detail_for(1)) > 100);
}

TEST_CASE("texture raster shows the nearer triangle, and interpolates with perspective") {
  const auto vertex = [](float x, float y, float depth, Vec2 texture) {
    TextureVertex v;
    v.x = {x, y};
    v.inverse_depth = 1 / depth;
    v.texture = texture;
    return v;
  };
  TextureRaster raster(20, 20, 2);
  raster.clear();
  // A floor from depth 100 at the left to 300 at the right, then a nearer wall over part of it.
  raster.draw({vertex(0, 0, 100, {0, 0}), vertex(19, 0, 300, {1, 0}), vertex(0, 19, 100, {0, 1})},
              {{{0, 1, 2}, FacePart::skin}});
  raster.draw({vertex(0, 0, 50, {7, 7}), vertex(4, 0, 50, {7, 7}), vertex(0, 4, 50, {7, 7})},
              {{{0, 1, 2}, FacePart::eye}});
  TextureFragment fragment{};
  REQUIRE(raster.fragment(2, 2, &fragment));
  CHECK(fragment.part == FacePart::eye);
  CHECK(fragment.texture.x == doctest::Approx(7));
  REQUIRE(raster.fragment(19, 4, &fragment));  // half way in the picture, a quarter of the way on the floor
  CHECK(fragment.part == FacePart::skin);
  CHECK(fragment.texture.x == doctest::Approx(0.25).epsilon(0.1));
  CHECK(raster.depth({9.5f, 2}) == doctest::Approx(150).epsilon(0.05));
  CHECK(raster.depth({19, 19}) == 0);
  CHECK(raster.depth({-5, 3}) == 0);
}

TEST_CASE("varied picture keeps its size, and the same stream of random numbers varies it alike") {
  const AnnotatedPicture picture = render(baked_face().rest());
  const FaceSample sample = sample_of(picture);
  for (std::uint64_t index = 0; index < 20; ++index) {
    Image a = picture.picture, b = picture.picture;
    SampleRandom first(3, index), second(3, index);
    vary_picture(a, sample.box, {}, first);
    vary_picture(b, sample.box, {}, second);
    CHECK(a.width == 240);
    CHECK(a.pixels == b.pixels);
  }
}

TEST_CASE("sunglasses hide the eyes and not the mouth, and a mask the reverse") {
  const Model& model = baked_face().model;
  const auto trust = [&](const FaceSample& sample, const char* name) {
    return sample.trust[model.find_landmark(name)];
  };
  int dark = 0;
  for (std::uint64_t index = 0; index < 12; ++index) {
    FaceSample sample = sample_of(render(baked_face().rest()));
    OccluderTuning tuning = nothing();
    tuning.glasses_chance = 1;
    SampleRandom random(5, index);
    add_occluders(sample, model, landmarks_mm(), {}, tuning, random);
    dark += trust(sample, "ibug37") == kTrustNone ? 1 : 0;
    CHECK(trust(sample, "ibug54") == kTrustAnnotated);
  }
  CHECK(dark > 0);
  CHECK(dark < 12);
  FaceSample sample = sample_of(render(baked_face().rest()));
  OccluderTuning tuning = nothing();
  tuning.mask_chance = 1;
  SampleRandom random(5, 1);
  add_occluders(sample, model, landmarks_mm(), {}, tuning, random);
  CHECK(trust(sample, "ibug54") == kTrustNone);
  CHECK(trust(sample, "ibug37") == kTrustAnnotated);
}

TEST_CASE("varied expressions stay within the limits, and random faces differ") {
  const Model& model = baked_face().model;
  const ExpressionVariation variation(model);
  SampleRandom random(9, 9);
  std::vector<float> q = baked_face().rest(), last = q;
  int closed = 0;
  for (int k = 0; k < 200; ++k) {
    q = k % 2 == 0 ? variation.varied(q, random) : variation.random_face(random);
    CHECK(q != last);
    last = q;
    for (std::size_t p = 0; p < q.size(); ++p) {
      REQUIRE(q[p] >= model.parameters()[p].minimum);
      REQUIRE(q[p] <= model.parameters()[p].maximum);
    }
    closed += q[model.find_parameter("eyeBlinkLeft")] > 0.9f ? 1 : 0;
    if (k % 2 == 1) q = baked_face().rest();
  }
  CHECK(closed > 5);
}

TEST_CASE("lips meet as often as is wanted, whatever the photograph's do") {
  BakedModel& face = baked_face();
  const Landmark &upper = face.model.landmarks()[face.model.find_landmark("ibug62")],
                 &lower = face.model.landmarks()[face.model.find_landmark("ibug66")];
  std::vector<float> open = face.rest();
  open[face.model.find_parameter("jawOpen")] = 0.5f;
  const auto gap_mm = [&](const std::vector<float>& q) {
    return length(face.cascade.surface_point(upper.uv(), q.data()) -
                  face.cascade.surface_point(lower.uv(), q.data()));
  };
  REQUIRE(gap_mm(open) > 5);
  const auto shut_of_100 = [&](float chance) {
    ExpressionVariationTuning tuning;
    tuning.unchanged_chance = tuning.relax_chance = 0;
    tuning.shut_chance = chance;
    const ExpressionVariation variation(face.model, tuning);
    SampleRandom random(4, 2);
    int shut = 0;
    for (int k = 0; k < 100; ++k) shut += gap_mm(variation.varied(open, random)) < 2 ? 1 : 0;
    return shut;
  };
  CHECK(shut_of_100(1) > 90);
  CHECK(shut_of_100(0) < 10);
}

TEST_CASE("face is put into the box that was wanted") {
  const Model& model = baked_face().model;
  const auto points = landmarks_mm();
  for (const float yaw : {-0.8f, 0.0f, 0.5f}) {
    Camera camera;
    Pose pose;
    place_face(model, points, rotation_of(yaw, 0.2f, -0.3f), {160, {{60, 90}, 80}, 500}, &camera, &pose);
    const FaceBox box = face_box_in(model, projected(points, pose, camera), pose, camera);
    CHECK(box.side == doctest::Approx(80));
    CHECK(length(box.center - Vec2{60, 90}) < 0.05f);
    CHECK(camera.cx == 79.5f);
  }
}

TEST_CASE("distances to shapes are negative inside and grow outside") {
  const std::vector<Vec2> square{{0, 0}, {10, 0}, {10, 10}, {0, 10}};
  CHECK(outside_polygon({5, 5}, square) == doctest::Approx(-5));
  CHECK(outside_polygon({13, 5}, square) == doctest::Approx(3));
  CHECK(outside_capsule({5, 4}, {0, 0}, {10, 0}, 1) == doctest::Approx(3));
  CHECK(outside_ellipse({0, 0}, {0, 0}, {4, 2}) == doctest::Approx(-2));
  CHECK(outside_ellipse({4, 0}, {0, 0}, {4, 2}) == doctest::Approx(0));
}

}  // namespace sample_parts_test
