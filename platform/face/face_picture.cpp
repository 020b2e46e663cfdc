#include "face/face_picture.hpp"

#include <cstring>

#include "base/integers.hpp"
#include "base/lanes.hpp"
#include "base/wide_vectors.hpp"
#include "vision/bilinear.hpp"

namespace pliant {

namespace {

constexpr int kMostSide = kFacePictureTuning.side_px;
constexpr int kMostSamples = kFacePictureTuning.most_samples;
constexpr float kFixedOne = 65536;

/// Of positions far from any frame, the nearest within 10^6 px.
int whole(float x) {
  x = clamp(x, -1e6f, 1e6f);
  const int truncated = static_cast<int>(x);
  return static_cast<float>(truncated) > x ? truncated - 1 : truncated;
}

/// A position or step in 1/65536 px. Bounded, so that sums over a crop stay within 31 bits; what is not a number is -most.
std::int32_t fixed(float x, float most) {
  return static_cast<std::int32_t>(min(max(-most, x), most) * kFixedOne);
}

/// Where the n samples of a pixel are, along one axis of the frame.
void place_samples(float first, float ratio, int n, int most, int* out) {
  const float spacing = ratio / static_cast<float>(n);
  const float from = first + 0.5f * (spacing - ratio) + 0.5f;
  for (int k = 0; k < n; ++k) out[k] = within(whole(from + spacing * static_cast<float>(k)), 0, most);
}

/// A row of the picture: each pixel is the rounded mean of n x n samples.
/// \param lines  n of the frame. \param column  bytes from the beginning of a line to each sample, n a pixel.
void write_means(const std::uint8_t* const* lines, const int* column, int n, int side, std::uint8_t* to) {
  std::uint8_t* const end = to + side;
  if (n == 1) {
    while (to != end) *to++ = lines[0][*column++];
    return;
  }
  if (n == 2) {
    for (; to != end; column += 2) {
      const int upper = lines[0][column[0]] + lines[0][column[1]];
      *to++ = static_cast<std::uint8_t>((upper + lines[1][column[0]] + lines[1][column[1]] + 2) / 4);
    }
    return;
  }
  // Of at most 36 samples: 2^20 / n^2, rounded up, divides their sums exactly.
  static_assert(kMostSamples <= 6, "");
  const auto square = static_cast<std::uint32_t>(n * n), half_square = square / 2,
             reciprocal = (1u << 20) / square + 1;
  for (; to != end; column += n) {
    std::uint32_t sum = half_square;
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) sum += lines[j][column[i]];
    *to++ = static_cast<std::uint8_t>((sum * reciprocal) >> 20);
  }
}

}  // namespace

Vec2 CropMap::to_crop(Vec2 frame) const {
  const Vec2 d = frame - origin;
  const float by = 1.0f / dot(right, right);
  return middle() + Vec2{by * (right.x * d.x + right.y * d.y), by * (right.x * d.y - right.y * d.x)};
}

Sym2 to_frame_px(Sym2 w, Vec2 a) {
  const float by = 1.0f / (dot(a, a) * dot(a, a));
  return {by * (a.x * a.x * w.xx - 2 * a.x * a.y * w.xy + a.y * a.y * w.yy),
          by * (a.x * a.y * (w.xx - w.yy) + (a.x * a.x - a.y * a.y) * w.xy),
          by * (a.y * a.y * w.xx + 2 * a.x * a.y * w.xy + a.x * a.x * w.yy)};
}

