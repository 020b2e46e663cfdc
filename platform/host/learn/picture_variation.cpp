#include "host/learn/picture_variation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace pliant::host::learn {

namespace {

/// Grey values 0 to 255 between the steps, not rounded.
struct Values {
  int width, height;
  std::vector<float> v;
  float* row(int y) { return v.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width); }
};

Values with_gamma(const Image& picture, float exponent) {
  std::array<float, 256> table{};
  for (std::size_t k = 0; k < table.size(); ++k)
    table[k] = 255 * std::pow(static_cast<float>(k) / 255, exponent);
  Values out{picture.width, picture.height, {}};
  out.v.reserve(picture.pixels.size());
  for (const std::uint8_t p : picture.pixels) out.v.push_back(table[p]);
  return out;
}

/// Multiplies by a factor that goes from `low` to 1 across a line near the middle of the face.
/// \param width  of the passage, px.
void shade_side(Values& values, const FaceBox& face, float width, float low, SampleRandom& random) {
  const float angle = random.between(0, 6.2831853f), dx = std::cos(angle), dy = std::sin(angle);
  const float offset = random.between(-0.5f, 0.5f) * face.side;
  for (int y = 0; y < values.height; ++y)
    for (int x = 0; x < values.width; ++x) {
      const float d = (static_cast<float>(x) - face.center.x) * dx +
                      (static_cast<float>(y) - face.center.y) * dy - offset;
      const float t = clamp(d / width + 0.5f, 0, 1);
      values.row(y)[x] *= low + (1 - low) * t * t * (3 - 2 * t);
    }
}

struct Moments {
  float mean, sd;  // sd at least 1
};

/// Of the values within a box.
Moments moments_within(Values& values, const FaceBox& box) {
  float count = 0, sum = 0, squares = 0;
  const auto limit = [](float x, int size) { return std::clamp(static_cast<int>(x), 0, size); };
  const float half = 0.5f * box.side;
  for (int y = limit(box.center.y - half, values.height); y < limit(box.center.y + half, values.height); ++y)
    for (int x = limit(box.center.x - half, values.width); x < limit(box.center.x + half, values.width);
         ++x) {
      const float v = values.row(y)[x];
      count += 1, sum += v, squares += v * v;
    }
  if (count < 2) return {128, 1};
  return {sum / count, std::sqrt(std::max(squares / count - sum * sum / (count * count), 1.0f))};
}

/// Gain and offset: of the sensor, and of contrast that haze or light into the lens takes.
void expose(Values& values, const FaceBox& face, const PictureVariationTuning& tuning, SampleRandom& random) {
  const FaceBox frame{{0.5f * static_cast<float>(values.width), 0.5f * static_cast<float>(values.height)},
                      static_cast<float>(values.width)};
  const float mean = moments_within(values, random.chance(0.5f) ? face : frame).mean;
  // Most pictures are exposed well: the mean is brought to a usual level first, then changed.
  const float usual = random.between(60, 170) / std::max(mean, 12.0f);
  float gain = random.chance(0.6f) ? clamp(usual, 0.5f, 2.0f)
                                   : random.octaves_between(tuning.gain_low, tuning.gain_high);
  float offset = random.chance(0.3f) ? random.between(-12, 25) : 0.0f;
  if (random.chance(tuning.low_contrast_chance)) {
    const float contrast = random.between(0.25f, 0.7f);
    offset += (1 - contrast) * random.between(30, 200);
    gain *= contrast;
  }
  for (float& v : values.v) v = clamp(gain * v + offset, 0, 255);
}

/// Convolves the rows with a kernel of odd length; borders are repeated.
void blur_rows(Values& values, const std::vector<float>& kernel) {
  const int reach = static_cast<int>(kernel.size()) / 2, width = values.width;
  std::vector<float> padded(static_cast<std::size_t>(width + 2 * reach));
  for (int y = 0; y < values.height; ++y) {
    float* row = values.row(y);
    for (int x = 0; x < width + 2 * reach; ++x)
      padded[static_cast<std::size_t>(x)] = row[std::clamp(x - reach, 0, width - 1)];
    std::fill(row, row + width, 0.0f);
    for (std::size_t k = 0; k < kernel.size(); ++k)
      for (int x = 0; x < width; ++x) row[x] += kernel[k] * padded[static_cast<std::size_t>(x) + k];
  }
}

Values transposed(Values& values) {
  Values out{values.height, values.width, std::vector<float>(values.v.size())};
  for (int y = 0; y < values.height; ++y)
    for (int x = 0; x < values.width; ++x) out.row(x)[y] = values.row(y)[x];
  return out;
}

void blur(Values& values, float sd) {
  const int reach = static_cast<int>(std::ceil(2.5f * sd));
  if (reach < 1) return;
  std::vector<float> kernel;
  float sum = 0;
  for (int k = -reach; k <= reach; ++k)
    kernel.push_back(std::exp(-0.5f * static_cast<float>(k * k) / (sd * sd))), sum += kernel.back();
  for (float& w : kernel) w /= sum;
  blur_rows(values, kernel);
  Values turned = transposed(values);
  blur_rows(turned, kernel);
  values = transposed(turned);
}

