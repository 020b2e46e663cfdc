#include "host/learn/aligner_check.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "host/learn/aligner_evidence.hpp"
#include "host/learn/parallel.hpp"

namespace pliant::host::learn {

namespace {

constexpr double kByteUnit = 1.0 / 64;  // of a block's bytes in the regression: most are then near 1

/// Weights of the appearance: bytes and a constant a landmark.
struct Appearance {
  std::vector<float> rows, bias;
};

float dot_row(const float* row, const std::uint8_t* block, std::size_t bytes) {
  float sum = 0;
  for (std::size_t i = 0; i < bytes; ++i) sum += row[i] * static_cast<float>(block[i]);
  return sum;
}

/// What a landmark adds to the appearance. \param mirrored  index of the landmark on the other side, a landmark.
float score_of(const Appearance& a, const Evidence& e, const std::vector<std::size_t>& mirrored,
               std::size_t k) {
  const std::size_t bytes = e.blocks.size() / e.weights.size();
  const float left = dot_row(a.rows.data() + k * bytes, e.blocks.data() + k * bytes, bytes);
  const float right =
      dot_row(a.rows.data() + mirrored[k] * bytes, e.mirrored_blocks.data() + k * bytes, bytes);
  return e.weights[k] * ((1 - e.gate) * left + e.gate * right + a.bias[k]);
}

/// The appearance.
double score_of(const Appearance& a, const Evidence& e, const std::vector<std::size_t>& mirrored) {
  float sum = 0;
  for (std::size_t k = 0; k < e.weights.size(); ++k) sum += score_of(a, e, mirrored, k);
  return static_cast<double>(sum);
}

void add_row(float by, const std::uint8_t* block, std::size_t bytes, float* row) {
  for (std::size_t i = 0; i < bytes; ++i) row[i] += by * static_cast<float>(block[i]);
}

/// What an appearance is learnt from.
struct Examples {
  std::vector<const Evidence*> evidence;
  std::vector<float> labels;   // probabilities that it is a face, aligned right
  std::vector<double> before;  // what is added to the sums that are learnt; none: 0

  void add(const Evidence& e, float label) {
    evidence.push_back(&e);
    labels.push_back(label);
  }
};

/// Logistic regression by stochastic gradient descent, the mean of the second half of the way.
Appearance learn_appearance(const Examples& from, const std::vector<std::size_t>& mirrored,
                            std::uint64_t seed, const AlignerCheckTuning& tuning) {
  const std::vector<const Evidence*>& examples = from.evidence;
  const std::vector<float>& labels = from.labels;
  const std::size_t landmarks = examples[0]->weights.size(), bytes = examples[0]->blocks.size() / landmarks;
  Appearance now{std::vector<float>(landmarks * bytes), std::vector<float>(landmarks)}, mean = now;
  double positives = 0;
  for (const float l : labels) positives += static_cast<double>(l);
  const double balance[2] = {
      0.5 * static_cast<double>(labels.size()) / (static_cast<double>(labels.size()) - positives),
      0.5 * static_cast<double>(labels.size()) / positives};
  const std::size_t steps = examples.size() * static_cast<std::size_t>(tuning.rounds);
  SampleRandom random(seed, 77);
  // The rows are kept as `scale` times `now`, so that their shrinking costs nothing.
  double scale = 1, averaged = 0;
  const double unit = kByteUnit * kByteUnit;
  for (std::size_t t = 0; t < steps; ++t) {
    const std::size_t e = random.below(examples.size());
    const Evidence& x = *examples[e];
    const double rate = 0.02 / (1 + 0.02 * tuning.regularisation * 2e3 * static_cast<double>(t));
    const double before = from.before.empty() ? 0 : from.before[e];
    const double z = before + scale * score_of(now, x, mirrored);
    const double label = static_cast<double>(labels[e]);
    const double slope = (label - 1 / (1 + std::exp(-z))) * balance[label > 0.5 ? 1 : 0];
    scale *= 1 - rate * tuning.regularisation;
    if (std::abs(slope) > 1e-3) {
      const auto by = static_cast<float>(rate * slope * unit / scale);
      for (std::size_t k = 0; k < landmarks; ++k) {
        const float w = by * x.weights[k];
        add_row(w * (1 - x.gate), x.blocks.data() + k * bytes, bytes, now.rows.data() + k * bytes);
        add_row(w * x.gate, x.mirrored_blocks.data() + k * bytes, bytes,
                now.rows.data() + mirrored[k] * bytes);
        now.bias[k] += w / static_cast<float>(kByteUnit);
      }
    }
    if (t >= steps / 2 && t % 64 == 0) {
      averaged += 1;
      for (std::size_t k = 0; k < now.rows.size(); ++k)
        mean.rows[k] += static_cast<float>(scale) * now.rows[k];
      for (std::size_t k = 0; k < now.bias.size(); ++k)
        mean.bias[k] += static_cast<float>(scale) * now.bias[k];
    }
  }
  for (float& w : mean.rows) w /= static_cast<float>(averaged);
  for (float& w : mean.bias) w /= static_cast<float>(averaged);
  return mean;
}

using Features = std::vector<double>;  // kCheckFeatures of them
using FeaturesOf = Features (*)(const Evidence&);

Features features_of(const Evidence& e) {
  return {1, e.appearance, static_cast<double>(e.displacement), static_cast<double>(e.parameters)};
}

/// The same with the text form added to the appearance, whatever its sign. A curve fitted to what the library adds was not tried.
Features features_with_text(const Evidence& e) {
  return {1, e.appearance + e.text, static_cast<double>(e.displacement), static_cast<double>(e.parameters)};
}

/// Weighted least squares of `wanted` by the features.
std::vector<double> solve_features(const std::vector<const Evidence*>& examples, FeaturesOf features,
                                   const std::vector<double>& wanted, const std::vector<double>& weight) {
  constexpr int n = kCheckFeatures;
  double h[n][n + 1] = {};
  for (std::size_t e = 0; e < examples.size(); ++e) {
    const Features f = features(*examples[e]);
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) h[i][j] += weight[e] * f[i] * f[j];
      h[i][n] += weight[e] * f[i] * wanted[e];
    }
  }
  for (int i = 0; i < n; ++i) {  // Gauss-Jordan; the matrix is positive definite
    h[i][i] += 1e-9;
    for (int r = 0; r < n; ++r) {
      if (r == i) continue;
      const double by = h[r][i] / h[i][i];
      for (int c = i; c <= n; ++c) h[r][c] -= by * h[i][c];
    }
  }
  std::vector<double> out;
  for (int i = 0; i < n; ++i) out.push_back(h[i][n] / h[i][i]);
  return out;
}

