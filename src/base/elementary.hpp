#pragma once
// Elementary functions in double from + - * / only: the same bits on every target. For tables computed at set-up and for
// initial values, not for inner loops.

namespace pliant {

/// Correctly rounded square root; 0 for negative x, NaN for NaN.
double square_root(double x);
/// ln x for normal x > 0, to 1e-14.
double natural_log(double x);
/// e^x, x in [-700, 700], to 1e-14 relative.
double exponential(double x);
/// Standard normal quantile of p in (0,1), absolute error below 4.5e-4 (Abramowitz & Stegun 26.2.23).
double normal_quantile(double p);
/// tanh x, absolute error below 2e-4 (a Pade quotient; constant beyond +-4.9).
float hyperbolic_tangent(float x);

/// x = mantissa * 2^exponent, mantissa in [0.5, 1), for normal x > 0.
double split_exponent(double x, int& exponent);

}  // namespace pliant
