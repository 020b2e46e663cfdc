#include "face/landmark_search.hpp"

#include "face/face_detector_tuning.hpp"
#include "vision/resampled_frame.hpp"

namespace pliant {

namespace {

constexpr int kSide = RenderedTemplate::kSide, kSquare = 2 * LandmarkSearch::kRadius + 1;
constexpr float kEvenEnergy = kFaceDetectorTuning.even_energy * kSquare * kSquare;

}  // namespace

void LandmarkSearch::lay_out(Arena& arena) {
  filter_.lay_out(arena, kWindow * kWindow, kWindow);
  grey_ = arena.take<std::uint8_t>(kWindow * kWindow);
  rendered_ = arena.take<GradientDirection>(kSide * kSide);
  seen_ = arena.take<GradientDirection>(kWindow * kWindow);
  energy_.lay_out(arena, kWindow, kWindow);
}

void LandmarkSearch::load(const Pyramid& pyramid, RenderedTemplate& rendered, const View& view) {
  const float scale = kInnerPx / rendered.inner_size();
  ratio_ = scale / view.s;
  Vec2 middle = view.c;
  (void)Projector(view, true).project(rendered.middle(), &middle);
  origin_ = middle - (0.5f * kSide / ratio_) * Vec2{1, 1};
  rendered_view_ = view;
  rendered_view_.s = scale;
  rendered_view_.c = ratio_ * (view.c - origin_);
  rendered.draw(rendered_view_, kFaceDetectorTuning.lights[0]);
  filter_.compute({rendered.pixels(), kSide, kSide, kSide}, kReach, rendered_);
  const ResampledFrame frame(pyramid, ratio_);
  for (int y = 0; y < kWindow; ++y)
    for (int x = 0; x < kWindow; ++x)
      grey_[y * kWindow + x] = frame.grey(
          origin_ + (1 / ratio_) * Vec2{static_cast<float>(x - kMargin), static_cast<float>(y - kMargin)});
  filter_.compute({grey_, kWindow, kWindow, kWindow}, kReach, seen_);
  compare(rendered.inner());
  energy_.build(seen_, kWindow, kWindow);
}

void LandmarkSearch::compare(const std::uint8_t* inner) {
  float ab = 0, aa = 0, bb = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      GradientDirection& a = rendered_[y * kSide + x];
      if (inner[y * kSide + x] == 0) {
        a = {};
        continue;
      }
      const GradientDirection b = seen_[(y + kMargin) * kWindow + x + kMargin];
      ab += static_cast<float>(dot(a, b));
      aa += static_cast<float>(dot(a, a));
      bb += static_cast<float>(dot(b, b));
    }
  similarity_ = aa > 0 && bb > 0 ? ab / square_root(aa * bb) : 0;
}

// rendered_length: of the directions of the rendered square around (x, y), with the energy of an even area.
float LandmarkSearch::landmark_similarity(int x, int y, int dx, int dy, float rendered_length) const {
  const int sx = x - kRadius + dx + kMargin, sy = y - kRadius + dy + kMargin;
  std::int32_t ab = 0;
  for (int j = 0; j < kSquare; ++j) {
    const std::int16_t* a = &rendered_[(y - kRadius + j) * kSide + x - kRadius].x;
    const std::int16_t* b = &seen_[(sy + j) * kWindow + sx].x;
    for (int i = 0; i < 2 * kSquare; ++i) ab += a[i] * b[i];
  }
  const std::uint32_t bb = energy_.sum(sx, sy, sx + kSquare, sy + kSquare);
  return static_cast<float>(ab) / (rendered_length * square_root(static_cast<float>(bb) + kEvenEnergy));
}

bool LandmarkSearch::find_landmark(int x, int y, int reach, Vec2* shift, float* similarity) const {
  std::int32_t aa = 0;
  for (int j = y - kRadius; j <= y + kRadius; ++j)
    for (int i = x - kRadius; i <= x + kRadius; ++i)
      aa += dot(rendered_[j * kSide + i], rendered_[j * kSide + i]);
  const float rendered_length = square_root(static_cast<float>(aa) + kEvenEnergy);
  *similarity = -1;
  for (int dy = -reach; dy <= reach; ++dy)
    for (int dx = -reach; dx <= reach; ++dx) {
      const float here = landmark_similarity(x, y, dx, dy, rendered_length) -
                         kFaceDetectorTuning.distance_penalty * static_cast<float>(dx * dx + dy * dy);
      if (here <= *similarity) continue;
      *similarity = here;
      *shift = {static_cast<float>(dx), static_cast<float>(dy)};
    }
  return *similarity > kFaceDetectorTuning.min_landmark_similarity;
}

std::size_t LandmarkSearch::find(RenderedTemplate& rendered, int reach, std::size_t step,
                                 Correspondence* out) const {
  PLIANT_ASSERT(reach <= kMargin && step > 0);
  const Projector projector(rendered_view_, true);
  std::size_t n = 0;
  const Span<const Landmark> landmarks = rendered.model().landmarks();
  for (std::size_t k = 0; k < landmarks.count; k += step) {
    const Landmark& l = landmarks[k];
    Vec2 at;
    if (n == kMaxLandmarks || !projector.project(rendered.point({l.u, l.v}), &at)) continue;
    if (!(at.x >= kRadius && at.y >= kRadius && at.x < kSide - kRadius - 1 && at.y < kSide - kRadius - 1))
      continue;
    const int x = static_cast<int>(at.x + 0.5f), y = static_cast<int>(at.y + 0.5f);
    Vec2 shift;
    float similarity;
    if (rendered.inner()[y * kSide + x] == 0 || !find_landmark(x, y, reach, &shift, &similarity)) continue;
    out[n++] = {{l.u, l.v},
                origin_ + (1 / ratio_) * (at + shift),
                kFaceDetectorTuning.landmark_sd_px / (ratio_ * similarity),
                false};
  }
  return n;
}

}  // namespace pliant
