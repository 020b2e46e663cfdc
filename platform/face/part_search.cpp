#include "face/part_search.hpp"

namespace pliant {

namespace {

constexpr int kSide = ModelPicture::kSide;
constexpr float kEven = 400;        // added to a pixel's energy: even grey is like nothing
constexpr float kLeastPart = 0.2f;  // likeness
constexpr float kFarness = 0.002f;  // taken off for a shift, times its square
constexpr float kPartSdPx = 0.6f;   // of the drawing, of a part that is just as drawn

}  // namespace

void PartSearch::lay_out(Arena& arena) {
  finder_.lay_out(arena, kWindow * kWindow, kWindow);
  grey_ = arena.take<std::uint8_t>(kWindow * kWindow);
  drawn_ = arena.take<Direction>(kSide * kSide);
  seen_ = arena.take<Direction>(kWindow * kWindow);
  energy_ = arena.take<std::uint32_t>((kWindow + 1) * (kWindow + 1));
}

void PartSearch::look(const Pyramid& pyramid, ModelPicture& picture, const View& view) {
  const float scale = kInnerPx / picture.inner_size();
  ratio_ = scale / view.s;
  Vec2 middle = view.c;
  (void)Projector(view, true).project(picture.middle(), &middle);
  origin_ = middle - (0.5f * kSide / ratio_) * Vec2{1, 1};
  drawn_view_ = view;
  drawn_view_.s = scale;
  drawn_view_.c = ratio_ * (view.c - origin_);
  picture.draw(drawn_view_, {0, -0.6f, -0.8f});
  finder_.find({picture.pixels(), kSide, kSide, kSide}, kReach, drawn_);
  const PictureAt frame(pyramid, ratio_);
  for (int y = 0; y < kWindow; ++y)
    for (int x = 0; x < kWindow; ++x)
      grey_[y * kWindow + x] = frame.grey(
          origin_ + (1 / ratio_) * Vec2{static_cast<float>(x - kMargin), static_cast<float>(y - kMargin)});
  finder_.find({grey_, kWindow, kWindow, kWindow}, kReach, seen_);
  compare(picture.inner());
  sum_energy();
}

void PartSearch::compare(const std::uint8_t* inner) {
  float ab = 0, aa = 0, bb = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      Direction& a = drawn_[y * kSide + x];
      if (inner[y * kSide + x] == 0) {
        a = {};
        continue;
      }
      const Direction b = seen_[(y + kMargin) * kWindow + x + kMargin];
      ab += static_cast<float>(dot(a, b));
      aa += static_cast<float>(dot(a, a));
      bb += static_cast<float>(dot(b, b));
    }
  likeness_ = aa > 0 && bb > 0 ? ab / square_root(aa * bb) : 0;
}

void PartSearch::sum_energy() {
  constexpr int kLine = kWindow + 1;
  for (int x = 0; x < kLine; ++x) energy_[x] = 0;
  for (int y = 0; y < kWindow; ++y) {
    std::uint32_t row = 0;
    energy_[(y + 1) * kLine] = 0;
    for (int x = 0; x < kWindow; ++x) {
      row += static_cast<std::uint32_t>(dot(seen_[y * kWindow + x], seen_[y * kWindow + x]));
      energy_[(y + 1) * kLine + x + 1] = energy_[y * kLine + x + 1] + row;
    }
  }
}

/// \param drawn  length of what is drawn there.
float PartSearch::likeness_of_part(int x, int y, int dx, int dy, float drawn) const {
  constexpr int kSize = 2 * kPart + 1, kLine = kWindow + 1;
  const int sx = x - kPart + dx + kMargin, sy = y - kPart + dy + kMargin;
  std::int32_t ab = 0;
  for (int j = 0; j < kSize; ++j) {
    const std::int16_t* a = &drawn_[(y - kPart + j) * kSide + x - kPart].x;
    const std::int16_t* b = &seen_[(sy + j) * kWindow + sx].x;
    for (int i = 0; i < 2 * kSize; ++i) ab += a[i] * b[i];
  }
  const std::uint32_t *top = energy_ + sy * kLine + sx, *bottom = top + kSize * kLine;
  const std::uint32_t bb = bottom[kSize] - bottom[0] - top[kSize] + top[0];
  return static_cast<float>(ab) / (drawn * square_root(static_cast<float>(bb) + kEven * kSize * kSize));
}

bool PartSearch::find_part(int x, int y, int reach, Vec2* shift, float* likeness) const {
  std::int32_t aa = 0;
  for (int j = y - kPart; j <= y + kPart; ++j)
    for (int i = x - kPart; i <= x + kPart; ++i) aa += dot(drawn_[j * kSide + i], drawn_[j * kSide + i]);
  const float drawn = square_root(static_cast<float>(aa) + kEven * (2 * kPart + 1) * (2 * kPart + 1));
  *likeness = -1;
  for (int dy = -reach; dy <= reach; ++dy)
    for (int dx = -reach; dx <= reach; ++dx) {
      const float here =
          likeness_of_part(x, y, dx, dy, drawn) - kFarness * static_cast<float>(dx * dx + dy * dy);
      if (here <= *likeness) continue;
      *likeness = here;
      *shift = {static_cast<float>(dx), static_cast<float>(dy)};
    }
  return *likeness > kLeastPart;
}

std::size_t PartSearch::find(ModelPicture& picture, int reach, std::size_t step, Correspondence* out) const {
  const Projector projector(drawn_view_, true);
  std::size_t n = 0;
  const Span<const Landmark> landmarks = picture.model().landmarks();
  for (std::size_t k = 0; k < landmarks.count; k += step) {
    const Landmark& l = landmarks[k];
    Vec2 at;
    if (n == kParts || !projector.project(picture.point({l.u, l.v}), &at)) continue;
    if (!(at.x >= kPart && at.y >= kPart && at.x < kSide - kPart - 1 && at.y < kSide - kPart - 1)) continue;
    const int x = static_cast<int>(at.x + 0.5f), y = static_cast<int>(at.y + 0.5f);
    Vec2 shift;
    float likeness;
    if (picture.inner()[y * kSide + x] == 0 || !find_part(x, y, reach, &shift, &likeness)) continue;
    out[n++] = {{l.u, l.v}, origin_ + (1 / ratio_) * (at + shift), kPartSdPx / (ratio_ * likeness), false};
  }
  return n;
}

}  // namespace pliant
