// The built-in face: is it a face, do its expressions do what their names say, and nothing else?
#include <doctest/doctest.h>

#include <algorithm>

#include "aligned_block.hpp"
#include "baked_face.hpp"
#include "pliant/mesh.hpp"
#include "random.hpp"

namespace face_test {

using namespace pliant;

namespace {

float apart(BakedModel& face, const char* a, const char* b, const std::vector<float>& q) {
  return length(face.at(a, q) - face.at(b, q));
}

/// Unit normal out of the face at (u,v).
Vec3 normal(BakedModel& face, Vec2 uv, const std::vector<float>& q) {
  const SurfaceFrame f = face.cascade.surface_frame(uv, q.data());
  return normalised(cross(f.pv, f.pu));
}

/// Places on the surface at least `margin` away from its boundary (in u and v).
std::vector<Vec2> places_on_skin(const Model& model, int side, float margin) {
  std::vector<Vec2> places;
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) {
      const Vec2 p{(static_cast<float>(i) + 0.5f) / static_cast<float>(side),
                   (static_cast<float>(j) + 0.5f) / static_cast<float>(side)};
      bool inside = true;
      for (int dj = -1; dj <= 1; ++dj)
        for (int di = -1; di <= 1; ++di)
          inside &= model.is_on_surface(
              {p.x + margin * static_cast<float>(di), p.y + margin * static_cast<float>(dj)});
      if (inside) places.push_back(p);
    }
  return places;
}

/// "what: a b", for messages.
template <class... Numbers>
std::string note(const std::string& what, Numbers... numbers) {
  std::string text = what + ":";
  ((text += " " + std::to_string(numbers)), ...);
  return text;
}

std::string ibug(int k) {
  return std::string("ibug") + (k < 10 ? "0" : "") + std::to_string(k);
}

}  // namespace

TEST_CASE("the table has the 68 landmarks, the five landmarks and the curves that trackers use") {
  const Model& model = baked_face().model;
  for (int k = 0; k < 68; ++k) CHECK_MESSAGE(model.find_landmark(ibug(k).c_str()) != kNone, k);
  for (const char* name : {"eye_right", "eye_left", "nose_tip", "mouth_right", "mouth_left"})
    CHECK_MESSAGE(model.find_landmark(name) != kNone, std::string(name));
  int kinds[4] = {};
  for (const Curve& c : model.curves()) ++kinds[static_cast<int>(c.kind)];
  CHECK(kinds[0] == 4);
  CHECK(kinds[1] == 4);
  CHECK(kinds[2] == 2);
  CHECK(kinds[3] == 1);
}

TEST_CASE("the face at rest is its own mirror image") {
  BakedModel& face = baked_face();
  Random random(1);
  const auto q = face.rest();
  float worst = 0;
  for (int k = 0; k < 2000; ++k) {
    const Vec2 uv{random.uniform(0, 1), random.uniform(0, 1)};
    const Vec3 p = face.at(uv, q), m = face.at(Vec2{1 - uv.x, uv.y}, q);
    worst = max(worst, length(p - Vec3{-m.x, m.y, m.z}));
  }
  CHECK(worst < 0.02f);
}

TEST_CASE("left and right parameters are mirror images of each other") {
  BakedModel& face = baked_face();
  Random random(2);
  for (const Parameter& p : face.model.parameters()) {
    const std::string left = p.name;
    if (left.size() < 5 || left.compare(left.size() - 4, 4, "Left") != 0) continue;
    const auto ql = face.posed(left), qr = face.posed(left.substr(0, left.size() - 4) + "Right");
    float worst = 0;
    for (int k = 0; k < 200; ++k) {
      const Vec2 uv{random.uniform(0, 1), random.uniform(0, 1)};
      const Vec3 a = face.at(uv, ql), b = face.at(Vec2{1 - uv.x, uv.y}, qr);
      worst = max(worst, length(a - Vec3{-b.x, b.y, b.z}));
    }
    CHECK_MESSAGE(worst < 0.02f, left);
  }
}

