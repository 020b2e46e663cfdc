#include "base/elementary.hpp"

#include <cstdint>
#include <cstring>

namespace pliant {

namespace {
constexpr double kLn2 = 0.693147180559945309417;
}

double square_root(double x) {
  return x <= 0 ? 0.0 : __builtin_sqrt(x);  // one instruction where there is one: no libm to link
}

double split_exponent(double x, int& exponent) {
  std::uint64_t bits;
  std::memcpy(&bits, &x, sizeof bits);
  exponent = static_cast<int>((bits >> 52) & 0x7ff) - 1022;
  bits = (bits & 0x800fffffffffffffull) | (std::uint64_t{1022} << 52);
  std::memcpy(&x, &bits, sizeof x);
  return x;
}

double natural_log(double x) {
  int e;
  double m = split_exponent(x, e);
  if (m < 0.70710678118654752) {
    m *= 2;
    --e;
  }
  const double s = (m - 1) / (m + 1), s2 = s * s;  // ln m = 2 artanh s, |s| < 0.172
  double sum = 0;
  for (int k = 21; k >= 1; k -= 2) sum = sum * s2 + 1.0 / k;
  return 2 * s * sum + e * kLn2;
}

double exponential(double x) {
  const double quotient = x / kLn2;
  const int e = static_cast<int>(quotient < 0 ? quotient - 0.5 : quotient + 0.5);
  const double r = x - e * kLn2;  // |r| <= 0.35
  double sum = 1;
  for (int k = 16; k >= 1; --k) sum = 1 + sum * r / k;
  const std::uint64_t bits = static_cast<std::uint64_t>(1023 + e) << 52;
  double power;
  std::memcpy(&power, &bits, sizeof power);
  return sum * power;
}

double normal_quantile(double p) {
  const bool lower = p < 0.5;
  const double t = square_root(-2 * natural_log(lower ? p : 1 - p));
  const double x =
      t - (2.515517 + t * (0.802853 + t * 0.010328)) / (1 + t * (1.432788 + t * (0.189269 + t * 0.001308)));
  return lower ? -x : x;
}

float hyperbolic_tangent(float x) {
  const float v = x > 4.9f ? 4.9f : (x < -4.9f ? -4.9f : x), s = v * v;
  return v * (135135.0f + s * (17325.0f + s * (378.0f + s))) /
         (135135.0f + s * (62370.0f + s * (3150.0f + s * 28.0f)));
}

}  // namespace pliant
