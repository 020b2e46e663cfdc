// The software rasteriser and the drawing tools of the host command, against pictures that are known.
#include "host/render/raster.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "host/bake/opened_table.hpp"
#include "host/io/image.hpp"
#include "host/render/draw.hpp"
#include "host/render/overlay.hpp"
#include "host/render/scene.hpp"
#include "host/render/sheet.hpp"
#include "pliant/camera.hpp"
#include "random.hpp"
#include "textured_model.hpp"

namespace raster_test {

using namespace pliant;
using namespace pliant::host;

namespace {

RasterVertex corner(const Projector& projector, Vec3 p, Vec2 uv) {
  RasterVertex v;
  REQUIRE(projector.project(p, &v.x));
  v.inverse_depth = 1 / projector.to_camera(p).z;
  v.uv = uv;
  v.light = 1;
  return v;
}

const auto kPaintU = [](Vec2 uv, float light, float* grey) {
  *grey = 200 * uv.x * light;
  return true;
};

/// Centre of what is brighter than `floor` within `radius` of x, weighted by how much.
Vec2 bright_centre(const Image& image, Vec2 x, int radius, float floor) {
  Vec2 sum;
  float weight = 0;
  const int cx = static_cast<int>(std::lround(x.x)), cy = static_cast<int>(std::lround(x.y));
  for (int j = cy - radius; j <= cy + radius; ++j)
    for (int i = cx - radius; i <= cx + radius; ++i) {
      if (!image.contains(i, j)) continue;
      const float w = max(0.0f, static_cast<float>(*image.at(i, j)) - floor);
      sum = sum + w * Vec2{static_cast<float>(i), static_cast<float>(j)};
      weight += w;
    }
  return (1 / weight) * sum;
}

}  // namespace

TEST_CASE("a tilted plane shows at each pixel the texture of the point that the pixel's ray meets") {
  const Camera camera = centred_camera(160, 120, 200);
  const Pose pose{exp_rotation({0.3f, 0.6f, 0.1f}), {10, -5, 400}};
  const Projector projector(view_of(pose, camera), true);
  // The square [-60,60]^2 of the plane z = 0, u and v along x and -y.
  const auto at = [&](float u, float v) {
    return corner(projector, {120 * u - 60, 60 - 120 * v, 0}, {u, v});
  };
  Raster raster(160, 120, 1);
  raster.clear();
  raster.draw(at(0, 0), at(1, 0), at(0, 1), kPaintU);
  raster.draw(at(1, 0), at(1, 1), at(0, 1), kPaintU);
  const Vec3 origin = projector.to_camera({}), du = projector.rotated({120, 0, 0}),
             dv = projector.rotated({0, -120, 0});
  const Vec3 normal = cross(du, dv), top_left = origin - 0.5f * (du + dv);
  int inside = 0;
  float worst = 0;
  for (int y = 0; y < 120; ++y)
    for (int x = 0; x < 160; ++x) {
      const Vec3 ray{(static_cast<float>(x) - camera.cx) / camera.f,
                     (static_cast<float>(y) - camera.cy) / camera.f, 1};
      const Vec3 hit = (dot(origin, normal) / dot(ray, normal)) * ray - top_left;
      const float u = dot(hit, du) / dot(du, du), v = dot(hit, dv) / dot(dv, dv);
      const float margin = 0.01f;
      if (u < -margin || u > 1 + margin || v < -margin || v > 1 + margin) CHECK(raster.coverage(x, y) == 0);
      if (u < margin || u > 1 - margin || v < margin || v > 1 - margin) continue;
      ++inside;
      REQUIRE(raster.coverage(x, y) == 1);
      worst = max(worst, magnitude(raster.value(x, y, 0) - 200 * u));
    }
  CHECK(inside > 1500);
  CHECK(worst < 0.05f);  // 1/4000 of the square
}

TEST_CASE("the nearer surface hides the farther one, whatever is drawn first") {
  const auto vertex = [](float x, float y, float depth, float grey) {
    return RasterVertex{{x, y}, 1 / depth, {grey, 0}, 1};
  };
  for (const bool near_first : {true, false}) {
    Raster raster(32, 32, 2);
    raster.clear();
    const auto draw = [&](float depth, float u) {
      raster.draw(vertex(-40, -40, depth, u), vertex(80, -40, depth, u), vertex(-40, 80, depth, u), kPaintU);
    };
    draw(near_first ? 100.0f : 200.0f, near_first ? 1.0f : 0.25f);
    draw(near_first ? 200.0f : 100.0f, near_first ? 0.25f : 1.0f);
    CHECK(raster.value(10, 10, 0) == doctest::Approx(200));
  }
}

TEST_CASE("two planes that cross meet where their depths are equal, not where their edges are") {
  // Depths 100 + x and 131 - x over a 32 pixel picture: they cross at x = 15.5. 1/depth is what is linear in
  // the image, so each plane is drawn with its true 1/depth in narrow strips.
  Raster raster(32, 8, 1);
  raster.clear();
  const auto strip = [&](int x, float depth_left, float depth_right, float u) {
    const auto l = static_cast<float>(x) - 0.5f, r = l + 1;
    const RasterVertex a{{l, -1}, 1 / depth_left, {u, 0}, 1}, b{{r, -1}, 1 / depth_right, {u, 0}, 1};
    const RasterVertex c{{l, 9}, 1 / depth_left, {u, 0}, 1}, d{{r, 9}, 1 / depth_right, {u, 0}, 1};
    raster.draw(a, b, c, kPaintU);
    raster.draw(b, d, c, kPaintU);
  };
  for (int x = 0; x < 32; ++x) {
    const auto at = static_cast<float>(x);
    strip(x, 99.5f + at, 100.5f + at, 1);
    strip(x, 131.5f - at, 130.5f - at, 0.5f);
  }
  CHECK(raster.value(14, 4, 0) == doctest::Approx(200));
  CHECK(raster.value(17, 4, 0) == doctest::Approx(100));
}

TEST_CASE(
    "triangles with a common edge leave no gap, and boundary pixels blend with the background by coverage") {
  Random random(3);
  Raster raster(40, 40, 4);
  for (int round = 0; round < 50; ++round) {
    raster.clear();
    const Vec2 m{random.uniform(12, 28), random.uniform(12, 28)};
    const Vec2 ring[4] = {{4, 5}, {35, 3}, {36, 34}, {3, 36}};
    for (int k = 0; k < 4; ++k) {
      const auto v = [](Vec2 x) { return RasterVertex{x, 0.01f, {1, 0}, 1}; };
      raster.draw(v(ring[k]), v(ring[(k + 1) % 4]), v(m), kPaintU);
    }
    for (int y = 7; y < 33; ++y)
      for (int x = 7; x < 33; ++x) REQUIRE(raster.coverage(x, y) == 1);
  }
  raster.clear();
  const auto v = [](float x, float y) { return RasterVertex{{x, y}, 0.01f, {1, 0}, 1}; };
  raster.draw(v(-50, -50), v(20, -50), v(20, 90), kPaintU);  // its right edge cuts pixel 20 in half
  CHECK(raster.coverage(20, 20) == doctest::Approx(0.5));
  CHECK(raster.value(20, 20, 40) == doctest::Approx(0.5 * 200 + 0.5 * 40));
}

TEST_CASE("a painted spot appears at its projection, to a twentieth of a pixel") {
  TexturedModel source;
  const Vec2 spots[] = {{0.3f, 0.3f}, {0.71f, 0.36f}, {0.52f, 0.55f}, {0.27f, 0.74f}, {0.66f, 0.8f}};
  source.rest = [](float u, float v) { return Vec3{120 * u - 60, 80 - 160 * v, 0}; };
  source.paint = [&](float u, float v) {
    float grey = 40;
    for (const Vec2 s : spots) {
      // Round on the surface, which is 120 by 160 mm.
      const float dx = 120 * (u - s.x), dy = 160 * (v - s.y);
      grey += 180 * std::exp(-(dx * dx + dy * dy) / 18);
    }
    return min(grey, 255);
  };
  const bake::OpenedTable table(source.bytes());
  const Camera camera = centred_camera(320, 240, 450);
  const std::vector<float> q(table.model().parameters().count, 0.0f);
  Scene scene(table.model(), 320, 240);
  const Image background(320, 240, 1, 0);
  Owned<Cascade> cascade(table.model());
  for (const Vec3 turn : {Vec3{0, 0, 0}, Vec3{0.1f, 0.35f, -0.2f}, Vec3{-0.25f, -0.3f, 0.4f}}) {
    const Pose pose{exp_rotation(turn), {7.3f, -4.1f, 480}};
    const Projector projector(view_of(pose, camera), true);
    const Image image = scene.draw(q.data(), pose, camera, background);
    for (const Vec2 spot : spots) {
      Vec2 x;
      REQUIRE(projector.project(cascade->surface_point(spot, q.data()), &x));
      // A flat sheet has one brightness: what lies above the darker ground around is the spot.
      const float ground =
          static_cast<float>(*image.at(static_cast<int>(x.x) + 11, static_cast<int>(x.y) + 3));
      CHECK(length(bright_centre(image, x, 8, ground + 2) - x) < 0.05f);
    }
  }
}

TEST_CASE("holes of the mask are drawn behind lids and lips only, the outside of its boundary is not") {
  const bake::OpenedTable table(TexturedModel{}.bytes());
  ChartTexture texture(table.model());
  CHECK(texture.covers({0.5f, 0.5f}));
  CHECK(texture.covers({0, 0}));

  // A disc with a hole, in a mask of 64 x 64.
  host::bake::TableWriter writer;
  CascadeRecord r = host::bake::empty_record(Operation::constant);
  r.field = writer.add_field(TexturedModel::grid(9, [](float u, float v) { return Vec3{u, v, 0}; }), 16);
  writer.add_record(r);
  writer.add_parameter({"none", Group::identity, -1, 1, 1});
  writer.add_landmark({"a", {0.5f, 0.5f}});
  writer.set_base_mesh({{0, 0}, {1, 0}, {0, 1}}, {0, 1, 2});
  host::bake::GreyImage mask{64, 64, {}};
  for (int j = 0; j < 64; ++j)
    for (int i = 0; i < 64; ++i) {
      const float x = static_cast<float>(i) - 31.5f, y = static_cast<float>(j) - 31.5f,
                  d = std::sqrt(x * x + y * y);
      mask.pixels.push_back(d < 25 && !(d < 6));
    }
  writer.set_mask(mask);
  for (const bool has_lip : {false, true}) {
    if (has_lip) writer.add_curve({"lip", CurveKind::lip, {{0.4f, 0.5f}, {0.6f, 0.5f}}});
    const host::bake::OpenedTable opened(writer.bytes());
    REQUIRE(opened.status() == Status::ok);
    const ChartTexture disc(opened.model());
    CHECK(disc.covers({0.5f, 0.5f}) == has_lip);
    CHECK(disc.covers({0.5f, 0.15f}));
    CHECK_FALSE(disc.covers({0.5f, 0.05f}));
    CHECK_FALSE(disc.covers({0.02f, 0.02f}));
  }
}

TEST_CASE("the light comes from the upper left, so that a bump is bright there and dark on the other side") {
  TexturedModel source;
  source.paint = [](float, float) { return 180.0f; };
  source.rest = [](float u, float v) {
    const float x = 2 * u - 1, y = 1 - 2 * v;
    return Vec3{60 * x, 60 * y, 60 * std::sqrt(max(0.0f, 1 - 0.5f * (x * x + y * y)))};
  };
  const bake::OpenedTable table(source.bytes());
  const std::vector<float> q(table.model().parameters().count, 0.0f);
  Scene scene(table.model(), 200, 200);
  const Image image =
      scene.draw(q.data(), {{}, {0, 0, 400}}, centred_camera(200, 200, 400), Image(200, 200, 1, 0));
  CHECK(*image.at(70, 70) > *image.at(100, 100));
  CHECK(*image.at(100, 100) > *image.at(135, 135) + 20);
  CHECK(*image.at(5, 5) == 0);
}

TEST_CASE("noise has the requested standard deviation, and depends on the seed only") {
  Image a(200, 200, 1, 128), b(200, 200, 1, 128), c(200, 200, 1, 128);
  add_noise(a, 5, 7);
  add_noise(b, 5, 7);
  add_noise(c, 5, 8);
  CHECK(a.pixels == b.pixels);
  CHECK(a.pixels != c.pixels);
  double sum = 0, squares = 0;
  for (const std::uint8_t p : a.pixels) {
    sum += p;
    squares += (p - 128.0) * (p - 128.0);
  }
  CHECK(sum / 40000 == doctest::Approx(128).epsilon(0.002));
  CHECK(std::sqrt(squares / 40000) == doctest::Approx(5).epsilon(0.02));
}

TEST_CASE("the head in frontal pose has the requested height and is centred") {
  const bake::OpenedTable table(TexturedModel{}.bytes());
  const std::vector<float> q(table.model().parameters().count, 0.0f);
  const Camera camera = centred_camera(320, 240, 450);
  const Pose pose = frontal_pose(table.model(), q.data(), camera, 240, 0.55f);
  Scene scene(table.model(), 320, 240);
  const Image image = scene.draw(q.data(), pose, camera, Image(320, 240, 1, 0));
  int first = 240, last = 0;
  for (int y = 0; y < 240; ++y)
    if (*image.at(160, y) > 0) {
      first = std::min(first, y);
      last = y;
    }
  CHECK(last - first == doctest::Approx(0.55 * 240).epsilon(0.06));
  CHECK(0.5 * (first + last) == doctest::Approx(119.5).epsilon(0.03));
}

TEST_CASE("a picture survives PNG, and grey becomes colour and back") {
  Random random(5);
  Image image(37, 23, 3);
  for (auto& p : image.pixels) p = static_cast<std::uint8_t>(random.uniform(0, 255.9f));
  const std::string png = encode_png(image);
  CHECK(png.substr(1, 3) == "PNG");
  CHECK(image_in("a.png", png).pixels == image.pixels);
  CHECK(to_grey(to_colour(to_grey(image))).pixels == to_grey(image).pixels);
}

TEST_CASE("a line covers its length once, a dot its area") {
  Image image(64, 64, 3, 0);
  draw_line(image, {10, 20}, {50, 20}, 1, {255, 255, 255}, 1);
  double sum = 0;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) sum += image.at(x, y)[0] / 255.0;
  CHECK(sum == doctest::Approx(41).epsilon(0.04));
  Image dot(64, 64, 3, 0);
  draw_dot(dot, {31.5f, 31.5f}, 8, {255, 0, 0}, 1);
  sum = 0;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) sum += dot.at(x, y)[0] / 255.0;
  CHECK(sum == doctest::Approx(3.14159 * 8 * 8).epsilon(0.03));
}

