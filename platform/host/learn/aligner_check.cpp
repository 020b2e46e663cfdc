#include "host/learn/aligner_check.hpp"

#include <algorithm>
#include <cmath>

#include "face/box_view.hpp"
#include "pliant/face_detector.hpp"

namespace pliant::host::learn {

namespace {

constexpr double kByteUnit = 1.0 / 64;  // of a block's bytes in the regression: most are then near 1

/// One alignment as the check sees it.
struct Evidence {
  std::vector<std::uint8_t> blocks;  // of all landmarks
  std::vector<std::uint8_t> mirrored_blocks;
  std::vector<float> weights;  // a landmark
  float gate = 0.5f;
  float displacement = 0, parameters = 0;
  float error = 0;  // of the landmarks; 1 where there is no face
  int half = 0;     // examples of one half are scored by weights learnt from the other
  double appearance = 0;
  bool is_face = true;
};

/// Weights of the appearance: bytes and a constant a landmark.
struct Appearance {
  std::vector<float> rows, bias;
};

float dot_row(const float* row, const std::uint8_t* block, std::size_t bytes) {
  float sum = 0;
  for (std::size_t i = 0; i < bytes; ++i) sum += row[i] * static_cast<float>(block[i]);
  return sum;
}

/// The appearance. \param mirrored  index of the landmark on the other side, a landmark.
double score_of(const Appearance& a, const Evidence& e, const std::vector<std::size_t>& mirrored) {
  const std::size_t landmarks = e.weights.size(), bytes = e.blocks.size() / landmarks;
  float sum = 0;
  for (std::size_t k = 0; k < landmarks; ++k) {
    const float left = dot_row(a.rows.data() + k * bytes, e.blocks.data() + k * bytes, bytes);
    const float right =
        dot_row(a.rows.data() + mirrored[k] * bytes, e.mirrored_blocks.data() + k * bytes, bytes);
    sum += e.weights[k] * ((1 - e.gate) * left + e.gate * right + a.bias[k]);
  }
  return static_cast<double>(sum);
}

void add_row(float by, const std::uint8_t* block, std::size_t bytes, float* row) {
  for (std::size_t i = 0; i < bytes; ++i) row[i] += by * static_cast<float>(block[i]);
}

/// Logistic regression by stochastic gradient descent, the mean of the second half of the way.
Appearance learn_appearance(const std::vector<const Evidence*>& examples, const std::vector<float>& labels,
                            const std::vector<std::size_t>& mirrored, std::uint64_t seed,
                            const AlignerCheckTuning& tuning) {
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
    const double z = scale * score_of(now, x, mirrored);
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

/// Collects the evidence of alignments.
class EvidenceCollector {
 public:
  EvidenceCollector(AlignerCascade& cascade, const AlignerCheckTuning& tuning)
      : cascade_(cascade), tuning_(tuning) {
    for (int f = 0; f <= cascade.folds(); ++f)
      tables_.push_back(std::make_unique<OpenAlignerTable>(cascade.table(f)));
  }

  /// Alignments of faces, and poses moved away from them.
  std::vector<Evidence> of_faces() {
    const std::size_t each = 1 + static_cast<std::size_t>(tuning_.moved_starts),
                      n = cascade_.examples().size();
    std::vector<Evidence> out(n * each);
    in_parallel(n * each, cascade_.options().threads, [&](std::size_t k, std::size_t thread) {
      const AlignerExample& example = cascade_.examples()[k / each];
      SampleRandom random(cascade_.options().seed ^ 0xc4ec, k);
      View view = example.view;
      if (k % each > 0) view = moved_view(view, example, random);
      AlignerPass& pass = cascade_.pass(thread);
      pass.start(frame_of(*example.picture), Lens{}, view, example.q.data(), nullptr);
      out[k] = collect(pass, example.fold);
      std::vector<Vec2> at;
      for (std::size_t l = 0; l < cascade_.numbers().size(); ++l) at.push_back(pass.image(l));
      out[k].error = mean_error(example, at, kTrustFitted);
      out[k].half = example.fold % 2;
    });
    return out;
  }

  /// Alignments at random places of pictures without faces: numbers first to first + count - 1, those that are `wanted`.
  template <class Predicate>
  std::vector<Evidence> of_others(const OtherPictures& others, std::size_t first, std::size_t count,
                                  const Predicate& is_wanted) {
    std::vector<Evidence> all(count);
    in_parallel(count, cascade_.options().threads, [&](std::size_t index, std::size_t thread) {
      const std::size_t k = first + index;
      SampleRandom random(cascade_.options().seed ^ 0x07e5, k);
      const Image picture = others.crop(kOtherPx, kOtherPx, random);
      const float side = random.octaves_between(45, 120), room = static_cast<float>(kOtherPx);
      const Vec2 centre{random.between(0.3f * room, 0.7f * room), random.between(0.3f * room, 0.7f * room)};
      Evidence evidence = align_other(picture, {centre, side}, k, thread);
      if (is_wanted(evidence)) all[index] = std::move(evidence);
    });
    std::vector<Evidence> out;
    for (Evidence& e : all)
      if (!e.blocks.empty()) out.push_back(std::move(e));
    return out;
  }

  /// Alignments of what a detector finds in pictures without faces.
  std::vector<Evidence> of_found(const OtherPictures& others, const std::vector<std::uint8_t>& detector,
                                 std::size_t searches) {
    const std::vector<std::uint32_t> words = words_of(detector);
    FaceDetectorLimits limits;
    limits.width = limits.height = kSearchedPx;
    std::vector<std::unique_ptr<Owned<FaceDetector>>> detectors;
    for (int t = 0; t < cascade_.options().threads; ++t)
      detectors.push_back(std::make_unique<Owned<FaceDetector>>(
          Span<const std::uint8_t>{reinterpret_cast<const std::uint8_t*>(words.data()), detector.size()},
          limits));
    std::vector<std::vector<Evidence>> found(searches);
    in_parallel(searches, cascade_.options().threads, [&](std::size_t k, std::size_t thread) {
      SampleRandom random(cascade_.options().seed ^ 0xf0d, k);
      const Image picture = others.crop(kSearchedPx, kSearchedPx, random);
      DetectedFace room[4];
      std::size_t count = 0;
      require((*detectors[thread])->find(frame_of(picture), {room, std::size(room)}, &count),
              "the detector's table");
      for (std::size_t c = 0; c < count; ++c)
        for (int j = 0; j < tuning_.found_starts; ++j)
          found[k].push_back(align_other(picture, moved_box(room[c].box, random), k, thread));
    });
    std::vector<Evidence> out;
    for (auto& f : found) std::move(f.begin(), f.end(), std::back_inserter(out));
    return out;
  }

 private:
  static constexpr int kOtherPx = 160, kSearchedPx = 200;

  static std::vector<std::uint32_t> words_of(const std::vector<std::uint8_t>& bytes) {
    std::vector<std::uint32_t> words((bytes.size() + 3) / 4);
    std::copy(bytes.begin(), bytes.end(), reinterpret_cast<std::uint8_t*>(words.data()));
    return words;
  }

  static FaceBox moved_box(FaceBox box, SampleRandom& random) {
    box.center = box.center + (0.06f * box.side) * Vec2{random.normal(), random.normal()};
    box.side *= std::exp(0.08f * random.normal());
    return box;
  }

  /// Aligns the model to a box where there is no face, by the stages that were learnt without one of the folds.
  Evidence align_other(const Image& picture, const FaceBox& box, std::size_t number, std::size_t thread) {
    const Camera camera =
        centred_camera(picture.width, picture.height, kDefaultFocalRatio * static_cast<float>(picture.width));
    const std::vector<float> q(cascade_.model().parameters().count);
    AlignerPass& pass = cascade_.pass(thread);
    View view;
    require(view_of_box(pass.shape().cascade(), q.data(), box, camera, Lens{}, &view), "landmarks");
    const int fold = static_cast<int>(number % static_cast<std::size_t>(cascade_.folds()));
    const AlignerTable& table = **tables_[static_cast<std::size_t>(fold)];
    pass.start(frame_of(picture), Lens{}, view, q.data(), nullptr);
    for (std::size_t s = 0; s < table.stage_count(); ++s) pass.run_stage(table, s);
    Evidence out = collect(pass, fold);
    out.error = 1;
    out.is_face = false;
    out.half = static_cast<int>(number / 2 % 2);
    return out;
  }

  /// Away from the truth by up to moved_most of the eyes' distance, turned and scaled a little.
  View moved_view(const View& view, const AlignerExample& example, SampleRandom& random) const {
    const float mm = example.eye_distance / view.s, shift = tuning_.moved_most * random.unit() * mm;
    const float a = random.between(-1, 1), b = random.between(-1, 1),
                length_ab = std::sqrt(a * a + b * b) + 1e-3f;
    const float step[kPoseUnknowns] = {0.06f * random.normal(), 0.06f * random.normal(),
                                       0.06f * random.normal(), 0.08f * random.normal(),
                                       shift * a / length_ab,   shift * b / length_ab};
    return moved(view, step, kPoseUnknowns);
  }

  Evidence collect(AlignerPass& pass, int fold) {
    const AlignerTable& table = **tables_[static_cast<std::size_t>(fold)];
    const AlignerStage& last = table.stage(table.stage_count() - 1);
    const std::size_t bytes = block_bytes(last), landmarks = table.landmark_count();
    const AlignerEvidence evidence = pass.weigh(table);
    Evidence out;
    out.displacement = evidence.displacement;
    out.parameters = evidence.parameters;
    out.gate = pass.gate();
    out.blocks.resize(landmarks * bytes);
    out.mirrored_blocks.resize(landmarks * bytes);
    for (std::size_t k = 0; k < landmarks; ++k) {
      pass.describe_around(pass.image(k), last, out.blocks.data() + k * bytes);
      mirror_block(out.blocks.data() + k * bytes, last.cells, out.mirrored_blocks.data() + k * bytes);
      out.weights.push_back(pass.shape().evaluate(k).weight);
    }
    return out;
  }

  AlignerCascade& cascade_;
  AlignerCheckTuning tuning_;
  std::vector<std::unique_ptr<OpenAlignerTable>> tables_;
};

std::vector<double> features_of(const Evidence& e) {
  return {1, e.appearance, static_cast<double>(e.displacement), static_cast<double>(e.parameters)};
}

/// Weighted least squares of `wanted` by the features.
std::vector<double> solve_features(const std::vector<const Evidence*>& examples,
                                   const std::vector<double>& wanted, const std::vector<double>& weight) {
  constexpr int n = kCheckFeatures;
  double h[n][n + 1] = {};
  for (std::size_t e = 0; e < examples.size(); ++e) {
    const std::vector<double> f = features_of(*examples[e]);
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

double weighted_sum(const std::vector<double>& w, const Evidence& e) {
  const std::vector<double> f = features_of(e);
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
      const double z = std::clamp(weighted_sum(w, *examples[e]), -12.0, 12.0), p = 1 / (1 + std::exp(-z));
      const double slope = std::max(p * (1 - p), 1e-5);
      wanted[e] = z + 0.7 * (static_cast<double>(labels[e]) - p) / slope;
      weight[e] = slope * (labels[e] > 0.5f ? n / positives : n / (n - positives));
    }
    w = solve_features(examples, wanted, weight);
  }
  AlignerCurve curve{};
  for (std::size_t k = 0; k < w.size(); ++k) curve.weight[k] = static_cast<float>(w[k]);
  curve.low = -12;
  curve.high = 12;
  for (int k = 0; k < kCheckKnots; ++k)
    curve.at[k] = static_cast<float>(1 / (1 + std::exp(-(-12 + 24.0 * k / (kCheckKnots - 1)))));
  return curve;
}

/// The mean error as a function of a sum of features that grows with it.
AlignerCurve error_curve(const std::vector<const Evidence*>& faces) {
  std::vector<double> wanted, weight(faces.size(), 1);
  for (const Evidence* e : faces) wanted.push_back(std::min(static_cast<double>(e->error), 0.4));
  const std::vector<double> w = solve_features(faces, wanted, weight);
  AlignerCurve curve{};
  for (std::size_t k = 0; k < w.size(); ++k) curve.weight[k] = static_cast<float>(w[k]);
  std::vector<double> sums;
  for (const Evidence* e : faces) sums.push_back(weighted_sum(w, *e));
  std::vector<double> sorted = sums;
  std::sort(sorted.begin(), sorted.end());
  curve.low = static_cast<float>(sorted[sorted.size() / 100]);
  curve.high = static_cast<float>(sorted[sorted.size() * 99 / 100]);
  // Means around each knot, then a running maximum.
  const double step = static_cast<double>(curve.high - curve.low) / (kCheckKnots - 1);
  double least = 0;
  for (int k = 0; k < kCheckKnots; ++k) {
    double sum = 0, count = 0;
    const double at = static_cast<double>(curve.low) + step * k;
    for (std::size_t e = 0; e < faces.size(); ++e) {
      const bool is_beyond = (k == 0 && sums[e] < at) || (k == kCheckKnots - 1 && sums[e] > at);
      const double near = is_beyond ? 1 : 1 - std::abs(sums[e] - at) / step;
      if (near <= 0) continue;
      sum += near * wanted[e];
      count += near;
    }
    if (count > 0) least = std::max(least, sum / count);
    curve.at[k] = static_cast<float>(least);
  }
  return curve;
}

/// The examples of verification, and what is learnt from them.
class CheckLearning {
 public:
  CheckLearning(const AlignerCascade& cascade, const AlignerCheckTuning& tuning)
      : options_(cascade.options()), tuning_(tuning) {
    const OpenAlignerTable table(cascade.table(cascade.folds()));
    for (std::size_t k = 0; k < table->landmark_count(); ++k) mirrored_.push_back(table->mirrored(k));
  }

  void add(std::vector<Evidence> more) { std::move(more.begin(), more.end(), std::back_inserter(all_)); }

  /// Learns the appearance: without each half of the people and pictures, and of all.
  void learn() {
    choose_examples();
    in_parallel(3, options_.threads, [&](std::size_t k, std::size_t) {
      std::vector<const Evidence*> chosen;
      std::vector<float> labels;
      for (std::size_t e = 0; e < examples_.size(); ++e)
        if (examples_[e]->half != static_cast<int>(k)) {
          chosen.push_back(examples_[e]);
          labels.push_back(labels_[e]);
        }
      learnt_[k] = learn_appearance(chosen, labels, mirrored_, options_.seed + k, tuning_);
    });
  }

  /// The appearance by the weights that were learnt without the example's half.
  double score(const Evidence& e) const { return score_of(learnt_[e.half], e, mirrored_); }

  LearntCheck conclude() {
    in_parallel(all_.size(), options_.threads,
                [&](std::size_t k, std::size_t) { all_[k].appearance = score(all_[k]); });
    std::vector<const Evidence*> faces;
    for (const Evidence& e : all_)
      if (e.is_face && e.error >= 0) faces.push_back(&e);
    LearntCheck check;
    check.score = score_curve(examples_, labels_);
    check.error = error_curve(faces);
    check.rows.assign(learnt_[2].rows.begin(), learnt_[2].rows.end());
    check.bias.assign(learnt_[2].bias.begin(), learnt_[2].bias.end());
    return check;
  }

 private:
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
  std::vector<std::size_t> mirrored_;
  std::vector<Evidence> all_;
  std::vector<const Evidence*> examples_;
  std::vector<float> labels_;
  Appearance learnt_[3];
};

}  // namespace

LearntCheck learn_check(AlignerCascade& cascade, const OtherPictures& others,
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
  return learning.conclude();
}

}  // namespace pliant::host::learn
