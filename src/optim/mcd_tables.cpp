// Chi-square and the correction factors of the minimum covariance determinant (docs/algorithms.md, section 6.4). They are
// computed, not stored: for any fraction h/n and any number of columns, in a few microseconds a call of the estimator.
#include "base/elementary.hpp"
#include "base/integers.hpp"
#include "pliant/outliers.hpp"

namespace pliant {

std::size_t mcd_subset_size(std::size_t rows, std::size_t columns, double alpha) {
  const std::size_t middle = (rows + columns + 1) / 2;
  if (middle >= rows) return rows;
  const double h = 2.0 * static_cast<double>(middle) - static_cast<double>(rows) +
                   2.0 * static_cast<double>(rows - middle) * alpha;
  const auto floor = static_cast<std::size_t>(h);
  return smaller(floor, rows);
}

namespace {

/// ln Gamma(1 + k/2), by the products that half-integers have.
double log_gamma_half(std::size_t k) {
  constexpr double kHalfLogPi = 0.572364942924700087072;
  double sum = k % 2 == 0 ? 0.0 : kHalfLogPi;  // Gamma(1) or Gamma(1/2)
  for (double a = k % 2 == 0 ? 1.0 : 0.5; a < 0.5 * static_cast<double>(k) + 0.75; a += 1)
    sum += natural_log(a);
  return sum;
}

double density(std::size_t freedom, double x) {  // of chi-square
  const double a = 0.5 * static_cast<double>(freedom);
  return exponential(a * natural_log(0.5 * x) - 0.5 * x - log_gamma_half(freedom)) * a / x;
}

}  // namespace

double chi_square_probability(std::size_t freedom, double x) {
  if (!(x > 0)) return 0;
  if (x > 400) return 1;
  const double a = 0.5 * static_cast<double>(freedom), y = 0.5 * x;
  double term = 1, sum = 1;  // y^a e^-y / Gamma(a + 1) times 1 + y/(a+1) + y^2/((a+1)(a+2)) + ...
  for (int k = 1; k <= 1000 && term > 1e-17 * sum; ++k) {
    term *= y / (a + k);
    sum += term;
  }
  const double p = exponential(a * natural_log(y) - y - log_gamma_half(freedom)) * sum;
  return p < 1 ? p : 1;
}

double chi_square_quantile(std::size_t freedom, double probability) {
  double low = 0, high = 400;
  const double f = static_cast<double>(freedom), spread = 2 / (9 * f);
  const double w = 1 - spread + normal_quantile(probability) * square_root(spread);
  double x = f * w * w * w;  // Wilson and Hilferty
  if (!(x > 1e-8)) x = 1e-8;
  for (int k = 0; k < 80; ++k) {  // Newton inside a shrinking bracket
    const double excess = chi_square_probability(freedom, x) - probability;
    (excess > 0 ? high : low) = x;
    double next = x - excess / density(freedom, x);
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    const double change = next - x;
    x = next;
    if ((change < 0 ? -change : change) <= 1e-13 * x) break;
  }
  return x;
}

double mcd_consistency_factor(std::size_t columns, double fraction) {
  if (fraction >= 1) return 1;
  return fraction / chi_square_probability(columns + 2, chi_square_quantile(columns, fraction));
}

namespace {

/// f(n) = 1 - e^a / n^b.
struct Curve {
  double a, b;
};
/// For p >= 3: -gamma / p^beta at q = 2 and q = 3 times p^2.
struct Fit {
  double gamma2, beta2, gamma3, beta3;
};

Curve curve(const Fit& fit, std::size_t columns) {
  const double log_p = natural_log(static_cast<double>(columns));
  const double y2 = natural_log(-fit.gamma2) - fit.beta2 * log_p;
  const double y3 = natural_log(-fit.gamma3) - fit.beta3 * log_p;
  const double x2 = natural_log(2) + 2 * log_p, x3 = natural_log(3) + 2 * log_p;
  const double b = (y2 - y3) / (x3 - x2);
  return {y2 + b * x2, b};
}

double small_sample(std::size_t rows, double alpha, Curve half, Curve eighths) {
  const double log_n = natural_log(static_cast<double>(rows));
  const double f5 = 1 - exponential(half.a - half.b * log_n);
  const double f8 = 1 - exponential(eighths.a - eighths.b * log_n);
  const double f =
      alpha <= 0.875 ? f5 + (f8 - f5) * (alpha - 0.5) / 0.375 : f8 + (1 - f8) * (alpha - 0.875) / 0.125;
  return f > 0.05 ? 1 / f : 20.0;  // the fit means nothing for a handful of rows in many columns
}

constexpr Fit kRawHalf{-1.42764571687802, 1.26263336932151, -1.06141115981725, 1.28907991440387};
constexpr Fit kRawEighths{-0.455179464070565, 1.11192541278794, -0.294241208320834, 1.09649329149811};
constexpr Fit kReweightedHalf{-1.02842572724793, 1.67659883081926, -0.26800273450853, 1.35968562893582};
constexpr Fit kReweightedEighths{-0.544482443573914, 1.25994483222292, -0.343791072183285, 1.25159004257133};

}  // namespace

double mcd_small_sample_raw(std::size_t rows, std::size_t columns, double alpha) {
  switch (columns) {
    case 1:
      return small_sample(rows, alpha, {0.262024211897096, 0.604756680630497},
                          {-0.351584646688712, 1.01646567502486});
    case 2:
      return small_sample(rows, alpha, {0.673292623522027, 0.691365864961895},
                          {0.446537815635445, 1.06690782995919});
    default:
      return small_sample(rows, alpha, curve(kRawHalf, columns), curve(kRawEighths, columns));
  }
}

double mcd_small_sample_reweighted(std::size_t rows, std::size_t columns, double alpha) {
  switch (columns) {
    case 1:
      return small_sample(rows, alpha, {1.11098143415027, 1.5182890270453},
                          {-0.66046776772861, 0.88939595831888});
    case 2:
      return small_sample(rows, alpha, {3.11101712909049, 1.91401056721863},
                          {0.79473550581058, 1.10081930350091});
    default:
      return small_sample(rows, alpha, curve(kReweightedHalf, columns), curve(kReweightedEighths, columns));
  }
}

}  // namespace pliant