double weighted_sum(const std::vector<double>& w, const Features& f) {
  double sum = 0;
  for (std::size_t k = 0; k < w.size(); ++k) sum += w[k] * f[k];
  return sum;
}

/// Logistic regression on the features by Newton's method, faces and others with the same total weight.
AlignerCurve score_curve(const std::vector<const Evidence*>& examples, const std::vector<float>& labels) {
  double positives = 0;
  for (const float l : labels) positives += static_cast<double>(l);
  const double n = static_cast<double>(labels.size());
  std::vector<double> w(kCheckFeatures);
  for (int round = 0; round < 30; ++round) {
    std::vector<double> wanted(labels.size()), weight(labels.size());
    for (std::size_t e = 0; e < labels.size(); ++e) {
      const double z = std::clamp(weighted_sum(w, features_with_text(*examples[e])), -12.0, 12.0),
                   p = 1 / (1 + std::exp(-z));
      const double slope = std::max(p * (1 - p), 1e-5);
      wanted[e] = z + 0.7 * (static_cast<double>(labels[e]) - p) / slope;
      weight[e] = slope * (labels[e] > 0.5f ? n / positives : n / (n - positives));
    }
    w = solve_features(examples, features_with_text, wanted, weight);
  }
  AlignerCurve curve{};
  for (std::size_t k = 0; k < w.size(); ++k) curve.weight[k] = static_cast<float>(w[k]);
  curve.low = -12;
  curve.high = 12;
  for (int k = 0; k < kCheckKnots; ++k)
    curve.at[k] = static_cast<float>(1 / (1 + std::exp(-(-12 + 24.0 * k / (kCheckKnots - 1)))));
  return curve;
}

/// The value below which a fraction of the weight lies. \pre 0 <= fraction < 1, no weight is below 0, not all are 0.
double weighted_quantile(const std::vector<double>& values, const std::vector<double>& weight,
                         double fraction) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  double left = fraction * std::accumulate(weight.begin(), weight.end(), 0.0);
  std::size_t k = 0;
  while (k + 1 < order.size() && left > weight[order[k]]) left -= weight[order[k++]];
  return values[order[k]];
}

