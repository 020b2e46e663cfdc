#include "host/learn/face_samples.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "host/io/owned.hpp"
#include "host/learn/drawn_portraits.hpp"
#include "host/learn/photo_mesh.hpp"

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

/// The photograph out of focus, for where its surface ends.
Image smeared(const Mipmap& photograph, int side) {
  Image out(side, side, 1);
  const Mipmap::Detail detail = photograph.detail_for(static_cast<float>(photograph.width()) / 6);
  const Vec2 step{static_cast<float>(photograph.width()) / static_cast<float>(side),
                  static_cast<float>(photograph.height()) / static_cast<float>(side)};
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x)
      *out.at(x, y) = static_cast<std::uint8_t>(
          photograph.at({step.x * static_cast<float>(x), step.y * static_cast<float>(y)}, detail) + 0.5f);
  return out;
}

/// A light in front of the face, not straight ahead: direction times strength.
Vec3 random_light(SampleRandom& random) {
  const float strength = random.between(0.2f, 0.75f), around = random.between(0, 6.2831853f),
              rise = random.between(0.2f, 1.2f);
  return strength *
         Vec3{std::sin(rise) * std::cos(around), std::sin(rise) * std::sin(around), -std::cos(rise)};
}

/// How much of the photograph is shown at a position of it: 1 inside, 0 beyond a band along its border.
float cover(const Mipmap& photograph, Vec2 x, float band) {
  const float right = static_cast<float>(photograph.width() - 1) - x.x,
              low = static_cast<float>(photograph.height() - 1) - x.y;
  return clamp(min(min(x.x, right), min(x.y, low)) / band, 0, 1);
}

}  // namespace

/// What one thread needs to draw a sample.
struct FaceSamples::Workspace {
  Workspace(const Model& model, int side) : cascade(model), raster(side, side, kSamples) {}
  static constexpr int kSamples = 2;  // along each side of a pixel
  Owned<Cascade> cascade;
  TextureRaster raster;
};

struct FaceSamples::Parts {
  Parts(const Model& model, const ExpressionVariationTuning& tuning)
      : sheet(model, kSheetDepth), expressions(model, tuning) {}
  static constexpr int kSheetDepth = 2;
  FaceSheet sheet;
  ExpressionVariation expressions;
  std::vector<PhotoMesh> meshes;
  std::mutex mutex;
  std::vector<std::unique_ptr<Workspace>> idle;
};

FaceSamples::FaceSamples(const Model& model, const std::vector<Photograph>& photographs,
                         const OtherPictures& others, std::uint64_t seed, const FaceSampleTuning& tuning)
    : tuning_(tuning), seed_(seed), model_(model), photographs_(photographs), others_(others) {
  parts_ = std::make_unique<Parts>(model, tuning.expressions);
  if (photographs.empty() || tuning.drawn_fraction > 0) {
    int people = 0;
    for (const Photograph& p : photographs) people = std::max(people, p.person + 1);
    const std::size_t drawn = photographs.empty() ? tuning.drawn_people_alone : tuning.drawn_people;
    drawn_ = draw_portraits(model, parts_->sheet, others, std::max<std::size_t>(drawn, 1), seed, people,
                            tuning.drawn_turn);
  }
  Owned<Cascade> cascade(model);
  for (std::size_t k = 0; k < photographs.size() + drawn_.size(); ++k) {
    mipmaps_.emplace_back(photograph(k).picture);
    parts_->meshes.emplace_back(photograph(k), parts_->sheet, *cascade);
  }
}

FaceSamples::~FaceSamples() = default;

/// What surrounds a photograph that does not fill the sample: another picture, or none.
Image FaceSamples::surroundings(SampleRandom& random) const {
  if (others_.count() == 0 || random.chance(tuning_.smear_chance)) return {};
  return others_.crop(tuning_.side_px, tuning_.side_px, random);
}