TEST_CASE("what reaches over the border is cut off there, and what is far away or nowhere is not drawn") {
  constexpr int kSide = 64, kAround = 96;
  Image image(kSide, kSide, 1, 0), larger(kSide + 2 * kAround, kSide + 2 * kAround, 1, 0);
  const auto draw = [](Image& on, int by) {
    const float s = static_cast<float>(by);
    const Colour white{255, 255, 255};
    draw_line(on, {s - 30, s - 30}, {s + 90, s + 95}, 3, white, 1);
    draw_line(on, {s - 20, s + 40}, {s + 5, s + 40}, 2, white, 1);
    draw_dot(on, {s + 64, s + 20}, 6, white, 1);
    draw_ring(on, {s + 2, s + 63}, 5, 2, white, 1);
    draw_text(on, by + 55, by - 5, "outside 0.5%", {2, white, 1});
  };
  draw(image, 0);
  draw(larger, kAround);
  int coloured = 0, other = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const int a = *image.at(x, y), b = *larger.at(x + kAround, y + kAround);
      coloured += a > 0;
      other += std::abs(a - b) > 1;  // coordinates are rounded in other places
    }
  CHECK(coloured > 300);
  CHECK(other == 0);
  const Image before = image;
  draw_line(image, {-1e9f, 3}, {1e9f, 40}, 2, {9, 9, 9}, 1);
  draw_dot(image, {NAN, 4}, 3, {1, 1, 1}, 1);
  draw_dot(image, {-100, 4}, 3, {1, 1, 1}, 1);
  CHECK(image.pixels == before.pixels);
}