TEST_CASE("distances at rest are within one and a half standard deviations of published means") {
  // Young adults of European descent, mean of women's and men's means, standard deviation with half their
  // difference (Farkas 1994).
  BakedModel& face = baked_face();
  const auto q = face.rest();
  const auto within = [&](const char* what, float distance, float mean, float sd) {
    CHECK_MESSAGE(distance > mean - 1.5f * sd, note(what, distance));
    CHECK_MESSAGE(distance < mean + 1.5f * sd, note(what, distance));
  };
  within("between the inner corners of the eyes", apart(face, "ibug39", "ibug42", q), 32.5f, 2.4f);
  within("between the outer corners", apart(face, "ibug36", "ibug45", q), 89.4f, 3.6f);
  within("length of the fissure", apart(face, "ibug42", "ibug45", q), 31.0f, 1.4f);
  within("width of the mouth", apart(face, "ibug48", "ibug54", q), 52.0f, 3.5f);
  within("nose, root to base", apart(face, "ibug27", "ibug33", q), 52.7f, 3.6f);
  within("protrusion of the nose", apart(face, "ibug33", "nose_tip", q), 19.6f, 1.9f);
  within("nose's base to chin", apart(face, "ibug33", "ibug08", q), 68.5f, 5.5f);
  within("upper lip", apart(face, "ibug33", "ibug62", q), 21.0f, 2.0f);
  within("root of the nose to chin", apart(face, "ibug27", "ibug08", q), 118.0f, 6.5f);
  // The outline of the picture: the width at the cheeks (between the ears it is wider than the cheekbones).
  within("width at the nose's height", apart(face, "ibug02", "ibug14", q), 137.0f, 5.0f);
}

TEST_CASE("the origin is midway between the outer eye corners, with axes left, up and out") {
  BakedModel& face = baked_face();
  const auto q = face.rest();
  const Vec3 left = face.at("ibug45", q), right = face.at("ibug36", q);
  CHECK(length(left + right) < 0.5f);
  CHECK(left.x > 40);
  CHECK(face.at("ibug08", q).y < -100);
  CHECK(face.at("nose_tip", q).z > 35);
  CHECK(face.at("ibug00", q).z < -30);
  CHECK(face.uv("ibug45").x > 0.6f);  // u to the subject's left
  CHECK(face.uv("ibug08").y > 0.7f);  // v downwards
}

namespace {

/// A landmark that an expression moves at its maximum by at least `least` millimetres along an axis (0 x, 1
/// y, 2 z), or at most by it where it is negative.
struct Effect {
  const char* parameter;
  int landmark, axis;
  float least;
};

constexpr Effect kEffects[] = {
    {"jawOpen", 8, 1, -15},         {"jawOpen", 57, 1, -15},
    {"jawOpen", 66, 1, -15},        {"jawLeft", 8, 0, 4},
    {"jawRight", 8, 0, -4},         {"mouthSmileLeft", 54, 0, 4},
    {"mouthSmileLeft", 54, 1, 5},   {"mouthSmileRight", 48, 0, -4},
    {"mouthSmileRight", 48, 1, 5},  {"mouthStretchLeft", 54, 0, 6},
    {"mouthFrownLeft", 54, 1, -5},  {"mouthFrownRight", 48, 1, -5},
    {"mouthPucker", 54, 0, -6},     {"mouthPucker", 48, 0, 6},
    {"mouthPucker", 62, 2, 4},      {"mouthFunnel", 54, 0, -4},
    {"mouthFunnel", 62, 1, 2},      {"mouthFunnel", 66, 1, -3},
    {"mouthRollUpper", 51, 1, -2},  {"mouthRollLower", 57, 1, 2.5f},
    {"mouthPressLeft", 53, 1, -1},  {"mouthPressLeft", 55, 1, 1},
    {"mouthUpperUpLeft", 63, 1, 3}, {"mouthLowerDownLeft", 65, 1, -3},
    {"mouthLeft", 54, 0, 5},        {"mouthLeft", 48, 0, 5},
    {"mouthRight", 51, 0, -5},      {"mouthShrugLower", 57, 1, 2.5f},
    {"browInnerUpLeft", 22, 1, 4},  {"browInnerUpRight", 21, 1, 4},
    {"browOuterUpLeft", 25, 1, 4},  {"browDownLeft", 22, 1, -3},
    {"browDownLeft", 22, 0, -1},    {"eyeBlinkLeft", 43, 1, -6},
    {"eyeBlinkRight", 38, 1, -6},   {"eyeWideLeft", 43, 1, 1.2f},
    {"eyeSquintLeft", 46, 1, 1.2f}, {"noseSneerLeft", 35, 1, 1.5f},
};

}  // namespace

