#include "host/learn/face_samples.hpp"

#include <cmath>

namespace pliant::host::learn {

namespace {

constexpr float kRadian = 0.0174532925f;

/// x -> scale R(angle) (x - from) + to: how a photograph becomes a sample.
struct Similarity {
  float c, s;  // scale times cosine and sine
  Vec2 from, to;
  Vec2 operator()(Vec2 x) const {
    const Vec2 d = x - from;
    return to + Vec2{c * d.x - s * d.y, s * d.x + c * d.y};
  }
  Vec2 inverse(Vec2 x) const {
    const Vec2 d = x - to;
    const float n = 1 / (c * c + s * s);
    return from + Vec2{n * (c * d.x + s * d.y), n * (c * d.y - s * d.x)};
  }
};

/// More small values than large ones, either way: between -limit and limit.
float mostly_small(SampleRandom& random, float limit) {
  return limit * (random.unit() + random.unit() - 1);
}

/// How much of the photograph is shown at a position of it: 1 inside, 0 beyond a band along its border.
float cover(const Mipmap& photograph, Vec2 x, float band) {
  const float right = static_cast<float>(photograph.width() - 1) - x.x,
              low = static_cast<float>(photograph.height() - 1) - x.y;
  return clamp(min(min(x.x, right), min(x.y, low)) / band, 0, 1);
}

}  // namespace

FaceBox face_box_in(const Model& model, const std::vector<Vec2>& landmarks, const Pose& pose,
                    const Camera& camera) {
  const char* const names[] = {"ibug36", "ibug45", "ibug48", "ibug54"};
  Vec2 at[4];
  for (std::size_t k = 0; k < 4; ++k) {
    const std::uint16_t number = model.find_landmark(names[k]);
    if (number == kNone) return {};
    at[k] = landmarks[number];
  }
  return face_box_of(at[0], at[1], at[2], at[3], view_of(pose, camera).s);
}

FaceSamples::FaceSamples(const Model& model, const std::vector<Photograph>& photographs,
                         const OtherPictures& others, std::uint64_t seed, const FaceSampleTuning& tuning)
    : tuning_(tuning), seed_(seed), model_(model), photographs_(photographs), others_(others) {
  for (const Photograph& p : photographs) mipmaps_.emplace_back(p.picture);
}

FaceSamples::~FaceSamples() = default;

/// What surrounds a photograph that does not fill the sample: another picture, or none.
Image FaceSamples::surroundings(SampleRandom& random) const {
  if (others_.count() == 0 || random.chance(tuning_.smear_chance)) return {};
  return others_.crop(tuning_.side_px, tuning_.side_px, random);
}

FaceSample FaceSamples::draw(std::uint64_t index) const {
  SampleRandom random(seed_, index);
  FaceSample sample = draw_in_plane(random);
  vary_picture(sample.picture, sample.box, tuning_.variation, random);
  return sample;
}

FaceSample FaceSamples::draw_in_plane(SampleRandom& random) const {
  const std::size_t k = random.below(photographs_.size());
  const Photograph& photograph = photographs_[k];
  const FaceBox box = face_box_in(model_, photograph.landmarks, photograph.pose, photograph.camera);
  const float side = random.octaves_between(tuning_.box_low_px, tuning_.box_high_px), scale = side / box.side;
  const float roll = kRadian * mostly_small(random, tuning_.roll_degrees);
  const float room = 0.5f * (static_cast<float>(tuning_.side_px) - side) - tuning_.margin_px,
              middle = 0.5f * static_cast<float>(tuning_.side_px - 1);
  const Vec2 to{middle + random.between(-room, room), middle + random.between(-room, room)};
  const Similarity moved{scale * std::cos(roll), scale * std::sin(roll), box.center, to};

  FaceSample sample;
  sample.person = photograph.person;
  sample.q = photograph.q;
  sample.trust = photograph.trust;
  for (const Vec2 x : photograph.landmarks) sample.landmarks.push_back(moved(x));
  const Vec2 principal = moved({photograph.camera.cx, photograph.camera.cy});
  sample.camera = photograph.camera;
  sample.camera.f *= scale;
  sample.camera.cx = principal.x;
  sample.camera.cy = principal.y;
  const Quat turn{std::cos(0.5f * roll), 0, 0, std::sin(0.5f * roll)};
  sample.pose = {normalised(turn * photograph.pose.q), rotation_matrix(turn) * photograph.pose.t};
  sample.box = {to, side};

  const Mipmap& source = mipmaps_[k];
  const Mipmap::Detail detail = source.detail_for(1 / scale);
  const Image around = surroundings(random);
  const float band = random.between(1, 0.3f * box.side);
  sample.picture = Image(tuning_.side_px, tuning_.side_px, 1);
  for (int y = 0; y < tuning_.side_px; ++y)
    for (int x = 0; x < tuning_.side_px; ++x) {
      const Vec2 from = moved.inverse({static_cast<float>(x), static_cast<float>(y)});
      float value = source.at(from, detail);
      if (!around.pixels.empty()) {
        const float other = static_cast<float>(*around.at(x, y));
        value = other + cover(source, from, band) * (value - other);
      }
      *sample.picture.at(x, y) = static_cast<std::uint8_t>(value + 0.5f);
    }
  return sample;
}

}  // namespace pliant::host::learn