TEST_CASE("every character of the font looks different, lies within its width, and others draw nothing") {
  const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789.,:-/%=+_()<>'";
  std::vector<std::vector<std::uint8_t>> pictures;
  for (const char c : letters) {
    CAPTURE(c);
    Image image(40, 40, 1, 255);
    draw_text(image, 4, 4, std::string(1, c), {3, {0, 0, 0}, 1});
    const int right = 4 + text_width(std::string(1, c), 3);
    int dark = 0;
    for (int y = 0; y < 40; ++y)
      for (int x = 0; x < 40; ++x) {
        if (*image.at(x, y) == 255) continue;
        ++dark;
        CHECK(x >= 2);
        CHECK(x < right);
        CHECK(y >= 2);
        CHECK(y <= 4 + 9 * 3 + 2);
      }
    CHECK(dark > 4);
    CHECK(std::find(pictures.begin(), pictures.end(), image.pixels) == pictures.end());
    pictures.push_back(image.pixels);
  }
  Image image(40, 40, 1, 255);
  draw_text(image, 4, 4, " \xc3\xa9\t~", {1.3f, {0, 0, 0}, 1});
  CHECK(image.pixels == Image(40, 40, 1, 255).pixels);
  CHECK(text_width("", 2) == 0);
  CHECK(text_width("ab", 2) == text_width("a", 2) + text_width("b", 2));
  CHECK(text_width("\xc3\xa9", 2) == text_width(" ", 2));
  CHECK(text_width("\xe6\xbc\xa2\xf0\x9f\x99\x82", 2) == 2 * text_width(" ", 2));
}

