#pragma once
// Images with known motion. The texture is a finite sum of plane waves, which can be sampled exactly anywhere, so
// that a moved image has no error but rounding and the given noise. Compiled with optimisation, which the tests are not.
#include <cstdint>
#include <vector>

#include "pliant/geometry.hpp"
#include "pliant/pyramid.hpp"

namespace texture {

/// xorshift generator: the same images on every target.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed * 2654435769u + 88172645463325252u) {}
  double uniform(double low = 0, double high = 1);
  /// Approximately normal: the sum of twelve uniform numbers, bounded at six.
  double normal();

 private:
  std::uint64_t state_;
};

/// Wavelengths of 6 to 60 px, a standard deviation of `contrast` around 125.
class Texture {
 public:
  explicit Texture(std::uint64_t seed, double contrast = 22, int waves = 40);
  double at(double x, double y) const;
  /// As many values as there is room for, from (x, y) on, each at (dx, dy) from the one before: those of `at`, to rounding.
  void along(double x, double y, double dx, double dy, std::vector<double>* values) const;

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
Picture noise(int width, int height, std::uint64_t seed);

inline pliant::Vec2 moved(const Motion& m, const Picture& p, pliant::Vec2 x) {
  const double cx = 0.5 * (p.width - 1), cy = 0.5 * (p.height - 1), u = double(x.x) - cx,
               v = double(x.y) - cy;
  return {static_cast<float>(cx + m.a * u + m.b * v + m.tx),
          static_cast<float>(cy + m.c * u + m.d * v + m.ty)};
}

/// The texture, moved; noise by the seed.
Picture render(const Texture& texture, const Motion& m, int width, int height, std::uint64_t seed = 1);

}  // namespace texture
