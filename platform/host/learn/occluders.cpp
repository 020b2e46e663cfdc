#include "host/learn/occluders.hpp"

#include <algorithm>
#include <cmath>

#include "host/io/ibug_names.hpp"
#include "host/learn/painting.hpp"

namespace pliant::host::learn {

namespace {

constexpr float kTurn = 6.2831853f;

float dot_of_normals(Vec2 a, Vec2 b) {
  return a.x * b.y - a.y * b.x;
}

/// What a drawing needs of the sample.
class Canvas {
 public:
  Canvas(FaceSample& sample, const Model& model, const std::vector<Vec3>& landmarks_mm, SampleRandom& random)
      : sample_(sample),
        model_(model),
        mm_(landmarks_mm),
        random_(random),
        projector_(view_of(sample.pose, sample.camera), true) {
    scale_ = sample.box.side / kFaceBoxMm;
    measure_skin();
  }

  SampleRandom& random() { return random_; }
  const Image& picture() const { return sample_.picture; }
  float px(float mm) const { return mm * scale_; }
  float skin() const { return skin_; }
  Vec2 landmark(int k) const { return sample_.landmarks[number(k)]; }
  Vec3 landmark_mm(int k) const { return mm_[number(k)]; }
  Vec2 project(Vec3 p) const {
    Vec2 x;
    (void)projector_.project(p, &x);
    return x;
  }
  /// A place given in sides of the face box from its middle.
  Vec2 place(Vec2 from_middle) const { return sample_.box.center + sample_.box.side * from_middle; }

  /// Blends `grey(x)` in where `outside(x)` is negative, which is within `bounds`. Landmarks inside by more than a pixel are
  /// hidden if the opacity is above a half.
  template <class Outside, class Grey>
  void paint(const PaintBounds& bounds, const Outside& outside, const Grey& grey, float opacity,
             float softness = 1) {
    learn::paint(sample_.picture, bounds, outside, grey, opacity, softness);
    for (std::size_t k = 0; opacity > 0.5f && k < sample_.landmarks.size(); ++k)
      if (outside(sample_.landmarks[k]) < -1) sample_.trust[k] = kTrustNone;
  }

 private:
  std::size_t number(int k) const {
    return model_.find_landmark(ibug_name(k).c_str());
  }
  void measure_skin() {
    float sum = 0, count = 0;
    for (const int k : {29, 30, 31, 35}) {
      const Vec2 x = landmark(k);
      if (!sample_.picture.contains(static_cast<int>(x.x), static_cast<int>(x.y)) || x.x < 0 || x.y < 0)
        continue;
      sum += static_cast<float>(*sample_.picture.at(static_cast<int>(x.x), static_cast<int>(x.y))),
          count += 1;
    }
    skin_ = count > 0 ? sum / count : 128;
  }

