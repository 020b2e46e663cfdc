#include "host/learn/drawn_portraits.hpp"

#include <cmath>

#include "host/io/owned.hpp"
#include "host/learn/expression_variation.hpp"
#include "host/learn/painting.hpp"
#include "host/learn/sample_view.hpp"
#include "host/learn/texture_raster.hpp"
#include "host/render/scene.hpp"

namespace pliant::host::learn {

namespace {

constexpr int kSide = 320, kSamples = 2;
/// Of the face box, as in most official portraits, px.
constexpr float kBoxSide = 125;
constexpr float kDistanceMm = 1500;

/// Greys of a person and of the clothes.
struct Tones {
  float skin, hair, clothes;
  explicit Tones(SampleRandom& random)
      : skin(random.between(0.35f, 1.15f)),
        hair(random.chance(0.75f) ? random.between(10, 90) : random.between(110, 220)),
        clothes(random.chance(0.6f) ? random.between(10, 70) : random.between(70, 230)) {}
};

/// One portrait in the making.
class Portrait {
 public:
  Portrait(const Model& model, const FaceSheet& sheet, Cascade& cascade, const DrawnTurn& most_turned,
           Photograph& out, SampleRandom& random)
      : sheet_(sheet), cascade_(cascade), out_(out), random_(random), tones_(random) {
    FacePlacement placement;
    placement.picture_px = kSide;
    placement.box = {{0.5f * kSide + random.between(-10, 10), 0.5f * kSide + random.between(-15, 10)},
                     kBoxSide};
    placement.distance_mm = kDistanceMm;
    const auto landmarks = sheet.landmarks(cascade, out.q.data());
    const float yaw = random.between(-most_turned.yaw, most_turned.yaw),
                pitch = random.between(-most_turned.pitch, most_turned.pitch),
                roll = random.between(-0.05f, 0.05f);
    place_face(model, landmarks, rotation_of(yaw, pitch, roll), placement, &out.camera, &out.pose);
    out.landmarks = projected(landmarks, out.pose, out.camera);
    out.trust.assign(landmarks.size(), kTrustAnnotated);
    const auto at = [&](const char* name) { return out.landmarks[model.find_landmark(name)]; };
    out.pupils = {{at("eye_right"), at("eye_left")}, {kTrustAnnotated, kTrustAnnotated}};
    chin_ = at("ibug08"), nose_ = at("ibug27");
    ear_right_ = at("ibug00"), ear_left_ = at("ibug16");
    width_ = length(ear_left_ - ear_right_);
    middle_ = 0.5f * (ear_right_ + ear_left_);
  }

  void draw(const ChartTexture& texture, const Image& background) {
    out_.picture = background;
    paint_behind();
    paint_face(texture);
    if (!random_.chance(0.08f)) paint_hairline();
  }

 private:
  /// Tone with strands or grain.
  float strand(Vec2 x, float tone, float along) const {
    const float v = std::sin(0.9f * x.x + along * x.y) + std::sin(2.3f * x.x - 0.7f * along * x.y + 1);
    return tone * (1 + 0.12f * v);
  }

  float skin() const { return 150 * tones_.skin; }

  /// What is around the face and below it, from the back to the front.
  void paint_behind() {
    const Vec2 crown = middle_ + Vec2{0, -0.35f * width_};
    if (random_.chance(0.4f)) paint_long_hair(crown);
    const Vec2 neck = chin_ + Vec2{0, 0.55f * width_};
    paint_neck(neck);
    paint_clothes(neck.y);
    paint_ears();
    paint_hair(crown);
    paint_skin_below_face();
  }

  void paint_long_hair(Vec2 crown) {
    const float low = random_.between(0.6f, 1.5f) * width_, half = random_.between(0.6f, 0.8f) * width_;
    const Vec2 end = crown + Vec2{0, low};
    paint(
        out_.picture, {{crown, end}, half}, [&](Vec2 x) { return outside_capsule(x, crown, end, half); },
        [&](Vec2 x) { return strand(x, 0.8f * tones_.hair, 0.2f); }, 1, 6);
  }

  void paint_neck(Vec2 neck) {
    const float w = width_;
    paint(
        out_.picture, {{middle_, neck}, 0.4f * w},
        [&](Vec2 x) { return outside_capsule(x, middle_, neck, 0.33f * w); },
        [&](Vec2 x) { return skin() * (0.75f - 0.2f * (x.x - neck.x) / w); }, 1, 3);
  }

  void paint_clothes(float neck_y) {
    const float w = width_;
    const Vec2 left = chin_ + Vec2{0.85f * w, 1.0f * w}, right = chin_ + Vec2{-0.85f * w, 1.0f * w};
    const float shoulder = 0.5f * w, open = random_.between(0.1f, 0.5f) * w;
    paint(
        out_.picture, {{left, right, {left.x, 2.0f * kSide}}, shoulder},
        [&](Vec2 x) {
          const float cloth =
              min(outside_capsule(x, right, left, shoulder),
                  x.y > left.y ? outside_capsule(x, {right.x, x.y}, {left.x, x.y}, shoulder) : 1e9f);
          const float collar = open * (1 - (x.y - neck_y) / (0.8f * w)) - magnitude(x.x - chin_.x);
          return max(cloth, collar);
        },
        [&](Vec2 x) { return tones_.clothes * (1 + 0.1f * std::sin(0.05f * x.x + 0.08f * x.y)); }, 1, 2);
  }

  void paint_ears() {
    const float w = width_;
    for (const Vec2 ear : {ear_right_, ear_left_})
      paint(
          out_.picture, {{ear}, 0.2f * w},
          [&](Vec2 x) {
            return outside_ellipse(x, ear + Vec2{0, 0.08f * w}, {0.09f * w, 0.17f * w});
          },
          [&](Vec2) { return 0.85f * skin(); }, 1, 2);
  }

