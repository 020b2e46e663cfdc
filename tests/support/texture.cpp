#include "texture.hpp"

#include <cmath>

namespace texture {

double Random::uniform(double low, double high) {
  state_ ^= state_ << 13;
  state_ ^= state_ >> 7;
  state_ ^= state_ << 17;
  return low + (high - low) * static_cast<double>(state_ >> 11) / 9007199254740992.0;
}

double Random::normal() {
  double s = -6;
  for (int i = 0; i < 12; ++i) s += uniform();
  return s;
}

Texture::Texture(std::uint64_t seed, double contrast, int waves) {
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

double Texture::at(double x, double y) const {
  double v = 125;
  for (const Wave& w : waves_) v += w.amplitude * std::cos(w.kx * x + w.ky * y + w.phase);
  return v;
}

void Texture::along(double x, double y, double dx, double dy, std::vector<double>* values) const {
  for (double& v : *values) v = 125;
  for (const Wave& w : waves_) {
    // A wave is a phasor that turns by the same angle from point to point.
    const double first = w.kx * x + w.ky * y + w.phase, step = w.kx * dx + w.ky * dy;
    const double c = std::cos(step), s = std::sin(step);
    double real = w.amplitude * std::cos(first), imaginary = w.amplitude * std::sin(first);
    for (double& v : *values) {
      v += real;
      const double turned = c * real - s * imaginary;
      imaginary = s * real + c * imaginary;
      real = turned;
    }
  }
}

Picture noise(int width, int height, std::uint64_t seed) {
  Picture p(width, height);
  Random random(seed);
  for (auto& v : p.pixels) v = static_cast<std::uint8_t>(random.uniform(0, 256));
  return p;
}

Picture render(const Texture& texture, const Motion& m, int width, int height, std::uint64_t seed) {
  Picture p(width, height);
  Random random(seed);
  std::vector<double> values(static_cast<std::size_t>(width));
  const double det = m.a * m.d - m.b * m.c, cx = 0.5 * (width - 1), cy = 0.5 * (height - 1);
  for (int y = 0; y < height; ++y) {
    const double u = -cx - m.tx, v = y - cy - m.ty;
    texture.along(cx + (m.d * u - m.b * v) / det, cy + (m.a * v - m.c * u) / det, m.d / det, -m.c / det, &values);
    for (int x = 0; x < width; ++x) {
      double g = m.gain * values[static_cast<std::size_t>(x)] + m.bias;
      if (m.noise > 0) g += m.noise * random.normal();
      p.at(x, y) = static_cast<std::uint8_t>(g < 0 ? 0 : g > 255 ? 255 : g + 0.5);
    }
  }
  return p;
}

}  // namespace texture