  FaceSample& sample_;
  const Model& model_;
  const std::vector<Vec3>& mm_;
  SampleRandom& random_;
  Projector projector_;
  float scale_ = 1, skin_ = 128;
};

/// Rim of one glass in the model: a rounded rectangle before the eye.
std::vector<Vec3> rim(Vec3 middle, float half_width, float half_height, float squareness, float wrap) {
  std::vector<Vec3> out;
  for (int k = 0; k < 20; ++k) {
    const float angle = kTurn * static_cast<float>(k) / 20, c = std::cos(angle), s = std::sin(angle);
    const auto rounded = [&](float v) { return std::copysign(std::pow(std::fabs(v), squareness), v); };
    const Vec3 p{middle.x + half_width * rounded(c), middle.y + half_height * rounded(s), middle.z};
    out.push_back({p.x, p.y, p.z - wrap * p.x * p.x});
  }
  return out;
}

struct Glasses {
  bool is_dark = false;
  Vec3 right, left;                                             // middles of the eyes, mm
  float half_width = 0, half_height = 0, lower = 0, front = 0;  // mm
  float thickness = 0;                                          // of the frame, px
  std::vector<std::vector<Vec2>> rims;                          // right, left; px
};

Glasses choose_glasses(Canvas& canvas) {
  SampleRandom& random = canvas.random();
  Glasses g;
  g.is_dark = random.chance(0.35f);
  g.right = 0.5f * (canvas.landmark_mm(36) + canvas.landmark_mm(39));
  g.left = 0.5f * (canvas.landmark_mm(42) + canvas.landmark_mm(45));
  const float apart = 0.5f * length(g.left - g.right);
  g.half_width = apart * random.between(0.68f, 0.88f);
  g.half_height = g.half_width * random.between(0.55f, 0.95f);
  const float ahead = random.between(8, 14);
  g.lower = random.between(-1, 7);
  const float wrap = random.between(0, 0.004f), squareness = random.between(0.5f, 1);
  g.thickness = max(canvas.px(random.between(1, 4)), 0.7f);
  g.front = max(canvas.landmark_mm(27).z, max(g.right.z, g.left.z)) + ahead * 0.3f;
  for (const Vec3 eye : {g.right, g.left}) {
    std::vector<Vec2> outline;
    const Vec3 middle{eye.x, eye.y - g.lower, g.front + 2};
    for (const Vec3 p : rim(middle, g.half_width, g.half_height, squareness, wrap))
      outline.push_back(canvas.project(p));
    g.rims.push_back(outline);
  }
  return g;
}

void paint_lenses(Canvas& canvas, const Glasses& g) {
  SampleRandom& random = canvas.random();
  const float dark = random.between(5, 60),
              tint = g.is_dark ? random.between(0.55f, 1) : random.between(0, 0.15f);
  const float shine = random.chance(0.3f) ? random.between(30, 140) : 0, slope = random.between(-1, 1);
  for (const auto& outline : g.rims) {
    const Vec2 middle = 0.5f * (outline[0] + outline[10]);
    const auto glass = [&](Vec2 x) { return outside_polygon(x, outline); };
    const auto tone = [&](Vec2 x) {
      const float d = (x.x - middle.x) * slope + (x.y - middle.y);
      return dark + shine * clamp(0.5f - d / canvas.px(18), 0, 1);
    };
    canvas.paint({outline, 1}, glass, tone, tint);
  }
}

/// Rims, bridge and temples.
void paint_frame(Canvas& canvas, const Glasses& g) {
  SampleRandom& random = canvas.random();
  const float frame = random.chance(0.75f) ? random.between(5, 70) : random.between(120, 230);
  const auto line = [&](Vec2 a, Vec2 b) {
    canvas.paint(
        {{a, b}, g.thickness}, [&](Vec2 x) { return outside_capsule(x, a, b, 0.5f * g.thickness); },
        [&](Vec2) { return frame; }, 0.9f);
  };
  if (!g.is_dark || random.chance(0.7f))
    for (const auto& outline : g.rims)
      canvas.paint(
          {outline, g.thickness},
          [&](Vec2 x) { return magnitude(outside_polygon(x, outline)) - 0.5f * g.thickness; },
          [&](Vec2) { return frame; }, 0.9f);
  line(g.rims[0][0], g.rims[1][10]);
  // Temples back to the ears; the far one is hidden by the head.
  const float height = 0.3f * g.half_height;
  const Vec3 hinge_right{g.right.x - g.half_width, g.right.y - g.lower + height, g.front - 4},
      hinge_left{g.left.x + g.half_width, g.left.y - g.lower + height, g.front - 4};
  for (const Vec3 hinge : {hinge_right, hinge_left}) {
    const Vec3 ear{hinge.x * 1.12f, hinge.y, hinge.z - 75};
    const Vec2 a = canvas.project(hinge), b = canvas.project(ear);
    if ((b.x - a.x) * (hinge.x > 0 ? 1 : -1) > 0) line(a, b);
  }
}

void add_glasses(Canvas& canvas) {
  const Glasses glasses = choose_glasses(canvas);
  paint_lenses(canvas, glasses);
  paint_frame(canvas, glasses);
}

void add_mask(Canvas& canvas) {
  SampleRandom& random = canvas.random();
  std::vector<Vec2> outline;
  for (const int k : {2, 4, 6, 8, 10, 12, 14}) outline.push_back(canvas.landmark(k));
  const int top = random.chance(0.7f) ? 28 : 30;
  outline.push_back(canvas.landmark(top));
  const float tone = random.between(20, 240), fold = random.between(0.1f, 0.3f),
              wave = canvas.px(random.between(5, 12));
  const Vec2 along = canvas.landmark(8) - canvas.landmark(27), unit = 1 / max(length(along), 1.0f) * along;
  canvas.paint(
      {outline, canvas.px(2)}, [&](Vec2 x) { return outside_polygon(x, outline) - canvas.px(2); },
      [&](Vec2 x) { return tone * (1 - fold * (0.5f + 0.5f * std::sin(dot(x, unit) / wave * 3))); }, 1);
}

void add_hand(Canvas& canvas) {
  SampleRandom& random = canvas.random();
  const Vec2 tip = canvas.place({random.between(-0.5f, 0.5f), random.between(-0.2f, 0.6f)});
  // From the side that is nearer, or from below.
  const float angle =
      tip.x < canvas.place({0, 0}).x ? random.between(1.7f, 3.3f) : random.between(-0.2f, 1.5f);
  const Vec2 away{std::cos(angle), std::sin(angle)}, across{-away.y, away.x};
  const int fingers = 1 + static_cast<int>(random.below(4));
  const float radius = canvas.px(random.between(7, 10)),
              tone = clamp(canvas.skin() * random.between(0.75f, 1.2f), 15, 250);
  for (int k = 0; k < fingers; ++k) {
    const Vec2 a =
        tip + (1.9f * radius * static_cast<float>(k)) * across + random.between(-0.6f, 1.2f) * radius * away;
    const Vec2 b =
        a + canvas.px(random.between(55, 75)) * away - (0.3f * radius * static_cast<float>(k)) * across;
    canvas.paint(
        {{a, b}, radius}, [&](Vec2 x) { return outside_capsule(x, a, b, radius); },
        [&](Vec2 x) {
          const float d = dot(x - a, across) / radius;
          return tone * (1 - 0.35f * d * d - 0.1f * d);
        },
        1);
  }
  if (!random.chance(0.7f)) return;
  const Vec2 palm = tip + canvas.px(75) * away + (0.95f * radius * static_cast<float>(fingers - 1)) * across;
  canvas.paint(
      {{palm, palm + canvas.px(80) * away}, canvas.px(36)},
      [&](Vec2 x) { return outside_capsule(x, palm, palm + canvas.px(80) * away, canvas.px(36)); },
      [&](Vec2 x) { return tone * (0.95f - 0.1f * dot(x - palm, across) / canvas.px(36)); }, 1, canvas.px(3));
}

void add_hair(Canvas& canvas) {
  SampleRandom& random = canvas.random();
  const float tone = random.chance(0.8f) ? random.between(5, 90) : random.between(120, 220);
  const Vec2 up = canvas.landmark(27) - canvas.landmark(8);
  const Vec2 root = canvas.landmark(27) + 0.85f * up;
  const int strands = 4 + static_cast<int>(random.below(14));
  const float lean = random.between(-0.5f, 0.5f), longest = random.between(0.4f, 1.1f);
  const Vec2 right = canvas.landmark(45) - canvas.landmark(36);
  const float side = random.between(-0.9f, 0.9f), spread = random.between(0.2f, 0.7f);
  for (int k = 0; k < strands; ++k) {
    const float at = side + spread * random.between(-1, 1);
    const Vec2 a = root + at * right;
    const float reach = longest * random.between(0.5f, 1), aside = lean + random.between(-0.1f, 0.1f);
    const Vec2 b = a - reach * up + aside * right;
    const float width = canvas.px(random.between(1, 6)), shade = tone * random.between(0.7f, 1.2f);
    canvas.paint(
        {{a, b}, width}, [&](Vec2 x) { return outside_capsule(x, a, b, 0.5f * width); },
        [&](Vec2) { return shade; }, random.between(0.4f, 0.9f));
  }
}

void add_beard(Canvas& canvas) {
  SampleRandom& random = canvas.random();
  const float tone = random.between(5, 80), opacity = random.between(0.3f, 0.85f),
              grain = random.between(0.2f, 0.6f);
  const bool has_chin = random.chance(0.6f), has_lip = !has_chin || random.chance(0.7f);
  const Vec2 corner_right = canvas.landmark(48), corner_left = canvas.landmark(54),
             nose = canvas.landmark(33), lip = canvas.landmark(51), low_lip = canvas.landmark(57),
             chin = canvas.landmark(8);
  const auto hairs = [&](Vec2 x) {
    const auto column = static_cast<std::uint32_t>(static_cast<int>(x.x * 1.3f)),
               row = static_cast<std::uint32_t>(static_cast<int>(x.y * 0.8f));
    const std::uint32_t bits = column * 73856093u ^ row * 19349663u;
    return tone * (1 + grain * (static_cast<float>(bits * 2654435761u >> 24) / 128 - 1));
  };
  if (has_lip) {
    const std::vector<Vec2> outline{corner_right,
                                    canvas.landmark(49),
                                    lip,
                                    canvas.landmark(53),
                                    corner_left,
                                    nose + 0.25f * (corner_left - nose),
                                    nose + 0.3f * (lip - nose),
                                    nose + 0.25f * (corner_right - nose)};
    canvas.paint(
        {outline, canvas.px(4)}, [&](Vec2 x) { return outside_polygon(x, outline) - canvas.px(1); }, hairs,
        min(opacity, 0.5f) + 0.3f, canvas.px(4));
  }
  if (!has_chin) return;
  std::vector<Vec2> outline;
  if (random.chance(0.5f)) {
    for (const int k : {1, 3, 5, 7, 8, 9, 11, 13, 15}) outline.push_back(canvas.landmark(k));
    for (const int k : {54, 55, 57, 59, 48}) outline.push_back(canvas.landmark(k) + 0.2f * (chin - low_lip));
  } else {
    outline = {canvas.landmark(6), chin, canvas.landmark(10), corner_left, low_lip + 0.3f * (chin - low_lip),
               corner_right};
  }
  canvas.paint(
      {outline, canvas.px(8)}, [&](Vec2 x) { return outside_polygon(x, outline); }, hairs, opacity,
      canvas.px(8));
}

void add_bar(Canvas& canvas, const OtherPictures& others) {
  SampleRandom& random = canvas.random();
  const Vec2 middle = canvas.place({random.between(-0.7f, 0.7f), random.between(-0.6f, 0.7f)});
  const float angle = random.between(0, kTurn), half = canvas.px(random.octaves_between(6, 30)),
              reach = canvas.px(random.octaves_between(20, 250)), tone = random.between(0, 255);
  const Vec2 along{std::cos(angle), std::sin(angle)};
  const auto outside = [&](Vec2 x) {
    const Vec2 d = x - middle;
    return max(magnitude(dot(d, along)) - reach, magnitude(dot_of_normals(along, d)) - half);
  };
  if (others.count() > 0 && random.chance(0.5f)) {
    const Image other = others.crop(canvas.picture().width, canvas.picture().height, random);
    canvas.paint(
        {{middle}, reach + half}, outside,
        [&](Vec2 x) {
          const int i = std::clamp(static_cast<int>(x.x), 0, other.width - 1),
                    j = std::clamp(static_cast<int>(x.y), 0, other.height - 1);
          return static_cast<float>(*other.at(i, j));
        },
        1);
  } else {
    const float slope = random.between(-0.5f, 0.5f);
    canvas.paint(
        {{middle}, reach + half}, outside,
        [&](Vec2 x) { return clamp(tone * (1 + slope * dot_of_normals(along, x - middle) / half), 0, 255); },
        1);
  }
}

}  // namespace

void add_occluders(FaceSample& sample, const Model& model, const std::vector<Vec3>& landmarks_mm,
                   const OtherPictures& others, const OccluderTuning& tuning, SampleRandom& random) {
  const bool has_glasses = random.chance(tuning.glasses_chance), has_mask = random.chance(tuning.mask_chance),
             has_hand = random.chance(tuning.hand_chance), has_hair = random.chance(tuning.hair_chance),
             has_bar = random.chance(tuning.bar_chance), has_beard = random.chance(tuning.moustache_chance);
  if (!has_glasses && !has_mask && !has_hand && !has_hair && !has_bar && !has_beard) return;
  Canvas canvas(sample, model, landmarks_mm, random);
  if (has_beard) add_beard(canvas);
  if (has_mask) add_mask(canvas);
  if (has_glasses) add_glasses(canvas);
  if (has_hair) add_hair(canvas);
  if (has_hand) add_hand(canvas);
  if (has_bar) add_bar(canvas, others);
}

}  // namespace pliant::host::learn
