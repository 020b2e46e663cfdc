#include "face/face_picture.hpp"

#include "vision/bilinear.hpp"

namespace pliant {

namespace {

constexpr int kSide = kFacePictureTuning.side_px;
constexpr int kMostSamples = kFacePictureTuning.most_samples;
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

/// Where the n samples of a pixel are, along one axis of the frame.
void place_samples(float first, float ratio, int n, int most, int* out) {
  const float spacing = ratio / static_cast<float>(n);
  const float from = first + 0.5f * (spacing - ratio) + 0.5f;
  for (int k = 0; k < n; ++k)
    out[k] = limited(whole(clamp(from + spacing * static_cast<float>(k), -1, 1e6f)), most);
}

}  // namespace

void FacePicture::lay_out(Arena& arena) {
  pixels_ = arena.take<std::uint8_t>(static_cast<std::size_t>(kSide) * kSide);
  columns_ = arena.take<int>(static_cast<std::size_t>(kSide) * kMostSamples);
}

void FacePicture::take(const FrameView& frame, Vec2 centre, float side) {
  PLIANT_ASSERT(check(frame) == Status::ok && is_finite(centre) && side > 0);
  ratio_ = max(1, side / kFacePictureTuning.face_px);
  const float half = 0.5f * static_cast<float>(kSide - 1);
  first_ = centre - Vec2{half * ratio_, half * ratio_};
  // Without reduction the pixels are the frame's.
  if (ratio_ <= 1) first_ = {static_cast<float>(whole(first_.x)), static_cast<float>(whole(first_.y))};
  const int n = limited(static_cast<int>(min(ratio_ + 0.999f, 1e3f)), kMostSamples);
  const auto position = [&](float first, int pixel) { return first + ratio_ * static_cast<float>(pixel); };
  for (int x = 0; x < kSide; ++x) {
    place_samples(position(first_.x, x), ratio_, n, frame.width - 1, columns_ + x * n);
    for (int k = 0; k < n; ++k) columns_[x * n + k] *= frame.pixel_step_bytes;
  }
  std::uint8_t* to = pixels_;
  for (int y = 0; y < kSide; ++y) {
    int row[kMostSamples];
    place_samples(position(first_.y, y), ratio_, n, frame.height - 1, row);
    const std::uint8_t* lines[kMostSamples];
    for (int k = 0; k < n; ++k) lines[k] = frame.data + static_cast<std::size_t>(row[k]) * frame.stride_bytes;
    const int* column = columns_;
    for (int x = 0; x < kSide; ++x, column += n) {
      int sum = n * n / 2;
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) sum += lines[j][column[i]];
      *to++ = static_cast<std::uint8_t>(sum / (n * n));
    }
  }
}

/// Grey at a position in 1/65536 px.
std::uint8_t FacePicture::sample(std::int32_t x, std::int32_t y) const {
  constexpr std::int32_t kLast = ((kSide - 1) << 16) - 1;
  x = limited(x, kLast);
  y = limited(y, kLast);
  const std::uint8_t* const p = pixels_ + (y >> 16) * kSide + (x >> 16);
  return static_cast<std::uint8_t>((bilinear_sixteenths(p, kSide, (x >> 8) & 255, (y >> 8) & 255) + 8) >> 4);
}

void FacePicture::crop(const CropMap& map, std::uint8_t* out) const {
  const float by = 1.0f / ratio_;
  const Vec2 corner = by * (map.to_frame({-1, -1}) - first_), right = by * map.right;
  // Samples a side of a crop pixel: one for each pixel and a half that it covers.
  std::int32_t row_x = fixed(corner.x, 8000), row_y = fixed(corner.y, 8000);
  const std::int32_t step_x = fixed(right.x, 64), step_y = fixed(right.y, 64);
  const int pixels = map.side + 2;
  for (int j = 0; j < pixels; ++j, row_x -= step_y, row_y += step_x) {
    std::int32_t x = row_x, y = row_y;
    for (int i = 0; i < pixels; ++i, x += step_x, y += step_y) *out++ = sample(x, y);
  }
}

}  // namespace pliant
