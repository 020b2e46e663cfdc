#include "face/template_search.hpp"

#include "face/face_detector_tuning.hpp"
#include "vision/resampled_frame.hpp"

namespace pliant {
namespace {

constexpr const FaceDetectorTuning& kTuning = kFaceDetectorTuning;

}  // namespace

View view_at(Vec2 x, float scale, Quat rotation, Vec3 middle, float rho, Vec2 principal) {
  View view;
  view.q = rotation;
  view.s = scale;
  view.rho = rho;
  view.c = principal;
  const Vec3 p = rotation_matrix(rotation) * Vec3{middle.x, -middle.y, -middle.z};
  // x = c + s (p + tau) / (1 + rho z)
  const float depth = 1 + rho * p.z;
  view.tau = (depth / scale) * (x - principal) - Vec2{p.x, p.y};
  return view;
}

void TemplateSearch::lay_out(Arena& arena, int width, int height, float smallest_px) {
  const float ratio = kInnerPx / smallest_px;
  width_ = static_cast<int>(ratio * static_cast<float>(width)) + 1;
  height_ = static_cast<int>(ratio * static_cast<float>(height)) + 1;
  if (width_ < kSide) width_ = kSide;
  if (height_ < kSide) height_ = kSide;
  const auto pixels = static_cast<std::size_t>(width_ * height_);
  filter_.lay_out(arena, width_ * height_, width_);
  grey_ = arena.take<std::uint8_t>(pixels);
  direction_ = arena.take<GradientDirection>(pixels);
  energy_.lay_out(arena, width_, height_);
  sum_ = arena.take<std::int32_t>(3 * kSide * kSide);
  template_ = arena.take<Template>(kTurns);
  candidate_ = arena.take<Candidate>(kCandidates);
  template_directions_ = arena.take<GradientDirection>(kTurns * kSide * kSide);
}

void TemplateSearch::prepare(RenderedTemplate& rendered, float distance_mm) {
  scale_ = kInnerPx / rendered.inner_size();
  rho_ = 1 / distance_mm;
  for (int k = 0; k < kTurns; ++k) {
    const float yaw = kTuning.yaw_step_rad * static_cast<float>(k % 3 - 1),
                roll = kTuning.roll_step_rad * static_cast<float>(k / 3 - 1);
    template_[k].direction = template_directions_ + k * kSide * kSide;
    template_[k].rotation = normalised(exp_rotation({0, 0, roll}) * exp_rotation({0, yaw, 0}));
    render_template(rendered, template_[k]);
  }
}

// The mean of the directions over renderings with different pitch and light. Where they differ the mean is short.
void TemplateSearch::render_template(RenderedTemplate& rendered, Template& t) {
  constexpr int kTilts = 3;
  for (int k = 0; k < 3 * kSide * kSide; ++k) sum_[k] = 0;
  const Vec2 middle{0.5f * RenderedTemplate::kSide, 0.5f * RenderedTemplate::kSide};
  for (int tilt = 0; tilt < kTilts; ++tilt)
    for (const Vec3 light : kTuning.lights) {
      const Quat rotation = normalised(
          t.rotation * exp_rotation({kTuning.pitch_step_rad * static_cast<float>(tilt - 1), 0, 0}));
      rendered.draw(view_at(middle, 2 * scale_, rotation, rendered.middle(), rho_, middle), light);
      add_rendering(rendered);
    }
  const int renderings = kTilts * 3;
  t.x0 = t.y0 = kSide;
  t.x1 = t.y1 = 0;
  float square = 0;
  for (int k = 0; k < kSide * kSide; ++k) {
    GradientDirection& d = t.direction[k];
    d = {};
    if (2 * sum_[3 * k + 2] <= renderings) continue;
    d = {static_cast<std::int16_t>(sum_[3 * k] / renderings),
         static_cast<std::int16_t>(sum_[3 * k + 1] / renderings)};
    square += static_cast<float>(dot(d, d));
    const int x = k % kSide, y = k / kSide;
    if (x < t.x0) t.x0 = x;
    if (y < t.y0) t.y0 = y;
    if (x >= t.x1) t.x1 = x + 1;
    if (y >= t.y1) t.y1 = y + 1;
  }
  t.length = square_root(square);
}

// Adds the directions of a rendering at half its size to the sums, and whether a pixel belongs to the inner face.
void TemplateSearch::add_rendering(const RenderedTemplate& rendered) {
  constexpr int kLine = RenderedTemplate::kSide;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const std::uint8_t* p = rendered.pixels() + 2 * y * kLine + 2 * x;
      const std::uint8_t* inner = rendered.inner() + 2 * y * kLine + 2 * x;
      grey_[y * kSide + x] = static_cast<std::uint8_t>((p[0] + p[1] + p[kLine] + p[kLine + 1] + 2) / 4);
      sum_[3 * (y * kSide + x) + 2] += inner[0] != 0 && inner[kLine + 1] != 0;
    }
  filter_.compute({grey_, kSide, kSide, kSide}, kReach, direction_);
  for (int k = 0; k < kSide * kSide; ++k) {
    sum_[3 * k] += direction_[k].x;
    sum_[3 * k + 1] += direction_[k].y;
  }
}

