#include "face/template_search.hpp"

namespace pliant {
namespace {

constexpr float kYaw = 0.32f, kPitch = 0.2f, kRoll = 0.28f;  // rad, between templates, and what one covers
constexpr float kScaleStep = 1.15f;
constexpr float kOneSpot = 0.2f;  // of the square's side
constexpr float kEven = 400;      // added to a pixel's energy: even grey is like nothing

}  // namespace

View view_at(Vec2 x, float scale, Quat turn, Vec3 middle, float rho, Vec2 principal) {
  View view;
  view.q = turn;
  view.s = scale;
  view.rho = rho;
  view.c = principal;
  const Vec3 p = rotation_matrix(turn) * Vec3{middle.x, -middle.y, -middle.z};
  // x = c + s (p + tau) / (1 + rho z)
  const float depth = 1 + rho * p.z;
  view.tau = (depth / scale) * (x - principal) - Vec2{p.x, p.y};
  return view;
}

void PictureSearch::lay_out(Arena& arena, int width, int height, float least_px) {
  const float ratio = kInnerPx / least_px;
  width_ = static_cast<int>(ratio * static_cast<float>(width)) + 1;
  height_ = static_cast<int>(ratio * static_cast<float>(height)) + 1;
  if (width_ < kSide) width_ = kSide;
  if (height_ < kSide) height_ = kSide;
  const auto pixels = static_cast<std::size_t>(width_ * height_);
  finder_.lay_out(arena, width_ * height_, width_);
  grey_ = arena.take<std::uint8_t>(pixels);
  direction_ = arena.take<Direction>(pixels);
  energy_ = arena.take<std::uint32_t>(static_cast<std::size_t>((width_ + 1) * (height_ + 1)));
  sum_ = arena.take<std::int32_t>(3 * kSide * kSide);
  template_ = arena.take<Template>(kTurns);
  candidate_ = arena.take<Candidate>(kCandidates);
  template_directions_ = arena.take<Direction>(kTurns * kSide * kSide);
}

void PictureSearch::prepare(ModelPicture& picture, float distance_mm) {
  scale_ = kInnerPx / picture.inner_size();
  rho_ = 1 / distance_mm;
  for (int k = 0; k < kTurns; ++k) {
    const float yaw = kYaw * static_cast<float>(k % 3 - 1), roll = kRoll * static_cast<float>(k / 3 - 1);
    template_[k].direction = template_directions_ + k * kSide * kSide;
    template_[k].turn = normalised(exp_rotation({0, 0, roll}) * exp_rotation({0, yaw, 0}));
    draw_template(picture, template_[k]);
  }
}

/// The mean of the directions in pictures with the head tilted and lit in different ways: where they differ it is short.
void PictureSearch::draw_template(ModelPicture& picture, Template& t) {
  constexpr Vec3 kLights[] = {{0, -0.6f, -0.8f}, {-0.6f, -0.4f, -0.69f}, {0.6f, -0.4f, -0.69f}};
  constexpr int kTilts = 3;
  for (int k = 0; k < 3 * kSide * kSide; ++k) sum_[k] = 0;
  const Vec2 middle{0.5f * ModelPicture::kSide, 0.5f * ModelPicture::kSide};
  for (int tilt = 0; tilt < kTilts; ++tilt)
    for (const Vec3 light : kLights) {
      const Quat turn = normalised(t.turn * exp_rotation({kPitch * static_cast<float>(tilt - 1), 0, 0}));
      picture.draw(view_at(middle, 2 * scale_, turn, picture.middle(), rho_, middle), light);
      add_drawing(picture);
    }
  const int drawn = kTilts * 3;
  t.x0 = t.y0 = kSide;
  t.x1 = t.y1 = 0;
  float square = 0;
  for (int k = 0; k < kSide * kSide; ++k) {
    Direction& d = t.direction[k];
    d = {};
    if (2 * sum_[3 * k + 2] <= drawn) continue;
    d = {static_cast<std::int16_t>(sum_[3 * k] / drawn), static_cast<std::int16_t>(sum_[3 * k + 1] / drawn)};
    square += static_cast<float>(dot(d, d));
    const int x = k % kSide, y = k / kSide;
    if (x < t.x0) t.x0 = x;
    if (y < t.y0) t.y0 = y;
    if (x >= t.x1) t.x1 = x + 1;
    if (y >= t.y1) t.y1 = y + 1;
  }
  t.length = square_root(square);
}

/// Adds the directions of a drawing at half its size to the sums, and whether a pixel belongs to the inner face.
void PictureSearch::add_drawing(const ModelPicture& picture) {
  constexpr int kLine = ModelPicture::kSide;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const std::uint8_t* p = picture.pixels() + 2 * y * kLine + 2 * x;
      const std::uint8_t* inner = picture.inner() + 2 * y * kLine + 2 * x;
      grey_[y * kSide + x] = static_cast<std::uint8_t>((p[0] + p[1] + p[kLine] + p[kLine + 1] + 2) / 4);
      sum_[3 * (y * kSide + x) + 2] += inner[0] != 0 && inner[kLine + 1] != 0;
    }
  finder_.find({grey_, kSide, kSide, kSide}, kReach, direction_);
  for (int k = 0; k < kSide * kSide; ++k) {
    sum_[3 * k] += direction_[k].x;
    sum_[3 * k + 1] += direction_[k].y;
  }
}