/// The mean error as a function of a sum of features. The sum is fitted to the error's logarithm, so that small errors are told
/// apart as well as large ones.
AlignerCurve error_curve(const std::vector<const Evidence*>& faces, const AlignerCheckTuning& tuning) {
  std::vector<double> error, wanted, weight, sums;
  for (const Evidence* e : faces) {
    error.push_back(std::min(static_cast<double>(e->error), tuning.most_error));
    wanted.push_back(std::log2(std::max(error.back(), tuning.least_error)));
    weight.push_back(e->is_moved ? tuning.moved_weight : 1);
  }
  const std::vector<double> w = solve_features(faces, features_of, wanted, weight);
  AlignerCurve curve{};
  for (std::size_t k = 0; k < w.size(); ++k) curve.weight[k] = static_cast<float>(w[k]);
  for (const Evidence* e : faces) sums.push_back(weighted_sum(w, features_of(*e)));
  curve.low = static_cast<float>(weighted_quantile(sums, weight, 0.01));
  curve.high = static_cast<float>(weighted_quantile(sums, weight, 0.99));
  // Means around each knot, then a running maximum.
  const double step = static_cast<double>(curve.high - curve.low) / (kCheckKnots - 1);
  double least = 0;
  for (int k = 0; k < kCheckKnots; ++k) {
    double sum = 0, total = 0;
    const double at = static_cast<double>(curve.low) + step * k;
    for (std::size_t e = 0; e < faces.size(); ++e) {
      const bool is_beyond = (k == 0 && sums[e] < at) || (k == kCheckKnots - 1 && sums[e] > at);
      const double near = weight[e] * (is_beyond ? 1 : std::max(0.0, 1 - std::abs(sums[e] - at) / step));
      sum += near * error[e];
      total += near;
    }
    if (total > 0) least = std::max(least, sum / total);
    curve.at[k] = static_cast<float>(least);
  }
  return curve;
}

/// What a part's appearance is on faces that are aligned right.
void learn_part(const std::vector<const Evidence*>& right, std::size_t part, LearntCheck* check) {
  double sum = 0, weight = 0, squares = 0;
  for (const Evidence* e : right) {
    sum += e->part[part];
    weight += e->part_weight[part];
  }
  const double mean = sum / std::max(weight, 1.0);
  for (const Evidence* e : right) squares += std::pow(e->part[part] - mean * e->part_weight[part], 2);
  const double variance = squares / static_cast<double>(std::max<std::size_t>(right.size(), 1));
  check->part_mean[part] = static_cast<float>(mean);
  check->part_scale[part] = static_cast<float>(1 / std::sqrt(std::max(variance, 1e-6)));
}

/// The examples of verification, and what is learnt from them.
class CheckLearning {
 public:
  CheckLearning(const AlignerCascade& cascade, const AlignerCheckTuning& tuning)
      : options_(cascade.options()), tuning_(tuning) {
    const OpenAlignerTable table(cascade.table(cascade.folds()));
    for (std::size_t k = 0; k < table->landmark_count(); ++k) {
      mirrored_.push_back(table->mirrored(k));
      part_.push_back(static_cast<std::size_t>(part_of_landmark(table->landmark_numbers()[k])));
    }
  }

  void add(std::vector<Evidence> more) { std::move(more.begin(), more.end(), std::back_inserter(all_)); }

  /// Learns the appearance: without each half of the people and of the parts of other pictures, and of all. A picture has parts in
  /// both halves, so that what is no face is told by weights that know other parts of it.
  void learn() {
    choose_examples();
    run_parallel(options_.threads, 3, [&](std::size_t k, std::size_t) {
      Examples chosen;
      for (std::size_t e = 0; e < examples_.size(); ++e)
        if (examples_[e]->half != static_cast<int>(k)) chosen.add(*examples_[e], labels_[e]);
      learnt_[k] = learn_appearance(chosen, mirrored_, options_.seed + k, tuning_);
    });
  }

  /// Learns the text form from drawn pictures, which are no faces. The other examples' labels are what was learnt of them: without
  /// that, verification told the error of covered faces worse (docs/experiments.md, Text).
  void learn_drawn(const std::vector<Evidence>& drawn) {
    run_parallel(options_.threads, 3, [&](std::size_t k, std::size_t) {
      Examples chosen;
      const auto add = [&](const Evidence& e, bool is_drawn) {
        if (e.half == static_cast<int>(k)) return;
        const double z = score_of(learnt_[k], e, mirrored_);
        chosen.before.push_back(z);
        chosen.add(e, is_drawn ? 0 : static_cast<float>(1 / (1 + std::exp(-z))));
      };
      for (const Evidence* e : examples_) add(*e, false);
      for (const Evidence& e : drawn) add(e, true);
      text_[k] = learn_appearance(chosen, mirrored_, options_.seed + k, tuning_);
    });
  }