TEST_CASE("each expression moves the landmarks of its name") {
  BakedModel& face = baked_face();
  const auto rest = face.rest();
  for (const Effect& e : kEffects) {
    const Vec3 d = face.at(ibug(e.landmark), face.posed(e.parameter)) - face.at(ibug(e.landmark), rest);
    const float moved = e.axis == 0 ? d.x : e.axis == 1 ? d.y : d.z;
    if (e.least > 0)
      CHECK_MESSAGE(moved > e.least, note(e.parameter, e.landmark, moved));
    else
      CHECK_MESSAGE(moved < e.least, note(e.parameter, e.landmark, moved));
  }
  // The cheek has no landmark: half way between the corner of the mouth and the jaw.
  const Vec2 cheek = 0.5f * (face.uv("ibug54") + face.uv("ibug12"));
  const Vec3 puffed = face.at(cheek, face.posed("cheekPuffLeft")) - face.at(cheek, rest);
  CHECK(length(puffed) > 4);
  CHECK(dot(puffed, normal(face, cheek, rest)) > 3);
}

TEST_CASE("a blink closes the lids completely, in front of the eyeball") {
  BakedModel& face = baked_face();
  const auto closed = face.posed("eyeBlinkRight");
  CHECK(apart(face, "ibug37", "ibug41", closed) < 1.5f);
  CHECK(apart(face, "ibug38", "ibug40", closed) < 1.5f);
  CHECK(apart(face, "ibug37", "ibug41", face.rest()) > 7);
  // The eyeball's centre is a radius of 11.8 mm behind the middle of the pupil.
  const Vec3 centre = face.at("eye_right", face.rest()) - Vec3{0, 0, 11.8f};
  for (int step = 0; step <= 8; ++step) {
    const auto q = face.posed("eyeBlinkRight", static_cast<float>(step) / 8);
    for (const char* lid : {"ibug37", "ibug38"}) CHECK(length(face.at(lid, q) - centre) > 11.8f);
  }
}

TEST_CASE("an expression does not move points far from its muscle") {
  struct Still {
    const char* parameter;
    int first, last;
  };
  constexpr Still kStill[] = {
      {"jawOpen", 17, 30},
      {"jawOpen", 36, 47},
      {"jawOpen", 51, 51},
      {"mouthSmileLeft", 17, 27},
      {"mouthSmileLeft", 0, 5},
      {"mouthPucker", 0, 4},
      {"mouthPucker", 17, 27},
      {"browInnerUpLeft", 29, 35},
      {"browInnerUpLeft", 48, 67},
      {"browDownLeft", 48, 67},
      {"eyeBlinkLeft", 0, 25},
      {"eyeBlinkLeft", 36, 41},
      {"eyeBlinkLeft", 48, 67},
      {"eyeWideLeft", 36, 41},
      {"eyeSquintLeft", 36, 41},
      {"noseSneerLeft", 4, 12},
      {"cheekPuffLeft", 17, 27},
      {"mouthUpperUpLeft", 56, 59},
      {"mouthLowerDownLeft", 17, 27},
      {"mouthFrownRight", 17, 27},
  };
  BakedModel& face = baked_face();
  const auto rest = face.rest();
  for (const Still& s : kStill)
    for (int k = s.first; k <= s.last; ++k) {
      const Vec3 d = face.at(ibug(k), face.posed(s.parameter)) - face.at(ibug(k), rest);
      // Turning by nothing about a far axis rounds the last bits.
      const float rounding = std::string(s.parameter) == "jawOpen" ? 1e-5f : 0;
      CHECK_MESSAGE(length(d) <= rounding, note(s.parameter, k, length(d)));
    }
}

