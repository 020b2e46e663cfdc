// How much texture a picture shows where on the surface.
#include "track/surface_texture.hpp"

#include <doctest/doctest.h>

#include "template_rig.hpp"

namespace surface_texture_test {

using namespace pliant;
using template_rig::film;
using template_rig::Rig;

namespace {

constexpr std::uint8_t kSide = 16;

EstimatorOptions adapting() {
  EstimatorOptions options;
  options.mesh_operations = 10;
  return options;
}

/// The texture of a face whose picture is flat right of the middle, in a region that is not at the frame's corner.
struct HalfTextured {
  Rig rig{40, 160};
  InArena<SurfaceTexture> texture{kSide};

  HalfTextured() {
    std::vector<std::uint8_t> pixels = film().frames[0];
    for (std::size_t k = 0; k < pixels.size(); ++k)
      if (k % 320 >= 160) pixels[k] = 128;
    FrameView view = film().view(0);
    view.data = pixels.data();
    REQUIRE(rig.region->build(view, {160, 120}) == Status::ok);
    EstimatorOptions options = adapting();
    texture->start(&options);
  }
  std::vector<float> scores() {
    std::vector<float> all;
    for (int k = 0; k < kSide * kSide; ++k)
      all.push_back(texture->score(
          {(static_cast<float>(k % kSide) + 0.5f) / kSide, (static_cast<float>(k / kSide) + 0.5f) / kSide}));
    return all;
  }
};

}  // namespace

TEST_CASE("texture scores where the picture has some, and nowhere else") {
  HalfTextured half;
  for (const float score : half.scores()) CHECK(score == 0);
  half.texture->note(half.rig.estimator.object, half.rig.region.object, 0);
  float most[2] = {};
  int textured[2] = {};
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j) {
      const Vec2 uv{(static_cast<float>(i) + 0.5f) / kSide, (static_cast<float>(j) + 0.5f) / kSide};
      Vec2 x;
      REQUIRE(half.rig.estimator->project(uv, &x));
      if (magnitude(x.x - 160) < 15) continue;  // a cell may have samples of both sides
      const float score = half.texture->score(uv);
      most[x.x > 160] = max(most[x.x > 160], score);
      textured[x.x > 160] += score > 0;
    }
  CHECK(textured[0] > 30);
  CHECK(most[0] > 1);
  CHECK(most[0] <= kSurfaceTextureTuning.most_score);
  CHECK(most[1] == 0);
  EstimatorOptions options = adapting();
  half.texture->start(&options);
  for (const float score : half.scores()) CHECK(score == 0);  // another track
}

TEST_CASE("frame by frame each face is noted once in an interval") {
  HalfTextured half, all;
  all.texture->note(all.rig.estimator.object, all.rig.region.object, 0);
  const auto count = [](const std::vector<float>& scores) {
    int n = 0;
    for (const float score : scores) n += score > 0;
    return n;
  };
  half.texture->note(half.rig.estimator.object, half.rig.region.object, 1);
  CHECK(2 * count(half.scores()) < count(all.scores()));
  for (std::uint32_t k = 2; k <= kSurfaceTextureTuning.interval_frames; ++k)
    half.texture->note(half.rig.estimator.object, half.rig.region.object, k);
  CHECK(count(half.scores()) > 0.9f * static_cast<float>(count(all.scores())));
}

TEST_CASE("the score is offered to a mesh that adapts and has none of its own") {
  InArena<SurfaceTexture> texture(kSide);
  EstimatorOptions options = adapting();
  options.mesh_operations = 0;
  texture->start(&options);
  CHECK((options.texture.score == nullptr));
  options = adapting();
  texture->start(&options);
  REQUIRE((options.texture.score != nullptr));
  CHECK(options.texture.score(options.texture.context, {1, 1}) == 0);
  const auto own = [](void*, Vec2) { return 2.0f; };
  options.texture.score = own;
  texture->start(&options);
  CHECK(options.texture.score(options.texture.context, {0.5f, 0.5f}) == 2);
}

}  // namespace surface_texture_test