  /// The appearance by the weights that were learnt without the example's half.
  double score(const Evidence& e) const { return score_of(learnt_[e.half], e, mirrored_); }

  LearntCheck conclude() {
    run_parallel(options_.threads, all_.size(), [&](std::size_t k, std::size_t) { score_parts(&all_[k]); });
    std::vector<const Evidence*> faces, right;
    for (const Evidence& e : all_) {
      if (!e.is_face || e.error < 0) continue;
      faces.push_back(&e);
      if (e.error <= tuning_.right_error) right.push_back(&e);
    }
    LearntCheck check;
    check.score = score_curve(examples_, labels_);
    check.error = error_curve(faces, tuning_);
    for (std::size_t p = 0; p < kFaceParts; ++p) learn_part(right, p, &check);
    check.rows.assign(learnt_[2].rows.begin(), learnt_[2].rows.end());
    check.bias.assign(learnt_[2].bias.begin(), learnt_[2].bias.end());
    check.text_rows.assign(text_[2].rows.begin(), text_[2].rows.end());
    check.text_bias.assign(text_[2].bias.begin(), text_[2].bias.end());
    return check;
  }

 private:
  /// The appearance, each part's, and the text form.
  void score_parts(Evidence* e) const {
    float sum = 0;
    for (std::size_t k = 0; k < e->weights.size(); ++k) {
      const float of_landmark = score_of(learnt_[e->half], *e, mirrored_, k);
      sum += of_landmark;
      e->part[part_[k]] += static_cast<double>(of_landmark);
      e->part_weight[part_[k]] += static_cast<double>(e->weights[k]);
    }
    e->appearance = static_cast<double>(sum);
    e->text = text_[e->half].rows.empty() ? 0 : score_of(text_[e->half], *e, mirrored_);
  }

  void choose_examples() {
    examples_.clear();
    labels_.clear();
    for (const Evidence& e : all_) {
      if (e.error < 0 || (e.error > tuning_.right_error && e.error < tuning_.wrong_error)) continue;
      examples_.push_back(&e);
      labels_.push_back(e.error <= tuning_.right_error ? 1.0f : 0.0f);
    }
  }

  LearnOptions options_;
  AlignerCheckTuning tuning_;
  std::vector<std::size_t> mirrored_, part_;  // a landmark
  std::vector<Evidence> all_;
  std::vector<const Evidence*> examples_;
  std::vector<float> labels_;
  // Without each half, and of all. The text forms are empty if there are no drawn pictures.
  Appearance learnt_[3], text_[3];
};

}  // namespace

LearntCheck learn_check(AlignerCascade& cascade, const OtherPictures& others, const OtherPictures& drawn,
                        const std::vector<std::uint8_t>& detector, const LearnProgress& progress,
                        const AlignerCheckTuning& tuning) {
  const auto per_face = [&](double ratio) {
    return static_cast<std::size_t>(ratio * static_cast<double>(cascade.examples().size()));
  };
  const auto tell = [&](std::size_t done) {
    if (progress) progress("alignment: verification", done, 6);
  };
  EvidenceCollector collector(cascade, tuning);
  CheckLearning learning(cascade, tuning);
  tell(0);
  learning.add(collector.of_faces());
  tell(1);
  if (others.count() > 0) {
    const std::size_t first = per_face(tuning.others_per_face);
    learning.add(collector.of_others(others, 0, first, [](const Evidence&) { return true; }));
    tell(2);
    if (!detector.empty())
      learning.add(collector.of_found(others, detector, per_face(tuning.searches_per_face)));
    tell(3);
    learning.learn();
    tell(4);
    learning.add(collector.of_others(others, first, per_face(tuning.mined_per_face), [&](const Evidence& e) {
      return learning.score(e) > tuning.mined_score;
    }));
  }
  tell(5);
  learning.learn();
  if (drawn.count() > 0 && !detector.empty())
    learning.learn_drawn(collector.of_found(drawn, detector, per_face(tuning.drawn_per_face)));
  return learning.conclude();
}

}  // namespace pliant::host::learn