TEST_CASE(
    "every parameter moves the surface, and the standard deviation of an identity parameter is plausible") {
  BakedModel& face = baked_face();
  const auto places = places_on_skin(face.model, 40, 0);
  for (std::size_t k = 0; k < face.model.parameters().count; ++k) {
    const Parameter& p = face.model.parameters()[k];
    auto q = face.rest();
    q[k] = p.group == Group::identity ? p.sd : p.maximum;
    float most = 0;
    for (Vec2 uv : places) most = max(most, length(face.at(uv, q) - face.at(uv, face.rest())));
    CHECK_MESSAGE(most > 0.5f, note(p.name, most));
    CHECK_MESSAGE(most < (p.group == Group::identity ? 8.0f : 60.0f), note(p.name, most));
  }
}

TEST_CASE("fields are zero on the rim of their support, so that the surface has no steps") {
  const Model& model = baked_face().model;
  for (std::size_t k = 0; k < model.fields().count; ++k) {
    const Field& f = model.fields()[k];
    if (f.u0 == 0 && f.v0 == 0 && f.u1 == 1 && f.v1 == 1) continue;
    const auto value = [&](int i, int j, int c) {
      const std::uint8_t* p = model.samples() + f.first_byte;
      const int index = (j * f.width + i) * f.components + c;
      return f.bits == 16 ? static_cast<int>(reinterpret_cast<const std::int16_t*>(p)[index])
                          : static_cast<int>(reinterpret_cast<const std::int8_t*>(p)[index]);
    };
    bool zero = true;
    for (int c = 0; c < f.components; ++c) {
      zero &= f.offset[c] == 0;
      for (int i = 0; i < f.width; ++i) zero &= value(i, 0, c) == 0 && value(i, f.height - 1, c) == 0;
      for (int j = 0; j < f.height; ++j) zero &= value(0, j, c) == 0 && value(f.width - 1, j, c) == 0;
    }
    CHECK_MESSAGE(zero, k);
  }
}

TEST_CASE("no expression at its maximum causes a fold-over") {
  BakedModel& face = baked_face();
  const auto places = places_on_skin(face.model, 96, 0.008f);
  std::vector<Vec3> rest;
  for (Vec2 uv : places) rest.push_back(normal(face, uv, face.rest()));
  for (const Parameter& p : face.model.parameters()) {
    if (p.group != Group::expression) continue;
    const auto q = face.posed(p.name);
    int folded = 0;
    for (std::size_t k = 0; k < places.size(); ++k) folded += dot(normal(face, places[k], q), rest[k]) < 0;
    const double fraction = static_cast<double>(folded) / static_cast<double>(places.size());
    CHECK_MESSAGE(fraction < 0.002, note(p.name, folded, places.size()));
  }
}

TEST_CASE("two standard deviations of any identity parameter cause no fold-over") {
  BakedModel& face = baked_face();
  const auto places = places_on_skin(face.model, 64, 0.008f);
  std::vector<Vec3> rest;
  for (Vec2 uv : places) rest.push_back(normal(face, uv, face.rest()));
  for (std::size_t i = 0; i < face.model.parameters().count; ++i) {
    if (face.model.parameters()[i].group != Group::identity) continue;
    for (const float sign : {2.0f, -2.0f}) {
      auto q = face.rest();
      q[i] = sign;
      int folded = 0;
      for (std::size_t k = 0; k < places.size(); ++k)
        folded += dot(normal(face, places[k], q), rest[k]) < 0.3f;
      CHECK_MESSAGE(folded <= 2, note(face.model.parameters()[i].name, folded));
    }
  }
}

TEST_CASE("the base mesh consists of basic blocks and has a hole for each eye and the mouth") {
  const Model& model = baked_face().model;
  MeshLimits limits;
  limits.vertices = 2048;
  limits.faces = 4096;
  AlignedBlock block(measured_bytes<Mesh>(limits));
  Arena arena(block.data(), block.size());
  Mesh mesh;
  REQUIRE(create_in(arena, mesh, limits) == Status::ok);
  REQUIRE(mesh.set_base(model.base_uv(), model.base_corners()) == Status::ok);
  const MeshStatistics s = mesh.compute_statistics();
  CHECK(s.boundary_loops == 4);
  CHECK(s.euler == -2);
  CHECK(s.vertices > 300);
  CHECK(s.vertices < 700);
}