FaceSample FaceSamples::draw(std::uint64_t index) const {
  SampleRandom random(seed_, index);
  std::unique_ptr<Workspace> workspace;
  {
    const std::lock_guard<std::mutex> lock(parts_->mutex);
    if (!parts_->idle.empty()) workspace = std::move(parts_->idle.back()), parts_->idle.pop_back();
  }
  if (workspace == nullptr) workspace = std::make_unique<Workspace>(model_, tuning_.side_px);
  FaceSample sample =
      random.chance(tuning_.turned_fraction) ? draw_turned(random, *workspace) : draw_in_plane(random);
  add_occluders(sample, model_, parts_->sheet.landmarks(*workspace->cascade, sample.q.data()), others_,
                tuning_.occluders, random);
  hide_pupils(sample);
  {
    const std::lock_guard<std::mutex> lock(parts_->mutex);
    parts_->idle.push_back(std::move(workspace));
  }
  vary_picture(sample.picture, sample.box, tuning_.variation, random);
  return sample;
}

/// A pupil is hidden where the middles of the lids are.
void FaceSamples::hide_pupils(FaceSample& sample) const {
  static const char* const kLids[2][2] = {{"ibug37", "ibug40"}, {"ibug44", "ibug47"}};
  for (const int side : {0, 1})
    for (const char* lid : kLids[side])
      if (const std::uint16_t k = model_.find_landmark(lid); k != kNone && sample.trust[k] == kTrustNone)
        sample.pupils.trust[side] = kTrustNone;
}

FaceSample FaceSamples::draw_in_plane(SampleRandom& random) const {
  const std::size_t k = random_photograph(random);
  const Photograph& photograph = this->photograph(k);
  const FaceBox box = face_box_in(model_, photograph.landmarks, photograph.pose, photograph.camera);
  const FacePlacement placement = random_placement(random);
  const float side = placement.box.side, scale = side / box.side;
  const float roll = kRadian * mostly_small(random, tuning_.roll_degrees);
  const Vec2 to = placement.box.center;
  const Similarity moved{scale * std::cos(roll), scale * std::sin(roll), box.center, to};

  FaceSample sample;
  sample.person = photograph.person;
  sample.q = photograph.q;
  sample.trust = photograph.trust;
  for (const Vec2 x : photograph.landmarks) sample.landmarks.push_back(moved(x));
  sample.pupils = photograph.pupils;
  for (Vec2& x : sample.pupils.x) x = moved(x);
  const Vec2 principal = moved({photograph.camera.cx, photograph.camera.cy});
  sample.camera = photograph.camera;
  sample.camera.f *= scale;
  sample.camera.cx = principal.x;
  sample.camera.cy = principal.y;
  const Quat turn = rotation_of(0, 0, roll);
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

std::size_t FaceSamples::random_photograph(SampleRandom& random) const {
  const bool is_drawn = photographs_.empty() || random.chance(tuning_.drawn_fraction);
  return is_drawn ? photographs_.size() + random.below(drawn_.size()) : random.below(photographs_.size());
}

/// Frontal views are common, but turned ones are harder to learn.
float FaceSamples::random_yaw(SampleRandom& random) const {
  if (random.chance(0.4f)) return mostly_small(random, tuning_.yaw_degrees);
  return random.between(-0.9f, 0.9f) * tuning_.yaw_degrees;
}

/// A person to mix with number k: of the same class, so that classes can be kept apart in validation.
std::size_t FaceSamples::random_second(std::size_t k, SampleRandom& random) const {
  const int wanted = photograph(k).person % kPersonClasses;
  for (int attempt = 0; attempt < 200; ++attempt)
    if (const std::size_t other = random_photograph(random);
        photograph(other).person % kPersonClasses == wanted)
      return other;
  return k;
}

/// Side and place of a face box, and a distance.
FacePlacement FaceSamples::random_placement(SampleRandom& random) const {
  FacePlacement out;
  out.picture_px = tuning_.side_px;
  out.box.side = random.octaves_between(tuning_.box_low_px, tuning_.box_high_px);
  const float room = 0.5f * (static_cast<float>(tuning_.side_px) - out.box.side) - tuning_.margin_px,
              middle = 0.5f * static_cast<float>(tuning_.side_px - 1);
  out.box.center = {middle + random.between(-room, room), middle + random.between(-room, room)};
  out.distance_mm = random.octaves_between(tuning_.near_mm, tuning_.far_mm);
  return out;
}

/// Sets landmarks, box, and which landmarks the raster shows.
void FaceSamples::set_truth(const std::vector<Vec3>& points, const TextureRaster& raster,
                            FaceSample& sample) const {
  const Projector projector(view_of(sample.pose, sample.camera), true);
  sample.landmarks = projected(points, sample.pose, sample.camera);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const float shown = raster.depth(sample.landmarks[k]);
    const bool is_hidden = !(shown > projector.to_camera(points[k]).z - tuning_.hidden_mm);
    if (is_hidden) sample.trust[k] = kTrustNone;
  }
  sample.box = face_box_in(model_, sample.landmarks, sample.pose, sample.camera);
}

