#include "face/face_picture.hpp"

#include "vision/bilinear.hpp"

namespace pliant {

namespace {

constexpr int kSide = kFacePictureTuning.side_px;
constexpr float kFixedOne = 65536;

constexpr int limited(int x, int most) {
  return x < 0 ? 0 : x > most ? most : x;
}

int whole(float x) {
  const int truncated = static_cast<int>(x);
  return static_cast<float>(truncated) > x ? truncated - 1 : truncated;
}

/// A position or step in 1/65536 px. Bounded, so that sums over a crop stay within 31 bits.
std::int32_t fixed(float x, float most) {
  return static_cast<std::int32_t>(clamp(x, -most, most) * kFixedOne);
}

/// Mean of n x n samples of one pixel's square. `column` and `row` hold the frame's offsets of the samples.
std::uint8_t mean_of(const FrameView& frame, const int* column, const int* row, int n) {
  int sum = n * n / 2;
  for (int j = 0; j < n; ++j) {
    const std::uint8_t* const line = frame.data + static_cast<std::size_t>(row[j]) * frame.stride_bytes;
    for (int i = 0; i < n; ++i) sum += line[column[i]];
  }
  return static_cast<std::uint8_t>(sum / (n * n));
}

}  // namespace

void FacePicture::lay_out(Arena& arena) {
  pixels_ = arena.take<std::uint8_t>(static_cast<std::size_t>(kSide) * kSide);
}

void FacePicture::take(const FrameView& frame, Vec2 centre, float side) {
  PLIANT_ASSERT(check(frame) == Status::ok && is_finite(centre) && side > 0);
  ratio_ = max(1, side / kFacePictureTuning.face_px);
  const float half = 0.5f * static_cast<float>(kSide - 1);
  first_ = centre - Vec2{half * ratio_, half * ratio_};
  // Without reduction the pixels are the frame's.
  if (ratio_ <= 1) first_ = {static_cast<float>(whole(first_.x)), static_cast<float>(whole(first_.y))};
  const int n = limited(static_cast<int>(min(ratio_ + 0.999f, 1e3f)), kFacePictureTuning.most_samples);
  const float spacing = ratio_ / static_cast<float>(n), lead = 0.5f * (spacing - ratio_) + 0.5f;
  int row[kFacePictureTuning.most_samples], column[kFacePictureTuning.most_samples];
  const auto place = [&](float first, int pixel, int most, int* out) {
    const float from = first + ratio_ * static_cast<float>(pixel) + lead;
    for (int k = 0; k < n; ++k)
      out[k] = limited(whole(clamp(from + spacing * static_cast<float>(k), -1, 1e6f)), most);
  };
  std::uint8_t* to = pixels_;
  for (int y = 0; y < kSide; ++y) {
    place(first_.y, y, frame.height - 1, row);
    for (int x = 0; x < kSide; ++x) {
      place(first_.x, x, frame.width - 1, column);
      for (int k = 0; k < n; ++k) column[k] *= frame.pixel_step_bytes;
      *to++ = mean_of(frame, column, row, n);
    }
  }
}

/// Grey at a position in 1/65536 px, in 1/16 grey.
int FacePicture::sample(std::int32_t x, std::int32_t y) const {
  constexpr std::int32_t kLast = ((kSide - 1) << 16) - 1;
  x = limited(x, kLast);
  y = limited(y, kLast);
  return bilinear_sixteenths(pixels_ + (y >> 16) * kSide + (x >> 16), kSide, (x >> 8) & 255, (y >> 8) & 255);
}

void FacePicture::crop(const CropMap& map, std::uint8_t* out) const {
  const float by = 1.0f / ratio_;
  const Vec2 corner = by * (map.to_frame({-1, -1}) - first_), right = by * map.right;
  // Samples a side of a crop pixel: one for each pixel and a half that it covers.
  const float covered = length(right);
  const int n = covered <= 1.5f ? 1 : covered <= 3 ? 2 : 3;
  const float part = 1.0f / static_cast<float>(n);
  const std::int32_t step_x = fixed(right.x, 64), step_y = fixed(right.y, 64);
  const std::int32_t sub_x = fixed(part * right.x, 64), sub_y = fixed(part * right.y, 64);
  const float lead = 0.5f * (part - 1);
  const Vec2 first = corner + Vec2{lead * (right.x - right.y), lead * (right.y + right.x)};
  std::int32_t row_x = fixed(first.x, 8000), row_y = fixed(first.y, 8000);
  const int pixels = map.side + 2, divisor = 16 * n * n;
  for (int j = 0; j < pixels; ++j, row_x -= step_y, row_y += step_x) {
    std::int32_t x = row_x, y = row_y;
    for (int i = 0; i < pixels; ++i, x += step_x, y += step_y) {
      int sum = divisor / 2;
      for (int b = 0; b < n; ++b)
        for (int a = 0; a < n; ++a) sum += sample(x + a * sub_x - b * sub_y, y + a * sub_y + b * sub_x);
      *out++ = static_cast<std::uint8_t>(sum / divisor);
    }
  }
}

}  // namespace pliant