/// Mean along a line: the camera or the head moves during the exposure.
void blur_along(Values& values, Vec2 way) {
  const int steps = std::max(2, static_cast<int>(std::ceil(length(way))) + 1);
  const std::vector<float> source = values.v;
  std::fill(values.v.begin(), values.v.end(), 0.0f);
  const float weight = 1.0f / static_cast<float>(steps);
  for (int s = 0; s < steps; ++s) {
    const float t = static_cast<float>(s) / static_cast<float>(steps - 1) - 0.5f;
    const int dx = static_cast<int>(std::lround(t * way.x)), dy = static_cast<int>(std::lround(t * way.y));
    for (int y = 0; y < values.height; ++y) {
      const float* from = source.data() + static_cast<std::size_t>(std::clamp(y + dy, 0, values.height - 1)) *
                                              static_cast<std::size_t>(values.width);
      float* row = values.row(y);
      for (int x = 0; x < values.width; ++x) row[x] += weight * from[std::clamp(x + dx, 0, values.width - 1)];
    }
  }
}

void add_noise(Values& values, float sd, SampleRandom& random) {
  // Part of it grows with the light, as the noise of photons does.
  const float floor = sd * random.between(0.3f, 1), photons = sd * random.between(0, 1);
  const bool is_coarse = random.chance(0.3f);  // noise that a camera has smoothed
  std::vector<float> noise(values.v.size());
  for (float& n : noise) n = random.normal();
  if (is_coarse) {
    Values grain{values.width, values.height, std::move(noise)};
    blur(grain, 0.7f);
    noise = std::move(grain.v);
    for (float& n : noise) n *= 2;
  }
  for (std::size_t k = 0; k < noise.size(); ++k)
    values.v[k] += (floor + photons * std::sqrt(std::max(values.v[k], 0.0f) / 255)) * noise[k];
}

using Block = std::array<std::array<float, 8>, 8>;

/// Rows of the cosine transform of eight values.
const Block& cosines() {
  static const Block table = [] {
    Block t{};
    for (std::size_t k = 0; k < 8; ++k)
      for (std::size_t i = 0; i < 8; ++i)
        t[k][i] = (k == 0 ? std::sqrt(0.125f) : 0.5f) *
                  std::cos((2 * static_cast<float>(i) + 1) * static_cast<float>(k) * 0.19634954f);
    return t;
  }();
  return table;
}

/// b := c b c', or c' b c.
Block transformed(const Block& b, bool is_inverse) {
  const Block& c = cosines();
  const auto factor = [&](std::size_t i, std::size_t j) { return is_inverse ? c[j][i] : c[i][j]; };
  Block half{}, out{};
  for (std::size_t i = 0; i < 8; ++i)
    for (std::size_t k = 0; k < 8; ++k)
      for (std::size_t j = 0; j < 8; ++j) half[i][j] += factor(i, k) * b[k][j];
  for (std::size_t i = 0; i < 8; ++i)
    for (std::size_t k = 0; k < 8; ++k)
      for (std::size_t j = 0; j < 8; ++j) out[i][j] += half[i][k] * factor(j, k);
  return out;
}

/// Rounds blocks of 8 x 8 in the cosine domain, high frequencies more coarsely. \param step  of the lowest, grey levels.
void compress(Values& values, float step) {
  for (int y0 = 0; y0 + 8 <= values.height; y0 += 8)
    for (int x0 = 0; x0 + 8 <= values.width; x0 += 8) {
      Block block{};
      for (int y = 0; y < 8; ++y)
        std::copy_n(values.row(y0 + y) + x0, 8, block[static_cast<std::size_t>(y)].begin());
      block = transformed(block, false);
      for (std::size_t i = 0; i < 8; ++i)
        for (std::size_t j = 0; j < 8; ++j) {
          const float unit = step * (1 + 0.6f * static_cast<float>(i + j));
          block[i][j] = unit * std::nearbyint(block[i][j] / unit);
        }
      block = transformed(block, true);
      for (int y = 0; y < 8; ++y)
        std::copy_n(block[static_cast<std::size_t>(y)].begin(), 8, values.row(y0 + y) + x0);
    }
}

}  // namespace

void vary_picture(Image& picture, const FaceBox& face, const PictureVariationTuning& tuning,
                  SampleRandom& random) {
  Values values = with_gamma(picture, std::exp2(random.between(-tuning.gamma_octaves, tuning.gamma_octaves)));
  if (random.chance(tuning.side_light_chance)) {
    const float width = random.between(0.4f, 1.6f) * face.side, low = random.between(tuning.darkest_side, 1);
    shade_side(values, face, width, low, random);
  }
  if (random.chance(tuning.hard_shadow_chance)) {
    const float width = random.between(0.02f, 0.2f) * face.side, low = random.between(0.3f, 0.8f);
    shade_side(values, face, width, low, random);
  }
  expose(values, face, tuning, random);
  const float unit = face.side / 100;
  if (random.chance(tuning.motion_chance)) {
    const float angle = random.between(0, 6.2831853f), way = random.between(1.5f, tuning.motion_px) * unit;
    blur_along(values, {way * std::cos(angle), way * std::sin(angle)});
  } else if (random.chance(tuning.blur_chance)) {
    blur(values, random.between(0.3f, tuning.blur_px) * std::max(unit, 0.6f));
  }
  if (random.chance(tuning.noise_chance)) {
    const float t = random.unit();
    add_noise(values, min(tuning.noise_grey * t * t, tuning.noise_contrast * moments_within(values, face).sd),
              random);
  }
  if (random.chance(tuning.blocks_chance)) compress(values, random.octaves_between(2, 14));
  for (std::size_t k = 0; k < picture.pixels.size(); ++k)
    picture.pixels[k] = static_cast<std::uint8_t>(clamp(values.v[k] + 0.5f, 0, 255));
}

}  // namespace pliant::host::learn