TEST_CASE("enlarging keeps positions: the centre of a spot moves with the picture") {
  Image image(40, 30, 1, 0);
  *image.at(12, 9) = 200;
  const Image twice = enlarged(image, 2);
  CHECK(twice.width == 80);
  const Vec2 centre = bright_centre(twice, {25, 19}, 6, 0);
  CHECK(centre.x == doctest::Approx(2 * 12.5 - 0.5));
  CHECK(centre.y == doctest::Approx(2 * 9.5 - 0.5));
  CHECK(shrunk_to(twice, 40, 400).width == 40);
  CHECK(shrunk_to(image, 80, 80).width == 40);
}

TEST_CASE("shrinking by any ratio keeps positions, and the mean grey") {
  for (const int side : {100, 64, 57, 33}) {
    CAPTURE(side);
    Image image(100, 100, 1, 50);
    for (int y = 40; y < 60; ++y)
      for (int x = 20; x < 45; ++x) *image.at(x, y) = 200;
    const Image small = shrunk_to(image, side, side);
    REQUIRE(small.width == side);
    double sum = 0, sum_x = 0, sum_y = 0;
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const double grey = *small.at(x, y) - 50.0;
        sum += grey, sum_x += grey * (x + 0.5), sum_y += grey * (y + 0.5);
      }
    CHECK(sum / (side * side) == doctest::Approx(150 * 500 / 1e4).epsilon(0.02));
    CHECK(sum_x / sum / side == doctest::Approx(0.325).epsilon(0.001));
    CHECK(sum_y / sum / side == doctest::Approx(0.5).epsilon(0.001));
  }
}