  void paint_hair(Vec2 crown) {
    const float w = width_, bulk = random_.between(0.5f, 0.62f);
    paint(
        out_.picture, {{crown}, w},
        [&](Vec2 x) {
          return outside_ellipse(x, crown + Vec2{0, 0.1f * w}, {bulk * w, (bulk + 0.12f) * w});
        },
        [&](Vec2 x) { return strand(x, tones_.hair, 0.3f); }, 1, 5);
  }

  /// Should the face not reach its edge.
  void paint_skin_below_face() {
    const float w = width_;
    const Vec2 middle = 0.5f * (middle_ + chin_) + Vec2{0, -0.15f * w};
    paint(
        out_.picture, {{middle_, chin_}, w},
        [&](Vec2 x) {
          return outside_ellipse(x, middle, {0.44f * w, 0.62f * w});
        },
        [&](Vec2) { return 0.8f * skin(); }, 1, 4);
  }

  void paint_face(const ChartTexture& texture) {
    const std::vector<Vec3> positions = sheet_.positions(cascade_, out_.q.data());
    const std::vector<Vec3> normals = sheet_.normals(positions);
    const Projector projector(view_of(out_.pose, out_.camera), true);
    const Vec3 key = normalised(Vec3{random_.between(-0.8f, 0.8f), random_.between(-0.9f, 0.2f), -1});
    const float ambient = random_.between(0.35f, 0.8f);
    std::vector<TextureVertex> vertices(positions.size());
    for (std::size_t k = 0; k < positions.size(); ++k) {
      if (!projector.project(positions[k], &vertices[k].x)) continue;
      vertices[k].inverse_depth = 1 / projector.to_camera(positions[k]).z;
      vertices[k].texture = sheet_.uv[k];
      vertices[k].light = ambient + (1 - ambient) * max(0, dot(projector.rotated(normals[k]), key) + 0.2f);
    }
    TextureRaster raster(kSide, kSide, kSamples);
    raster.clear();
    raster.draw(vertices, sheet_.triangles);
    const float spots = random_.between(0, 0.12f), phase = random_.between(0, 100);
    TextureFragment fragment{};
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) {
        float sum = 0;
        for (int j = y * kSamples; j < (y + 1) * kSamples; ++j)
          for (int i = x * kSamples; i < (x + 1) * kSamples; ++i) {
            if (!raster.fragment(i, j, &fragment)) {
              sum += static_cast<float>(*out_.picture.at(x, y));
              continue;
            }
            const Vec2 uv = fragment.texture;
            const float albedo = texture.albedo(uv);
            const float blotch = 1 + spots * std::sin(37 * uv.x + phase) * std::sin(41 * uv.y + 2 * phase);
            // Eyes and teeth do not take the tone of the skin.
            const float tone =
                fragment.part == FacePart::skin ? tones_.skin : 0.5f * (1 + min(tones_.skin, 1));
            sum += clamp(albedo * tone * blotch * fragment.light, 0, 255);
          }
        *out_.picture.at(x, y) = static_cast<std::uint8_t>(sum / (kSamples * kSamples) + 0.5f);
      }
  }

  void paint_hairline() {
    const float w = width_, forehead = random_.between(0.42f, 0.66f) * w,
                part = random_.between(-0.3f, 0.3f) * w;
    const float sides = random_.between(0.36f, 0.46f) * w, fringe = random_.between(0, 0.08f) * w;
    const Vec2 crown = middle_ + Vec2{0, -0.25f * w};
    paint(
        out_.picture, {{crown}, 1.2f * w},
        [&](Vec2 x) {
          const float head = outside_ellipse(x, crown, {0.56f * w, 0.7f * w});
          const float dx = x.x - nose_.x;
          const float line = nose_.y - forehead + 0.9f * (dx / sides) * (dx / sides) * 0.25f * w +
                             fringe * std::sin((dx + part) * 0.25f);
          const float above = x.y - line;
          return max(max(head, above), x.y - nose_.y - 0.2f * w);
        },
        [&](Vec2 x) { return strand(x, tones_.hair, 0.4f); }, 1, 4);
  }

  const FaceSheet& sheet_;
  Cascade& cascade_;
  Photograph& out_;
  SampleRandom& random_;
  Tones tones_;
  Vec2 chin_, nose_, ear_right_, ear_left_, middle_;
  float width_ = 1;
};

}  // namespace

std::vector<Photograph> draw_portraits(const Model& model, const FaceSheet& sheet,
                                       const OtherPictures& others, std::size_t count, std::uint64_t seed,
                                       int first_person, const DrawnTurn& most_turned) {
  const ExpressionVariation people(model);
  const ChartTexture texture(model);
  Owned<Cascade> cascade(model);
  std::vector<Photograph> portraits(count);
  for (std::size_t k = 0; k < count; ++k) {
    SampleRandom random(seed, k);
    Photograph& portrait = portraits[k];
    portrait.name = "drawn-" + std::to_string(k);
    portrait.person = first_person + static_cast<int>(k);
    portrait.q = people.random_face(random);
    const bool is_plain = others.count() == 0 || random.chance(0.4f);
    const Image background = is_plain
                                 ? make_background(kSide, kSide, static_cast<std::uint32_t>(random.bits()))
                                 : others.crop(kSide, kSide, random);
    Portrait(model, sheet, *cascade, most_turned, portrait, random).draw(texture, background);
  }
  return portraits;
}

}  // namespace pliant::host::learn