void FacePicture::lay_out(Arena& arena, int side) {
  PLIANT_ASSERT(side >= 2 && side <= kMostSide);
  side_ = side;
  pixels_ = arena.take<std::uint8_t>(static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
}

void FacePicture::take(const FrameView& frame, Vec2 centre, float ratio, int* columns) {
  PLIANT_ASSERT(check(frame) == Status::ok && is_finite(centre) && is_finite(ratio));
  ratio_ = max(1, ratio);
  const float half = 0.5f * static_cast<float>(side_ - 1);
  first_ = centre - Vec2{half * ratio_, half * ratio_};
  // Without reduction the pixels are the frame's.
  if (ratio_ <= 1) first_ = {static_cast<float>(whole(first_.x)), static_cast<float>(whole(first_.y))};
  const int n = within(static_cast<int>(min(ratio_ + 0.999f, 1e3f)), 0, kMostSamples);
  const auto position = [&](float first, int pixel) { return first + ratio_ * static_cast<float>(pixel); };
  for (int x = 0; x < side_; ++x) {
    place_samples(position(first_.x, x), ratio_, n, frame.width - 1, columns + x * n);
    for (int k = 0; k < n; ++k) columns[x * n + k] *= frame.pixel_step_bytes;
  }
  for (int y = 0; y < side_; ++y) {
    int row[kMostSamples];
    place_samples(aspect_ * position(first_.y, y), aspect_ * ratio_, n, frame.height - 1, row);
    const std::uint8_t* lines[kMostSamples];
    for (int k = 0; k < n; ++k) lines[k] = frame.data + static_cast<std::size_t>(row[k]) * frame.stride_bytes;
    write_means(lines, columns, n, side_, pixels_ + y * side_);
  }
}

namespace {

/// Positions along a row of a crop, in 1/65536 px of the picture.
struct CropLine {
  std::int32_t x, y, step_x, step_y;
};

/// The last position with four neighbours.
std::int32_t last_of(int side) {
  return ((side - 1) << 16) - 1;
}

#if PLIANT_HAS_VECTORS

constexpr int kGroup = 32;

/// kGroup pixels. In three loops, of which two become vectors: where each pixel is, its four neighbours, and the interpolation.
PLIANT_WIDE_VECTORS
void read_group(const std::uint8_t* pixels, int side, const CropLine& line, std::uint8_t* out) {
  std::int32_t first[kGroup], fraction_x[kGroup], fraction_y[kGroup];
  std::uint32_t four[kGroup];  // a byte each: two of the upper line, two of the lower one
  const std::int32_t last = last_of(side);
  for (int i = 0; i < kGroup; ++i) {
    const std::int32_t x = within(line.x + i * line.step_x, 0, last),
                       y = within(line.y + i * line.step_y, 0, last);
    first[i] = (y >> 16) * side + (x >> 16);
    fraction_x[i] = (x >> 8) & 255;
    fraction_y[i] = (y >> 8) & 255;
  }
  for (int i = 0; i < kGroup; ++i) {
    std::uint16_t upper, lower;
    std::memcpy(&upper, pixels + first[i], sizeof upper);
    std::memcpy(&lower, pixels + first[i] + side, sizeof lower);
    four[i] = upper | static_cast<std::uint32_t>(lower) << 16;
  }
  for (int i = 0; i < kGroup; ++i) {
    const auto at = [&](int shift) { return static_cast<int>(four[i] >> shift & 255); };
    out[i] = bilinear_grey(at(0), at(8), at(16), at(24), fraction_x[i], fraction_y[i]);
  }
}

/// The last group ends with the line: it reads some pixels again.
void read_line(const std::uint8_t* pixels, int side, const CropLine& line, int count, std::uint8_t* out) {
  const auto read = [&](int from, std::uint8_t* to) {
    read_group(pixels, side,
               {line.x + from * line.step_x, line.y + from * line.step_y, line.step_x, line.step_y}, to);
  };
  if (count < kGroup) {
    std::uint8_t group[kGroup];
    read(0, group);
    std::memcpy(out, group, static_cast<std::size_t>(count));
    return;
  }
  for (int from = 0; from < count; from += kGroup) {
    const int at = smaller(from, count - kGroup);
    read(at, out + at);
  }
}

#else

/// Grey at a position in 1/65536 px, within the picture, by bilinear interpolation.
std::uint8_t sample(const std::uint8_t* pixels, int side, std::int32_t x, std::int32_t y) {
  const std::uint8_t *const upper = pixels + (y >> 16) * side + (x >> 16), *const lower = upper + side;
  return bilinear_grey(upper[0], upper[1], lower[0], lower[1], (x >> 8) & 255, (y >> 8) & 255);
}

bool is_inside(std::int32_t x, std::int32_t y, std::int32_t last) {
  return x >= 0 && y >= 0 && x <= last && y <= last;
}

void read_line(const std::uint8_t* pixels, int side, const CropLine& line, int count, std::uint8_t* out) {
  const std::int32_t steps = count - 1, last = last_of(side);
  std::int32_t x = line.x, y = line.y;
  if (is_inside(x, y, last) && is_inside(x + steps * line.step_x, y + steps * line.step_y, last))
    for (int i = 0; i < count; ++i, x += line.step_x, y += line.step_y) *out++ = sample(pixels, side, x, y);
  else
    for (int i = 0; i < count; ++i, x += line.step_x, y += line.step_y)
      *out++ = sample(pixels, side, within(x, 0, last), within(y, 0, last));
}

#endif

}  // namespace

CropReader::CropReader(const FacePicture& picture, const CropMap& map)
    : pixels_(picture.pixels()), count_(map.side + 2), picture_side_(picture.side()) {
  const Vec2 first = picture.from_frame(map.to_frame({-1, -1})), step = picture.along_from_frame(map.right);
  first_x_ = fixed(first.x, 8000);
  first_y_ = fixed(first.y, 8000);
  step_x_ = fixed(step.x, 64);
  step_y_ = fixed(step.y, 64);
}

Vec2 down_of(const Projector& projector) {
  const Vec3 up = projector.rotated({0, 1, 0});
  const float size = length(Vec2{up.x, up.y});
  return size > 1e-3f ? (-1.0f / size) * Vec2{up.x, up.y} : Vec2{0, 1};
}

void CropReader::read_row(int y, std::uint8_t* out) const {
  read_line(pixels_, picture_side_,
            {first_x_ - (y + 1) * step_y_, first_y_ + (y + 1) * step_x_, step_x_, step_y_}, count_, out);
}

}  // namespace pliant