TEST_CASE(
    "a contact sheet shows at most nine pictures, the first and the last, evenly spaced, of any number") {
  for (const int count : {1, 2, 5, 9, 10, 36, 37, 38, 150, 200, 500, 2400})
    for (const int expected : {0, count}) {
      ContactSheet sheet(static_cast<std::size_t>(expected));
      int made = 0;
      for (int k = 0; k < count; ++k) {
        if (!sheet.wants_next()) {
          sheet.skip();
          continue;
        }
        sheet.add([&made] {
          ++made;
          return Image(16, 12, 3);
        });
      }
      std::vector<int> chosen;
      for (const auto& picture : sheet.pictures()) chosen.push_back(picture.number);
      CAPTURE(count);
      CAPTURE(expected);
      CHECK(chosen.size() == static_cast<std::size_t>(std::min(count, 9)));
      CHECK(chosen.front() == 0);
      CHECK(chosen.back() == count - 1);
      for (std::size_t k = 1; k < chosen.size(); ++k) {
        CHECK(chosen[k] > chosen[k - 1]);
        if (count > 8)
          CHECK(std::abs(chosen[k] - chosen[k - 1] - (count - 1) / 8.0) <= 1 + (count - 1) / 16.0);
      }
      CHECK(made <= (expected == 0 ? 150 : 38));  // of up to 2,400
      CHECK(sheet.image().width == 3 * 16 + 4 * 4);
    }
}

