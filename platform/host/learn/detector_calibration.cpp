#include "host/learn/detector_calibration.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "host/learn/detector_windows.hpp"
#include "host/learn/parallel.hpp"
#include "host/learn/sample_random.hpp"

namespace pliant::host::learn {

namespace {

constexpr double kFrames = 1000;  // searched for hits, without faces
constexpr int kFrameWidth = 320, kFrameHeight = 240;
constexpr std::uint64_t kStream = 14;
constexpr double kSurest = 0.998;  // probability at the last knot

}  // namespace

double Calibration::probability(double sum) const {
  return 1 / (1 + std::exp(-(slope * sum + offset)));
}

Calibration fit_calibration(const std::vector<WeightedSum>& faces, const std::vector<WeightedSum>& others) {
  // Newton's method on standardised sums, with a weak prior on the slope so that separable classes have a solution.
  double n = 0, mean = 0, square = 0;
  for (const auto* all : {&faces, &others})
    for (const WeightedSum& s : *all) {
      n += s.weight;
      mean += s.weight * s.sum;
      square += s.weight * s.sum * s.sum;
    }
  mean /= n;
  const double sd = std::max(1.0, std::sqrt(square / n - mean * mean));
  constexpr double kPrior = 1e-3;
  double a = 1, b = 0;
  for (int iteration = 0; iteration < 50; ++iteration) {
    double ga = -kPrior * (a - 1), gb = 0, haa = kPrior, hab = 0, hbb = 1e-9;
    for (const auto* all : {&faces, &others})
      for (const WeightedSum& s : *all) {
        const double x = (s.sum - mean) / sd, p = 1 / (1 + std::exp(-(a * x + b)));
        const double e = s.weight / n * ((all == &faces ? 1 : 0) - p), w = s.weight / n * p * (1 - p);
        ga += e * x;
        gb += e;
        haa += w * x * x;
        hab += w * x;
        hbb += w;
      }
    const double det = haa * hbb - hab * hab;
    const double da = (hbb * ga - hab * gb) / det, db = (haa * gb - hab * ga) / det;
    const double step = std::min(1.0, 2 / std::max(std::abs(da), std::abs(db)));
    a += step * da;
    b += step * db;
  }
  a = std::max(a, 0.1);
  return {a / sd, b - a * mean / sd};
}

std::vector<int> best_sums_without_faces(const std::vector<DetectorTree>& trees, const OtherPictures& others,
                                         const LearnOptions& options) {
  std::vector<Image> pictures;
  for (std::size_t k = 0; k < others.count(); ++k)
    if (calibrates(k, others.count()) || others.count() < kFewPictures) pictures.push_back(others.picture(k));
  const OtherPictures kept(pictures);
  const auto frames = static_cast<std::size_t>(std::max(50.0, std::min(1.0, options.effort) * kFrames));
  std::vector<int> best(frames, kRejected);
  run_parallel(options.threads, frames, [&](std::size_t k, std::size_t) {
    SampleRandom random(options.seed + kStream, k);
    for (const WindowHit& hit : find_hits(kept.crop(kFrameWidth, kFrameHeight, random), trees))
      best[k] = std::max(best[k], hit.sum);
  });
  return best;
}

Calibration calibrate(const std::vector<int>& faces, const std::vector<int>& others, int least) {
  // One false hit more than there are, so that a rate of zero is not taken for impossible.
  const double face = 1 / static_cast<double>(faces.size()), other = 1 / static_cast<double>(others.size());
  std::vector<WeightedSum> face_sums, other_sums{{static_cast<double>(least), other}};
  for (const int sum : others)
    if (sum >= least) other_sums.push_back({static_cast<double>(sum), other});
  for (const int sum : faces)
    if (sum >= least) face_sums.push_back({static_cast<double>(sum), face});
  return face_sums.empty() ? Calibration{} : fit_calibration(face_sums, other_sums);
}

void set_knots(const Calibration& calibration, int least_sum, DetectorHeader* header) {
  const double first = calibration.probability(least_sum);
  const auto logit = [](double p) { return std::log(p / (1 - p)); };
  const double reach =
      calibration.slope > 0 ? (logit(kSurest) - logit(std::min(first, 0.9))) / calibration.slope : 0;
  const int step = std::clamp(static_cast<int>(std::lround(reach / (kScoreKnots - 1))), 1, 2000);
  for (int k = 0; k < kScoreKnots; ++k) {
    const int sum = std::clamp(least_sum, -32768, 32767 - kScoreKnots * 2000) + k * step;
    header->knot_sum[k] = static_cast<std::int16_t>(sum);
    header->knot_probability[k] =
        static_cast<std::uint16_t>(std::lround(65535 * calibration.probability(sum)));
  }
}

}  // namespace pliant::host::learn