TEST_CASE(
    "the base mesh is its own mirror image, of nearly equal edges, and most landmarks are its vertices") {
  BakedModel& face = baked_face();
  const auto uv = face.model.base_uv();
  const auto corners = face.model.base_corners();
  const auto nearest = [&](Vec2 p) {
    float least = 1;
    for (Vec2 q : uv) least = min(least, length(p - q));
    return least;
  };
  for (Vec2 p : uv) CHECK(nearest({1 - p.x, p.y}) < 1e-5f);
  int landmarks = 0;
  for (int k = 0; k < 68; ++k) landmarks += nearest(face.uv(ibug(k))) < 0.004f;
  CHECK(landmarks > 50);
  std::vector<float> lengths;
  for (std::size_t f = 0; f < corners.count; f += 3)
    for (std::size_t k = 0; k < 3; ++k)
      lengths.push_back(length(face.at(uv[corners[f + k]], face.rest()) -
                               face.at(uv[corners[f + (k + 1) % 3]], face.rest())));
  std::sort(lengths.begin(), lengths.end());
  CHECK(lengths[lengths.size() * 95 / 100] < 4 * lengths[lengths.size() * 5 / 100]);
  CHECK(lengths.back() < 25);
}

TEST_CASE("base faces are counter-clockwise seen from outside, as the surface is") {
  BakedModel& face = baked_face();
  const auto q = face.rest();
  const auto uv = face.model.base_uv();
  const auto corners = face.model.base_corners();
  int wrong = 0;
  for (std::size_t f = 0; f < corners.count; f += 3) {
    const Vec2 a = uv[corners[f]], b = uv[corners[f + 1]], c = uv[corners[f + 2]];
    const Vec3 pa = face.at(a, q), n = cross(face.at(b, q) - pa, face.at(c, q) - pa);
    wrong += dot(n, normal(face, (1.0f / 3) * (a + b + c), q)) <= 0;
  }
  CHECK(wrong == 0);
}

TEST_CASE("the surface has enough texture for corners, and eyes, lips and brows have contrast") {
  BakedModel& face = baked_face();
  const ChartImage albedo = face.model.albedo();
  const auto tone = [&](Vec2 uv) {
    const auto i = static_cast<std::size_t>(uv.x * static_cast<float>(albedo.width - 1) + 0.5f);
    const auto j = static_cast<std::size_t>(uv.y * static_cast<float>(albedo.height - 1) + 0.5f);
    return static_cast<float>(albedo.pixels[j * albedo.width + i]);
  };
  const auto mean_around = [&](Vec2 uv, float radius) {
    float sum = 0;
    for (int j = -4; j <= 4; ++j)
      for (int i = -4; i <= 4; ++i)
        sum += tone({uv.x + radius * static_cast<float>(i) / 4, uv.y + radius * static_cast<float>(j) / 4});
    return sum / 81;
  };
  const float forehead = mean_around({0.5f, 0.12f}, 0.05f);
  CHECK(mean_around(face.uv("eye_left"), 0.005f) < 0.3f * forehead);
  CHECK(mean_around(face.uv("ibug24"), 0.01f) < 0.75f * forehead);
  CHECK(mean_around(0.5f * (face.uv("ibug51") + face.uv("ibug62")), 0.006f) < 0.85f * forehead);
  // Tone spreads by several grey levels within every patch of the cheeks and the forehead.
  for (const Vec2 centre :
       {Vec2{0.35f, 0.12f}, Vec2{0.65f, 0.12f}, Vec2{0.25f, 0.5f}, Vec2{0.75f, 0.5f}, Vec2{0.5f, 0.85f}}) {
    float sum = 0, squares = 0;
    for (int j = -10; j <= 10; ++j)
      for (int i = -10; i <= 10; ++i) {
        const float t =
            tone({centre.x + 0.004f * static_cast<float>(i), centre.y + 0.004f * static_cast<float>(j)});
        sum += t;
        squares += t * t;
      }
    const float mean = sum / 441, sd = square_root(squares / 441 - mean * mean);
    CHECK_MESSAGE(sd > 5, note("tone", centre.x, centre.y, sd));
  }
}

}  // namespace face_test