void TemplateSearch::reduce_to(const Pyramid& pyramid, float ratio) {
  const ResampledFrame frame(pyramid, ratio);
  const int w = static_cast<int>(ratio * static_cast<float>(pyramid.level(0).width)),
            h = static_cast<int>(ratio * static_cast<float>(pyramid.level(0).height));
  reduced_ = {grey_, w < width_ ? w : width_, h < height_ ? h : height_, w < width_ ? w : width_};
  for (int y = 0; y < reduced_.height; ++y)
    for (int x = 0; x < reduced_.width; ++x)
      grey_[y * reduced_.width + x] =
          frame.grey((1 / ratio) * Vec2{static_cast<float>(x), static_cast<float>(y)});
}

// With the template's square at x, y of the shrunk rendered.
float TemplateSearch::similarity_at(const Template& t, int x, int y) const {
  const int w = reduced_.width;
  std::int32_t sum = 0;
  for (int j = t.y0; j < t.y1; ++j) {
    const std::int16_t* a = &t.direction[j * kSide + t.x0].x;
    const std::int16_t* b = &direction_[(y + j) * w + x + t.x0].x;
    std::int32_t row = 0;
    for (int i = 0; i < 2 * (t.x1 - t.x0); ++i) row += a[i] * b[i];
    sum += row;
  }
  const std::uint32_t energy = energy_.sum(x + t.x0, y + t.y0, x + t.x1, y + t.y1);
  const float area = static_cast<float>((t.x1 - t.x0) * (t.y1 - t.y0));
  return static_cast<float>(sum) /
         (t.length * square_root(static_cast<float>(energy) + kTuning.even_energy * area));
}

// Keeps the best; of two at about the same place, the better.
void TemplateSearch::offer(const Candidate& c) {
  std::size_t to = found_;
  for (std::size_t k = 0; k < found_ && to == found_; ++k)
    if (length(candidate_[k].x - c.x) < kTuning.same_place_fraction * kSide / scale_ * c.scale) to = k;
  if (to == kCandidates) to = kCandidates - 1;
  if (to < found_ && c.similarity <= candidate_[to].similarity) return;
  if (to == found_) ++found_;
  candidate_[to] = c;
  for (; to > 0 && candidate_[to].similarity > candidate_[to - 1].similarity; --to) {
    const Candidate other = candidate_[to];
    candidate_[to] = candidate_[to - 1];
    candidate_[to - 1] = other;
  }
}

void TemplateSearch::search_scale(const Pyramid& pyramid, float scale) {
  const float ratio = scale_ / scale;  // of the reduced frame to the frame
  reduce_to(pyramid, ratio);
  filter_.compute(reduced_, kReach, direction_);
  energy_.build(direction_, reduced_.width, reduced_.height);
  for (int k = 0; k < kTurns; ++k) {
    const Template& t = template_[k];
    for (int y = -t.y0; y + t.y1 <= reduced_.height; ++y)
      for (int x = -t.x0; x + t.x1 <= reduced_.width; ++x) {
        const float here = similarity_at(t, x, y);
        if (found_ == kCandidates && here <= candidate_[kCandidates - 1].similarity) continue;
        // The middle of the rendered square lies between four pixels of the template.
        const float half = 0.5f * kSide - 0.25f;
        const Vec2 middle{static_cast<float>(x) + half, static_cast<float>(y) + half};
        offer({(1 / ratio) * middle, scale, t.rotation, here});
      }
  }
}

Span<const Candidate> TemplateSearch::find(const Pyramid& pyramid, float smallest_px, float largest_px) {
  found_ = 0;
  for (float px = smallest_px; px <= largest_px; px *= kTuning.scale_step)
    search_scale(pyramid, scale_ * px / kInnerPx);
  return {candidate_, found_};
}

}  // namespace pliant
