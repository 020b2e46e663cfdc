#include "pliant/visibility.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <utility>

#include "model_builder.hpp"
#include "random.hpp"

namespace visibility_test {

using namespace pliant;

namespace {

void set_base(Mesh& mesh, const ModelBuilder& b) {
  REQUIRE(mesh.set_base({b.vertices.data(), b.vertices.size()}, {b.corners.data(), b.corners.size()}) ==
          Status::ok);
}

}  // namespace

TEST_CASE("the nearest point of a triangle is inside it, and no sampled point of it is nearer") {
  Random random(3);
  for (int trial = 0; trial < 300; ++trial) {
    const auto point = [&] { return Vec2{random.uniform(0, 10), random.uniform(0, 10)}; };
    const Vec2 a = point(), b = point(), c = trial % 10 == 0 ? a : point(), x = point();
    float w[3];
    const float d2 = nearest_on_triangle(a, b, c, x, w);
    CHECK(w[0] + w[1] + w[2] == doctest::Approx(1));
    for (float each : w) CHECK(each >= -1e-5f);
    const Vec2 at = w[0] * a + (w[1] * b + w[2] * c);
    CHECK(dot(at - x, at - x) == doctest::Approx(double(d2)).epsilon(1e-3).scale(1));
    for (int i = 0; i <= 10; ++i)
      for (int k = 0; i + k <= 10; ++k) {
        const float u = 0.1f * static_cast<float>(i), v = 0.1f * static_cast<float>(k);
        const Vec2 s = u * a + (v * b + (1 - u - v) * c);
        CHECK(dot(s - x, s - x) >= d2 - 1e-3f);
      }
  }
}

TEST_CASE("the weights of the nearest point are those of a point, however far away the other one is") {
  for (const Vec2 x : {Vec2{1e16f, 0}, Vec2{-3e38f, 3e38f}, Vec2{0, 1e30f}}) {
    float w[3] = {7, 7, 7};
    nearest_on_triangle({0, 0}, {10, 0}, {0, 10}, x, w);
    CHECK(w[0] + w[1] + w[2] == doctest::Approx(1));
    for (const float each : w) CHECK((each >= 0 && each <= 1));
  }
}

TEST_CASE("a mesh that faces the camera hides what lies behind it and nothing else") {
  ModelBuilder b;
  b.grid_mesh(4);
  InArena<Mesh> mesh(MeshLimits{});
  set_base(mesh.object, b);
  std::vector<Vec2> image;
  std::vector<float> depth;
  for (Vec2 uv : b.vertices) {
    image.push_back({50 + 100 * uv.x, 20 + 80 * uv.y});
    depth.push_back(500 + 100 * uv.x);
  }
  InArena<DepthBuffer> buffer(32, 32);
  buffer->draw(mesh.object, image.data(), depth.data());
  CHECK(buffer->hides({60, 60}, 600, 5));
  CHECK_FALSE(buffer->hides({60, 60}, 505, 5));
  CHECK_FALSE(buffer->hides({140, 60}, 585, 5));
  CHECK(buffer->hides({140, 60}, 620, 5));
  CHECK_FALSE(buffer->hides({10, 60}, 900, 5));
  buffer->move({7, -9});  // what was drawn has moved: the border with it
  CHECK(buffer->hides({67, 51}, 600, 5));
  CHECK_FALSE(buffer->hides({67, 51}, 505, 5));
  CHECK_FALSE(buffer->hides({55, 51}, 900, 5));
  CHECK(buffer->hides({155, 51}, 900, 5));
  for (Vec2& x : image) x.x = 200 - x.x;  // mirrored in the image: now every face turns away
  buffer->draw(mesh.object, image.data(), depth.data());
  CHECK_FALSE(buffer->hides({100, 60}, 900, 5));
}

TEST_CASE("a point is hidden if the surface is nearer by more than the margin") {
  ModelBuilder b;
  b.grid_mesh(4);
  InArena<Mesh> mesh(MeshLimits{});
  set_base(mesh.object, b);
  std::vector<Vec2> image;
  for (Vec2 uv : b.vertices) image.push_back({100 * uv.x, 100 * uv.y});
  const std::vector<float> depth(image.size(), 500.0f);
  InArena<DepthBuffer> buffer(32, 32);
  buffer->draw(mesh.object, image.data(), depth.data());
  CHECK(buffer->hides({50, 50}, 506, 5));
  CHECK_FALSE(buffer->hides({50, 50}, 504, 5));
  for (const Vec2 outside : {Vec2{50, -1}, {50, 101}, {50, 1e6f}, {-1, 50}, {1e6f, 50}})
    CHECK_FALSE(buffer->hides(outside, 1e9f, 5));
}

TEST_CASE("the grid covers a mesh that is much higher than wide, or wider, to its end") {
  for (const Vec2 size : {Vec2{20, 300}, {300, 20}}) {
    ModelBuilder b;
    b.grid_mesh(4);
    InArena<Mesh> mesh(MeshLimits{});
    set_base(mesh.object, b);
    std::vector<Vec2> image;
    for (Vec2 uv : b.vertices) image.push_back({size.x * uv.x, size.y * uv.y});
    const std::vector<float> depth(image.size(), 500.0f);
    InArena<DepthBuffer> buffer(32, 32);
    buffer->draw(mesh.object, image.data(), depth.data());
    for (const float part : {0.1f, 0.5f, 0.9f}) CHECK(buffer->hides({part * size.x, part * size.y}, 900, 5));
  }
}

TEST_CASE("edges between faces that run through the middles of cells leave none of them open") {
  ModelBuilder b;
  b.grid_mesh(3);
  InArena<Mesh> mesh(MeshLimits{});
  set_base(mesh.object, b);
  const float at[] = {0, 0.5f, 4.5f, 8};  // px, of columns and rows; a cell is a pixel
  std::vector<Vec2> image;
  for (Vec2 uv : b.vertices)
    image.push_back({at[static_cast<int>(3 * uv.x + 0.5f)], at[static_cast<int>(3 * uv.y + 0.5f)]});
  const std::vector<float> depth(image.size(), 500.0f);
  InArena<DepthBuffer> buffer(8, 8);
  buffer->draw(mesh.object, image.data(), depth.data());
  REQUIRE(buffer->cell_px() == 1);
  for (int j = 0; j < 8; ++j)
    for (int i = 0; i < 8; ++i)
      CHECK(buffer->hides({static_cast<float>(i) + 0.5f, static_cast<float>(j) + 0.5f}, 900, 5));
}

TEST_CASE("of surfaces over each other the nearest one counts, in whatever order they are drawn") {
  ModelBuilder b;
  b.grid_mesh(3);
  InArena<Mesh> mesh(MeshLimits{});
  set_base(mesh.object, b);
  const float across[] = {0, 60, 10, 70};  // of the columns: the middle part is turned over
  for (const bool first_is_near : {false, true}) {
    CAPTURE(first_is_near);
    std::vector<Vec2> image;
    std::vector<float> depth;
    for (Vec2 uv : b.vertices) {
      const int column = static_cast<int>(3 * uv.x + 0.5f);
      image.push_back({across[column], 60 * uv.y});
      depth.push_back((column < 2) == first_is_near ? 500.0f : 600.0f);
    }
    InArena<DepthBuffer> buffer(32, 32);
    buffer->draw(mesh.object, image.data(), depth.data());
    CHECK(buffer->hides({35, 30}, 550, 5));
    CHECK_FALSE(buffer->hides({35, 30}, 500, 5));
  }
}

TEST_CASE("faces much smaller and larger than a cell leave none of the cells between them open") {
  for (const int side : {2, 9, 40, 100}) {
    ModelBuilder b;
    b.grid_mesh(side);
    MeshLimits limits;
    limits.vertices = 11000;
    limits.faces = 21000;
    InArena<Mesh> mesh(limits);
    set_base(mesh.object, b);
    std::vector<Vec2> image;
    std::vector<float> depth;
    for (Vec2 uv : b.vertices) {  // turned and sheared: no edge runs along the cells
      image.push_back({10 + 83 * uv.x + 21 * uv.y, 40 - 17 * uv.x + 71 * uv.y});
      depth.push_back(500 + 60 * uv.x - 40 * uv.y);
    }
    InArena<DepthBuffer> buffer(32, 32);
    buffer->draw(mesh.object, image.data(), depth.data());
    for (float u = 0.08f; u < 0.92f; u += 0.011f)
      for (float v = 0.08f; v < 0.92f; v += 0.013f) {
        const Vec2 x{10 + 83 * u + 21 * v, 40 - 17 * u + 71 * v};
        const float there = 500 + 60 * u - 40 * v;
        REQUIRE(buffer->hides(x, there + 8, 4));  // a cell is 3 px wide: 3 mm of depth
        REQUIRE_FALSE(buffer->hides(x, there - 4, 0));
      }
  }
}

TEST_CASE(
    "faces with a vertex behind the camera are not drawn, whatever its image, nor those with one that is no "
    "number, as products of "
    "large matrices make it") {
  ModelBuilder b;
  b.grid_mesh(4);
  InArena<Mesh> mesh(MeshLimits{});
  set_base(mesh.object, b);
  std::vector<Vec2> image;
  for (Vec2 uv : b.vertices) image.push_back({50 + 100 * uv.x, 20 + 80 * uv.y});
  std::vector<float> depth(image.size(), 500.0f);
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN(),
                  kFar = std::numeric_limits<float>::infinity();
  const std::pair<float, float> kVertices[] = {{0.0f, -1.0f}, {1e30f, -1.0f}, {kNone, -1.0f}, {kNone, kFar}};
  for (const auto& vertex : kVertices) {
    const float anywhere = vertex.first, depth_there = vertex.second;
    CAPTURE(anywhere);
    CAPTURE(depth_there);
    image[0] = {anywhere, -anywhere};
    depth[0] = depth_there;
    InArena<DepthBuffer> buffer(16, 16);
    buffer->draw(mesh.object, image.data(), depth.data());
    CHECK_FALSE(buffer->hides({55, 25}, 900, 5));
    CHECK(buffer->hides({120, 80}, 900, 5));
  }
}

TEST_CASE("a mesh behind the camera is not drawn") {
  ModelBuilder b;
  b.grid_mesh(2);
  InArena<Mesh> mesh(MeshLimits{});
  set_base(mesh.object, b);
  const std::vector<Vec2> image(b.vertices.size());
  const std::vector<float> depth(b.vertices.size(), -1.0f);
  InArena<DepthBuffer> buffer(8, 8);
  buffer->draw(mesh.object, image.data(), depth.data());
  CHECK_FALSE(buffer->hides({0, 0}, 100, 0));
  CHECK(buffer->cell_px() > 0);
}

}  // namespace visibility_test
