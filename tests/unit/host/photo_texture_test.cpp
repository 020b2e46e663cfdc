// A photograph taken off a fitted face: what is seen is the photograph's, what is not comes from the other side or from
// around, and never from the background.
#include "host/render/photo_texture.hpp"

#include <doctest/doctest.h>

#include "baked_face.hpp"
#include "cli_run.hpp"
#include "mesh_reader.hpp"
#include "pliant/lens.hpp"

namespace photo_texture_test {

using namespace cli_run;
using namespace mesh_reader;

namespace {

constexpr int kSide = 256;

/// The built-in face in a picture of 400 x 400, turned by a rotation vector.
struct Shot {
  BakedModel& face = baked_face();
  std::vector<float> q = face.rest();
  FitFile fit;
  Image photo{400, 400, 3};

  explicit Shot(Vec3 turn) {
    fit.model_crc = face.model.crc();
    fit.width = fit.height = 400;
    fit.camera = centred_camera(400, 400, 700);
    fit.pose = {exp_rotation(turn), {0, -20, 700}};
    // Colours of skin with a gradient, so that the position follows from the colour.
    for (int y = 0; y < 400; ++y)
      for (int x = 0; x < 400; ++x)
        put(x, y, {150 + 0.2f * static_cast<float>(x), 90 + 0.2f * static_cast<float>(y), 80});
  }
  void put(int x, int y, Vec3 colour) {
    photo.at(x, y)[0] = static_cast<std::uint8_t>(colour.x);
    photo.at(x, y)[1] = static_cast<std::uint8_t>(colour.y);
    photo.at(x, y)[2] = static_cast<std::uint8_t>(colour.z);
  }
  Vec2 seen_at(Vec2 uv) {
    Vec2 x;
    REQUIRE(Projector(view_of(fit.pose, fit.camera), true).project(face.at(uv, q), &x));
    return x;
  }
  Image texture() { return photo_texture(face.model, fit, q, photo, kSide); }
};

const std::uint8_t* texel(const Image& texture, Vec2 uv) {
  return texture.at(static_cast<int>(uv.x * kSide), static_cast<int>(uv.y * kSide));
}

}  // namespace

TEST_CASE("surface that faces the camera gets the colour of the photograph at its projection") {
  Shot shot({0.1f, 0, 0.2f});
  const Image texture = shot.texture();
  for (const char* name :
       {"ibug21", "ibug22", "ibug27", "ibug29", "ibug30", "ibug37", "ibug44", "ibug51", "ibug57"}) {
    CAPTURE(name);
    const Vec2 uv = shot.face.uv(name), x = shot.seen_at(uv);
    CHECK(magnitude(static_cast<float>(texel(texture, uv)[0]) - (150 + 0.2f * x.x)) < 3);
    CHECK(magnitude(static_cast<float>(texel(texture, uv)[1]) - (90 + 0.2f * x.y)) < 3);
  }
}

TEST_CASE("lens distortion is corrected") {
  Shot shot({0, 0, 0});
  shot.fit.camera.k1 = -0.5f;
  Lens lens;
  REQUIRE(Lens::make(shot.fit.camera, 400, 400, &lens) == Status::ok);
  const Image texture = shot.texture();
  const Vec2 uv = shot.face.uv("ibug57"), ideal = shot.seen_at(uv), x = lens.distort(ideal);
  CHECK(length(x - ideal) > 0.2f);
  const Vec2 brow = shot.face.uv("ibug19"), there = lens.distort(shot.seen_at(brow));
  CHECK(magnitude(static_cast<float>(texel(texture, uv)[1]) - (90 + 0.2f * x.y)) < 1.5f);
  CHECK(magnitude(static_cast<float>(texel(texture, brow)[1]) - (90 + 0.2f * there.y)) < 1.5f);
}

TEST_CASE("the side that is turned away gets the mirror image of the other") {
  Shot shot({0, 0.9f, 0});
  // Turned to the picture's left or right: one outer eye corner is seen, and the other is not.
  const Image texture = shot.texture();
  const Vec2 left{0.82f, 0.45f}, right{0.18f, 0.45f};
  const Projector projector(view_of(shot.fit.pose, shot.fit.camera), true);
  const auto facing = [&](Vec2 uv) {
    const SurfaceFrame f = shot.face.cascade.surface_frame(uv, shot.q.data());
    return -dot(projector.rotated(normalised(cross(f.pv, f.pu))), normalised(projector.to_camera(f.p)));
  };
  const Vec2 seen = facing(left) > facing(right) ? left : right,
             hidden = facing(left) > facing(right) ? right : left;
  REQUIRE(facing(seen) > 0.6f);
  REQUIRE(facing(hidden) < 0);
  const Vec2 x = shot.seen_at(seen);
  CHECK(magnitude(static_cast<float>(texel(texture, seen)[0]) - (150 + 0.2f * x.x)) < 3);
  for (int c = 0; c < 3; ++c) CHECK(std::abs(texel(texture, hidden)[c] - texel(texture, seen)[c]) < 12);
}

TEST_CASE("where the model is wider than the person the texture has no background") {
  Shot shot({0, 0, 0});
  const Vec2 nose = shot.seen_at(shot.face.uv("ibug30")), cheek = shot.seen_at(shot.face.uv("ibug02"));
  const float half_width = 0.93f * magnitude(cheek.x - nose.x);
  for (int y = 0; y < 400; ++y)
    for (int x = 0; x < 400; ++x)
      if (magnitude(static_cast<float>(x) - nose.x) > half_width) shot.put(x, y, {20, 40, 220});
  const Image texture = shot.texture();
  int strange = 0, inside = 0;
  for (int j = 0; j < kSide; ++j)
    for (int i = 0; i < kSide; ++i) {
      const Vec2 uv{(static_cast<float>(i) + 0.5f) / kSide, (static_cast<float>(j) + 0.5f) / kSide};
      if (!shot.face.model.is_on_surface(uv)) continue;
      ++inside;
      strange += texture.at(i, j)[2] > texture.at(i, j)[0];
    }
  CHECK(strange == 0);
  CHECK(inside > kSide * kSide / 2);
}

TEST_CASE("a photograph without colour, or a tiny one, gives a texture") {
  Shot shot({0, 0, 0});
  for (int y = 0; y < 400; ++y)
    for (int x = 0; x < 400; ++x) shot.put(x, y, {100, 100, 100});
  const Image grey = shot.texture();
  for (const char* name : {"ibug00", "ibug16", "ibug08", "ibug30", "ibug21"})
    CHECK(std::abs(texel(grey, shot.face.uv(name))[1] - 100) <= 1);
  shot.fit.pose.t.x = 5000;  // beside the picture
  shot.photo = Image(1, 1, 3, 77);
  CHECK(shot.texture().pixels.size() == 3u * kSide * kSide);
}

TEST_CASE("fit --texture writes the face with its photograph, and animate --image moves it") {
  const Folder f;
  Shot shot({0, 0.1f, 0});
  const auto* bytes = reinterpret_cast<const char*>(shot.face.words.data());
  const std::string model = f.put("face.plm", std::string(bytes, shot.face.model.table_bytes()));
  const std::string photo = f.put("photo.png", encode_png(shot.photo));
  for (const Parameter& p : shot.face.model.parameters()) shot.fit.parameters.emplace_back(p.name, 0.0f);
  shot.fit.parameters[0].second = 1;
  const std::string pose = f.put("pose.json", fit_text(shot.fit));
  const std::vector<std::string> words{"fit", model,          "--pose",    pose,
                                       "-o",  f / "fit.json", "--texture", f / "face.glb"};
  CHECK(run_words(words).code == 2);  // no picture to take it from
  auto all = words;
  all.insert(all.end(), {"--image", photo});
  REQUIRE(run_words(all).code == 0);
  const std::string file = read_file(f / "face.glb");
  const Glb glb(file);
  const Parsed mesh = parse_glb(file);
  CHECK(mesh.position.size() > 3000);
  auto q = shot.q;
  q[0] = 1;
  for (std::size_t v = 0; v < mesh.position.size(); v += 11)
    CHECK(length(mesh.position[v] - shot.face.at(mesh.uv[v], q)) < 1e-3f);
  const std::string jpeg = glb.view(Glb::number(glb.at("images", 0), "bufferView"));
  CHECK(glb.at("images", 0).at("mimeType").get<std::string>() == "image/jpeg");
  CHECK(glb.at("materials", 0).at("extensions").contains("KHR_materials_unlit"));
  const Image texture = read_image(f.put("t.jpg", jpeg));
  CHECK(texture.width == kPhotoTextureSide);

  const std::string params = f.put("t.csv", "frame,jawOpen\n0,0\n1,0.3\n");
  std::vector<std::string> animate{"animate", model, "--params", params, "-o", f / "a.glb", "--image", photo};
  CHECK(run_words(animate).code == 2);  // whose picture?
  animate.insert(animate.end(), {"--identity", f / "fit.json"});
  REQUIRE(run_words(animate).code == 0);
  const Glb moving(read_file(f / "a.glb"));
  CHECK(moving.view(Glb::number(moving.at("images", 0), "bufferView")) == jpeg);
  animate[7] = f.put("small.png", encode_png(Image(40, 40, 3)));
  check_refused(animate, {"small.png", "not the picture of", "400x400"});
}

}  // namespace photo_texture_test