TEST_CASE("a contact sheet of fewer pictures than were expected shows the last of those that it has") {
  ContactSheet sheet(100);
  for (int k = 0; k < 70; ++k)
    if (sheet.wants_next())
      sheet.add([] { return Image(16, 12, 3); });
    else
      sheet.skip();
  const auto chosen = sheet.pictures();
  CHECK(chosen.size() == 9);
  CHECK(chosen.back().number >= 64);
}

TEST_CASE("the mesh of an overlay is visible on a picture of any brightness") {
  for (const int grey : {0, 60, 128, 149, 150, 200, 255}) {
    Overlay overlay(Image(600, 80, 1, static_cast<std::uint8_t>(grey)));
    overlay.draw_mesh({{{20, 20}, {560, 30}, {300, 70}}, {{0, 1, 2}}});
    int contrast = 0;
    for (int y = 0; y < 80; ++y) {
      const std::uint8_t* p = overlay.image().at(300, y);
      contrast = std::max(contrast, std::abs((299 * p[0] + 587 * p[1] + 114 * p[2]) / 1000 - grey));
    }
    CAPTURE(grey);
    CHECK(contrast >= 16);
  }
}

// A face of 40 pixels in a picture 1280 pixels wide, with a mesh as fine as that of a large frame.
TEST_CASE("a small face is still seen below the marks of an overlay") {
  constexpr int kCells = 36;
  constexpr float kSide = 40, kFirst = 100;
  WireMesh mesh;
  for (int j = 0; j <= kCells; ++j)
    for (int i = 0; i <= kCells; ++i)
      mesh.x.push_back(
          {kFirst + kSide * static_cast<float>(i) / kCells, kFirst + kSide * static_cast<float>(j) / kCells});
  const auto at = [](int i, int j) { return static_cast<std::uint16_t>(j * (kCells + 1) + i); };
  for (int j = 0; j < kCells; ++j)
    for (int i = 0; i < kCells; ++i) {
      mesh.faces.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.faces.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  Image picture(1280, 240, 1, 120);
  for (int j = 100; j < 140; ++j)
    for (int i = 100; i < 120; ++i) *picture.at(i, j) = 40;  // the left half of the face is dark
  Overlay overlay(picture);
  overlay.draw_mesh(mesh);
  for (int k = 0; k < 68; ++k)
    overlay.draw_landmark(
        {kFirst + 4.0f * static_cast<float>(k % 10), kFirst + 5.0f * static_cast<float>(k / 10)});
  const auto mean = [&](int first, int last) {
    int sum = 0;
    for (int j = 102; j < 138; ++j)
      for (int i = first; i < last; ++i) {
        const std::uint8_t* p = overlay.image().at(i, j);
        sum += (299 * p[0] + 587 * p[1] + 114 * p[2]) / 1000;
      }
    return sum / (36 * (last - first));
  };
  CHECK(mean(102, 118) > 45);                    // there are marks
  CHECK(mean(122, 138) - mean(102, 118) >= 48);  // of a contrast of 80
}

}  // namespace raster_test
