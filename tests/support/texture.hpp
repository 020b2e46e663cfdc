#pragma once
// Images with known motion. The texture is a finite sum of plane waves, which can be sampled exactly anywhere, so
// that a moved image has no error but rounding and the given noise.
#include <cmath>
#include <cstdint>
#include <vector>

#include "pliant/geometry.hpp"
#include "pliant/pyramid.hpp"

namespace texture {

/// xorshift generator: the same images on every target.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed * 2654435769u + 88172645463325252u) {}
  double uniform(double low = 0, double high = 1) {
    state_ ^= state_ << 13;
    state_ ^= state_ >> 7;
    state_ ^= state_ << 17;
    return low + (high - low) * static_cast<double>(state_ >> 11) / 9007199254740992.0;
  }
  /// Approximately normal: the sum of twelve uniform numbers, bounded at six.
  double normal() {
    double s = -6;
    for (int i = 0; i < 12; ++i) s += uniform();
    return s;
  }

 private:
  std::uint64_t state_;
};

/// Wavelengths of 6 to 60 px, a standard deviation of `contrast` around 125.
class Texture {
 public:
  explicit Texture(std::uint64_t seed, double contrast = 22, int waves = 40) {
    Random random(seed);
    double power = 0;
    for (int i = 0; i < waves; ++i) {
      const double length = 6.0 * std::pow(10.0, random.uniform());
      const double angle = random.uniform(0, 6.283185307), k = 6.283185307 / length;
      waves_.push_back(
          {k * std::cos(angle), k * std::sin(angle), random.uniform(0, 6.283185307), std::sqrt(length)});
      power += 0.5 * length;
    }
    for (Wave& w : waves_) w.amplitude *= contrast / std::sqrt(power);
  }
  double at(double x, double y) const {
    double v = 125;
    for (const Wave& w : waves_) v += w.amplitude * std::cos(w.kx * x + w.ky * y + w.phase);
    return v;
  }

 private:
  struct Wave {
    double kx, ky, phase, amplitude;
  };
  std::vector<Wave> waves_;
};

/// The point x of the unmoved image lies at c + M (x - c) + t in the moved one; c is the middle.
struct Motion {
  double a = 1, b = 0, c = 0, d = 1, tx = 0, ty = 0;
  double gain = 1, bias = 0, noise = 0;
};

struct Picture {
  int width, height;
  std::vector<std::uint8_t> pixels;

  Picture(int w, int h, std::uint8_t value = 0)
      : width(w), height(h), pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), value) {}
  std::uint8_t& at(int x, int y) { return pixels[static_cast<std::size_t>(y * width + x)]; }
  pliant::FrameView frame() const {
    pliant::FrameView f;
    f.data = pixels.data();
    f.width = width;
    f.height = height;
    f.stride_bytes = static_cast<std::size_t>(width);
    return f;
  }
  pliant::ImageView view() const { return {pixels.data(), width, height, width}; }
};

/// Every pixel of its own.
inline Picture noise(int width, int height, std::uint64_t seed) {
  Picture p(width, height);
  Random random(seed);
  for (auto& v : p.pixels) v = static_cast<std::uint8_t>(random.uniform(0, 256));
  return p;
}

inline pliant::Vec2 moved(const Motion& m, const Picture& p, pliant::Vec2 x) {
  const double cx = 0.5 * (p.width - 1), cy = 0.5 * (p.height - 1), u = double(x.x) - cx,
               v = double(x.y) - cy;
  return {static_cast<float>(cx + m.a * u + m.b * v + m.tx),
          static_cast<float>(cy + m.c * u + m.d * v + m.ty)};
}

inline Picture render(const Texture& texture, const Motion& m, int width, int height,
                      std::uint64_t seed = 1) {
  Picture p(width, height);
  Random random(seed);
  const double det = m.a * m.d - m.b * m.c, cx = 0.5 * (width - 1), cy = 0.5 * (height - 1);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double u = x - cx - m.tx, v = y - cy - m.ty;
      double g = m.gain * texture.at(cx + (m.d * u - m.b * v) / det, cy + (m.a * v - m.c * u) / det) + m.bias;
      if (m.noise > 0) g += m.noise * random.normal();
      p.at(x, y) = static_cast<std::uint8_t>(g < 0 ? 0 : g > 255 ? 255 : g + 0.5);
    }
  return p;
}

}  // namespace texture