void PictureSearch::shrink_to(const Pyramid& pyramid, float ratio) {
  const PictureAt picture(pyramid, ratio);
  const int w = static_cast<int>(ratio * static_cast<float>(pyramid.level(0).width)),
            h = static_cast<int>(ratio * static_cast<float>(pyramid.level(0).height));
  shrunk_ = {grey_, w < width_ ? w : width_, h < height_ ? h : height_, w < width_ ? w : width_};
  for (int y = 0; y < shrunk_.height; ++y)
    for (int x = 0; x < shrunk_.width; ++x)
      grey_[y * shrunk_.width + x] =
          picture.grey((1 / ratio) * Vec2{static_cast<float>(x), static_cast<float>(y)});
}

void PictureSearch::sum_energy() {
  const int w = shrunk_.width, h = shrunk_.height;
  for (int x = 0; x <= w; ++x) energy_[x] = 0;
  for (int y = 0; y < h; ++y) {
    std::uint32_t row = 0;
    energy_[(y + 1) * (w + 1)] = 0;
    for (int x = 0; x < w; ++x) {
      row += static_cast<std::uint32_t>(dot(direction_[y * w + x], direction_[y * w + x]));
      energy_[(y + 1) * (w + 1) + x + 1] = energy_[y * (w + 1) + x + 1] + row;
    }
  }
}

/// With the template's square at x, y of the shrunk picture.
float PictureSearch::likeness_at(const Template& t, int x, int y) const {
  const int w = shrunk_.width;
  std::int32_t sum = 0;
  for (int j = t.y0; j < t.y1; ++j) {
    const std::int16_t* a = &t.direction[j * kSide + t.x0].x;
    const std::int16_t* b = &direction_[(y + j) * w + x + t.x0].x;
    std::int32_t row = 0;
    for (int i = 0; i < 2 * (t.x1 - t.x0); ++i) row += a[i] * b[i];
    sum += row;
  }
  const std::uint32_t *top = energy_ + (y + t.y0) * (w + 1) + x, *bottom = energy_ + (y + t.y1) * (w + 1) + x;
  const std::uint32_t energy = bottom[t.x1] - bottom[t.x0] - top[t.x1] + top[t.x0];
  const float area = static_cast<float>((t.x1 - t.x0) * (t.y1 - t.y0));
  return static_cast<float>(sum) / (t.length * square_root(static_cast<float>(energy) + kEven * area));
}

/// Keeps the best; of two on about the same spot the better.
void PictureSearch::offer(const Candidate& c) {
  std::size_t to = found_;
  for (std::size_t k = 0; k < found_ && to == found_; ++k)
    if (length(candidate_[k].x - c.x) < kOneSpot * kSide / scale_ * c.scale) to = k;
  if (to == kCandidates) to = kCandidates - 1;
  if (to < found_ && c.likeness <= candidate_[to].likeness) return;
  if (to == found_) ++found_;
  candidate_[to] = c;
  for (; to > 0 && candidate_[to].likeness > candidate_[to - 1].likeness; --to) {
    const Candidate other = candidate_[to];
    candidate_[to] = candidate_[to - 1];
    candidate_[to - 1] = other;
  }
}

void PictureSearch::search_scale(const Pyramid& pyramid, float scale) {
  const float ratio = scale_ / scale;  // of the shrunk picture to the frame
  shrink_to(pyramid, ratio);
  finder_.find(shrunk_, kReach, direction_);
  sum_energy();
  for (int k = 0; k < kTurns; ++k) {
    const Template& t = template_[k];
    for (int y = -t.y0; y + t.y1 <= shrunk_.height; ++y)
      for (int x = -t.x0; x + t.x1 <= shrunk_.width; ++x) {
        const float here = likeness_at(t, x, y);
        if (found_ == kCandidates && here <= candidate_[kCandidates - 1].likeness) continue;
        // The template's middle, of the drawing's pixels, lies between four of its own.
        const float half = 0.5f * kSide - 0.25f;
        const Vec2 middle{static_cast<float>(x) + half, static_cast<float>(y) + half};
        offer({(1 / ratio) * middle, scale, t.turn, here});
      }
  }
}

Span<const Candidate> PictureSearch::find(const Pyramid& pyramid, float least_px, float largest_px) {
  found_ = 0;
  for (float px = least_px; px <= largest_px; px *= kScaleStep) search_scale(pyramid, scale_ * px / kInnerPx);
  return {candidate_, found_};
}

}  // namespace pliant