/// The skin and the shape of a second person, in part.
void FaceSamples::mix_people(std::size_t second, SampleRandom& random, PhotoTurn& turn) const {
  turn.second = &parts_->meshes[second];
  turn.second_weight = random.between(0.3f, 0.7f);
  const float weight = random.unit();
  for (std::size_t p = 0; p < turn.q.size(); ++p)
    if (model_.parameters()[p].group == Group::identity)
      turn.q[p] += weight * (photograph(second).q[p] - turn.q[p]);
}

/// Pose of face and body of a photograph, and the camera.
void FaceSamples::turn_head(const Photograph& photograph, const std::vector<Vec3>& points,
                            SampleRandom& random, PhotoTurn& turn) const {
  const float yaw = kRadian * random_yaw(random),
              pitch = kRadian * mostly_small(random, tuning_.pitch_degrees),
              tilt = kRadian * random.between(-tuning_.tilt_degrees, tuning_.tilt_degrees);
  Vec3 way = log_rotation(rotation_of(yaw, pitch, tilt) * conjugate(photograph.pose.q));
  if (const float angle = length(way), limit = kRadian * tuning_.most_turned_degrees; angle > limit)
    way = limit / angle * way;
  const Quat roll = rotation_of(0, 0, kRadian * mostly_small(random, tuning_.roll_degrees));
  turn.body = roll * photograph.pose.q;
  place_face(model_, points, roll * (exp_rotation(way) * photograph.pose.q), random_placement(random),
             &turn.camera, &turn.pose);
}

FaceSample FaceSamples::draw_turned(SampleRandom& random, Workspace& workspace) const {
  const std::size_t k = random_photograph(random), second = random_second(k, random);
  PhotoTurn turn;
  turn.q = photograph(k).q;
  if (random.chance(tuning_.mixed_chance)) mix_people(second, random, turn);
  turn.q = parts_->expressions.varied(turn.q, random);
  const std::vector<Vec3> points = parts_->sheet.landmarks(*workspace.cascade, turn.q.data());
  turn_head(photograph(k), points, random, turn);
  if (random.chance(tuning_.relit_chance)) turn.light = random_light(random);
  if (tuning_.gaze_chance > 0 && random.chance(tuning_.gaze_chance))
    turn.gaze_mm = {mostly_small(random, tuning_.gaze_x_mm), mostly_small(random, tuning_.gaze_y_mm)};
  Image background = surroundings(random);
  if (!background.pixels.empty() && random.chance(0.5f)) turn.cover_mm = random.between(50, 120);
  const PhotoMesh& mesh = parts_->meshes[k];
  mesh.draw(turn, *workspace.cascade, workspace.raster);

  FaceSample sample;
  sample.person = photograph(k).person;
  sample.trust = photograph(k).trust;
  sample.q = turn.q;
  sample.camera = turn.camera;
  sample.pose = turn.pose;
  set_truth(points, workspace.raster, sample);
  sample.pupils = mesh.pupils(turn, *workspace.cascade, workspace.raster);
  if (background.pixels.empty()) background = smeared(mipmaps_[k], tuning_.side_px);
  sample.picture = mesh.picture(turn, workspace.raster, {&mipmaps_[k], &mipmaps_[second]}, background);
  return sample;
}

}  // namespace pliant::host::learn
