#include "face/turned_picture.hpp"

#include "base/integers.hpp"
#include "camera/pixel_aspect.hpp"
#include "vision/bilinear.hpp"

namespace pliant {

int turn_of(const Quat& q) {
  // Where the right side of the camera's picture comes to lie.
  const Vec2 x{1 - 2 * (q.y * q.y + q.z * q.z), 2 * (q.x * q.y + q.w * q.z)};
  constexpr float kTangent = kTurnedPictureTuning.even_turn_tangent;
  const float a = magnitude(x.x), b = magnitude(x.y);
  if (b <= kTangent * a) return x.x >= 0 ? 0 : 4;
  if (a <= kTangent * b) return x.y >= 0 ? 2 : 6;
  if (x.y >= 0) return x.x >= 0 ? 1 : 3;
  return x.x >= 0 ? 7 : 5;
}

namespace {

/// Grey at a place in 1/65536 px, between the frame's pixels.
std::uint8_t grey_at(const FrameView& frame, std::int32_t x, std::int32_t y) {
  const int step = frame.pixel_step_bytes;
  const std::uint8_t *const upper = frame.data + static_cast<std::size_t>(y >> 16) * frame.stride_bytes +
                                    (x >> 16) * step,
                            *const lower = upper + frame.stride_bytes;
  return bilinear_grey(upper[0], upper[step], lower[0], lower[step], (x >> 8) & 255, (y >> 8) & 255);
}

}  // namespace

TurnedSize turned_size(int width, int height, int eighths) {
  if (eighths % 4 == 0) return {width, height};
  if (eighths % 2 == 0) return {height, width};
  const int pixels = width * height;
  int side = static_cast<int>(square_root(static_cast<float>(pixels)));
  if (side * side > pixels) --side;  // single precision has rounded up
  return {side, side};
}

void TurnedPicture::lay_out(Arena& arena, int width, int height) {
  pixels_ = arena.take<std::uint8_t>(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
}

void TurnedPicture::draw(const FrameView& frame, int eighths, float aspect) {
  PLIANT_ASSERT(eighths >= 0 && eighths < kTurnsOfPicture && frame.width >= 2 && frame.height >= 2);
  PLIANT_ASSERT(is_aspect(aspect));
  frame_middle_ = middle_of(frame);
  scale_ = {max(1 / aspect, 1), max(aspect, 1)};
  const int width = static_cast<int>(static_cast<float>(frame.width) / scale_.x),
            height = static_cast<int>(static_cast<float>(frame.height) / scale_.y);
  view_ = frame;
  view_.data = pixels_;
  view_.pixel_step_bytes = 1;
  const TurnedSize size = turned_size(width, height, eighths);
  view_.width = size.width;
  view_.height = size.height;
  view_.stride_bytes = static_cast<std::size_t>(size.width);
  // Turned by 45 degrees a frame fills a square whose side is (width + height) / sqrt(2).
  const std::int32_t unit =
      eighths % 2 == 0 ? kUnit : ((width + height) * (kUnit / 2) + size.width - 1) / size.width;
  static constexpr std::int8_t kSigns[kTurnsOfPicture] = {1, 1, 0, -1, -1, -1, 0, 1};  // of the cosine
  right_x_ = kSigns[eighths] * unit;
  right_y_ = kSigns[(eighths + 6) % kTurnsOfPicture] * unit;
  for (int y = 0; y < view_.height; ++y) draw_line(frame, y);
}

/// Places in the frame, in 1/kUnit px, are within +-2^31: it has at most 2^13 px a side, and the picture, whose pixels are up to
/// two of the frame's wide or high, reaches as far beyond.
void TurnedPicture::draw_line(const FrameView& frame, int y) {
  const std::int32_t last_x = (frame.width - 1) * kUnit - 1, last_y = (frame.height - 1) * kUnit - 1;
  const int across = 1 - view_.width, down = 2 * y + 1 - view_.height;  // from the middle, in half pixels
  const auto scaled = [](float by, std::int32_t x) {
    return static_cast<std::int32_t>(by * static_cast<float>(x));
  };
  const std::int32_t right_u = scaled(scale_.x, right_x_), right_v = scaled(scale_.y, right_y_);
  const std::int32_t up_u = scaled(scale_.x, right_y_), down_v = scaled(scale_.y, right_x_);
  std::int32_t u = (frame.width - 1) * (kUnit / 2) + across * (right_u / 2) - down * (up_u / 2);
  std::int32_t v = (frame.height - 1) * (kUnit / 2) + across * (right_v / 2) + down * (down_v / 2);
  std::uint8_t* const out = pixels_ + static_cast<std::size_t>(y) * view_.stride_bytes;
  for (int x = 0; x < view_.width; ++x, u += right_u, v += right_v)
    out[x] = grey_at(frame, within(u, 0, last_x), within(v, 0, last_y));
}

FaceBox TurnedPicture::to_frame(const FaceBox& box) const {
  const Vec2 r = right(), d = box.center - middle_of(view_);
  const Vec2 x{scale_.x * (d.x * r.x - d.y * r.y), scale_.y * (d.x * r.y + d.y * r.x)};
  return {frame_middle_ + x, scale_.x * length(r) * box.side};
}

FaceBox TurnedPicture::from_frame(const FaceBox& box) const {
  const Vec2 r = right(), x = box.center - frame_middle_,
             d = (1 / dot(r, r)) * Vec2{x.x / scale_.x, x.y / scale_.y};
  return {middle_of(view_) + Vec2{d.x * r.x + d.y * r.y, d.y * r.x - d.x * r.y},
          box.side / (scale_.x * length(r))};
}

}  // namespace pliant
