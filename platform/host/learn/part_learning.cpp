#include "host/learn/part_learning.hpp"

#include <algorithm>
#include <cmath>

#include "host/io/statistics.hpp"
#include "host/learn/aligner_examples.hpp"
#include "host/learn/parallel.hpp"
#include "host/learn/part_examples.hpp"
#include "host/learn/ridge.hpp"

namespace pliant::host::learn {

namespace {

using Points = std::vector<std::size_t>;

/// Points that are seen or hidden together: landmarks, and pupils.
std::vector<Points> groups_of(const PartRecord& part) {
  std::vector<Points> groups(2);
  for (std::size_t k = 0; k < part.point_count; ++k)
    groups[part.number[k] >= kPupilRight ? 1 : 0].push_back(k);
  if (groups[1].empty()) groups.pop_back();
  return groups;
}

/// Learns the stages of one part, each from where the stages before it see the points of people left out.
class PartCascade {
 public:
  PartCascade(std::vector<PartExample> examples, const PartRecord& part, const LearnOptions& options,
              const PartLearningTuning& tuning)
      : examples_(std::move(examples)), options_(options), tuning_(tuning), groups_(groups_of(part)) {
    out_.record = part;
    for (const Points& points : groups_) {
      weights_.emplace_back();
      for (const PartExample& e : examples_) weights_.back().push_back(trusted(e, points));
    }
    for (int t = 0; t < options.threads; ++t) readers_.push_back(std::make_unique<Owned<PartReader>>());
    start();
  }

  void learn(std::size_t stage) {
    const std::size_t inputs = part_bytes(out_.record, stage);
    describe(stage);
    out_.stages.emplace_back();
    out_.stages.back().rows.resize(2 * out_.record.point_count * inputs);
    out_.stages.back().bias.resize(2 * out_.record.point_count);
    for (std::size_t g = 0; g < groups_.size(); ++g) learn_group(g, inputs + 1);
    for (std::size_t g = 0; g < groups_.size(); ++g) lower_weights(g);
  }

  LearntPart finish() {
    for (std::size_t k = 0; k < out_.record.point_count; ++k) measure(k);
    return std::move(out_);
  }

 private:
  double trusted(const PartExample& e, const Points& points) const {
    double least = 1;
    for (const std::size_t k : points) least = std::min(least, tuning_.weight_of_trust[e.trust[k]]);
    return least;
  }
  const std::vector<double>& weights_of(std::size_t point) const {
    const auto has = [&](const Points& g) { return std::find(g.begin(), g.end(), point) != g.end(); };
    return weights_[static_cast<std::size_t>(std::find_if(groups_.begin(), groups_.end(), has) -
                                             groups_.begin())];
  }

  /// The mean of the truth.
  void start() {
    for (std::size_t k = 0; k < out_.record.point_count; ++k) {
      double x = 0, y = 0, sum = 1e-9;
      for (std::size_t e = 0; e < examples_.size(); ++e) {
        const double w = weights_of(k)[e];
        x += w * static_cast<double>(examples_[e].truth[k].x);
        y += w * static_cast<double>(examples_[e].truth[k].y);
        sum += w;
      }
      out_.start.push_back(x / sum);
      out_.start.push_back(y / sum);
      for (PartExample& e : examples_)
        e.at.push_back({static_cast<float>(x / sum), static_cast<float>(y / sum)});
    }
  }

  void describe(std::size_t stage) {
    const std::size_t bytes = part_bytes(out_.record, stage);
    bytes_.resize(examples_.size() * bytes);
    run_parallel(options_.threads, examples_.size(), [&](std::size_t k, std::size_t thread) {
      PartExample& e = examples_[k];
      PartReader& reader = **readers_[thread];
      reader.prepare(frame_of(*e.picture), e.map, e.is_mirrored);
      reader.describe(out_.record.stage[stage], out_.record.mm_per_px, e.at.size(), e.at.data(),
                      &bytes_[k * bytes]);
    });
  }

  void learn_group(std::size_t group, std::size_t inputs) {
    const Points& points = groups_[group];
    std::vector<RidgeSums> folds(static_cast<std::size_t>(tuning_.folds));
    run_parallel(options_.threads, folds.size(), [&](std::size_t f, std::size_t) {
      folds[f].resize(inputs, 2 * points.size());
      RidgeRows rows(folds[f]);
      std::vector<double> y(2 * points.size());
      for (std::size_t k = 0; k < examples_.size(); ++k) {
        const PartExample& e = examples_[k];
        if (e.fold != static_cast<int>(f) || !(weights_[group][k] > 0)) continue;
        for (std::size_t p = 0; p < points.size(); ++p) {
          const Vec2 left = e.truth[points[p]] - e.at[points[p]];
          y[2 * p] = static_cast<double>(left.x);
          y[2 * p + 1] = static_cast<double>(left.y);
        }
        rows.add(&bytes_[k * (inputs - 1)], y.data(), weights_[group][k]);
      }
    });
    const RidgeSums all = sum_of(folds);
    keep(points, solve_ridge(all, tuning_.ridge), inputs);
    run_parallel(options_.threads, folds.size(), [&](std::size_t f, std::size_t) {
      RidgeSums others = all;
      others.add(folds[f], -1);
      move(static_cast<int>(f), points, solve_ridge(others, tuning_.ridge), inputs);
    });
  }

  void keep(const Points& points, const std::vector<double>& w, std::size_t inputs) {
    LearntPartStage& stage = out_.stages.back();
    for (std::size_t row = 0; row < 2 * points.size(); ++row) {
      const std::size_t to = 2 * points[row / 2] + row % 2;
      const auto first = w.begin() + static_cast<std::ptrdiff_t>(row * inputs);
      std::copy(first, first + static_cast<std::ptrdiff_t>(inputs - 1),
                stage.rows.begin() + static_cast<std::ptrdiff_t>(to * (inputs - 1)));
      stage.bias[to] = w[row * inputs + inputs - 1];
    }
  }

  /// Moves the points of a fold's examples by what was learnt without it.
  void move(int fold, const Points& points, const std::vector<double>& w, std::size_t inputs) {
    for (std::size_t k = 0; k < examples_.size(); ++k) {
      if (examples_[k].fold != fold) continue;
      const std::uint8_t* const bytes = &bytes_[k * (inputs - 1)];
      const auto along = [&](std::size_t row) {
        double sum = w[row * inputs + inputs - 1];
        for (std::size_t i = 0; i + 1 < inputs; ++i)
          sum += w[row * inputs + i] * static_cast<double>(bytes[i]);
        return static_cast<float>(sum);
      };
      for (std::size_t p = 0; p < points.size(); ++p) {
        Vec2& at = examples_[k].at[points[p]];
        at = at + Vec2{along(2 * p), along(2 * p + 1)};
      }
    }
  }

  /// Examples that cannot be read (glare, darkness, something before the eye) weigh less in the next stage.
  void lower_weights(std::size_t group) {
    std::vector<double> errors, all;
    for (std::size_t k = 0; k < examples_.size(); ++k) {
      double sum = 0;
      for (const std::size_t p : groups_[group]) {
        const Vec2 d = examples_[k].truth[p] - examples_[k].at[p];
        sum += static_cast<double>(dot(d, d));
      }
      all.push_back(std::sqrt(sum));
      if (weights_[group][k] > 0) errors.push_back(all.back());
    }
    const double usual = std::max(upper_median(errors), 1e-6);
    for (std::size_t k = 0; k < examples_.size(); ++k) {
      const double ratio = std::max(1.0, all[k] / usual);
      weights_[group][k] = trusted(examples_[k], groups_[group]) / (ratio * ratio);
    }
  }

  /// Covariance of the errors on people left out.
  void measure(std::size_t point) {
    const std::vector<double>& weights = weights_of(point);
    double moment[3] = {0, 0, 0}, weight = 1e-9;
    for (std::size_t k = 0; k < examples_.size(); ++k) {
      const double w = weights[k];
      if (!(w > 0)) continue;
      const Vec2 r = examples_[k].truth[point] - examples_[k].at[point];
      moment[0] += w * static_cast<double>(r.x * r.x);
      moment[1] += w * static_cast<double>(r.x * r.y);
      moment[2] += w * static_cast<double>(r.y * r.y);
      weight += w;
    }
    const double xx = moment[0] / weight + tuning_.least_variance, xy = moment[1] / weight,
                 yy = moment[2] / weight + tuning_.least_variance, determinant = xx * yy - xy * xy;
    out_.information.insert(out_.information.end(), {yy / determinant, -xy / determinant, xx / determinant});
  }

  std::vector<PartExample> examples_;
  const LearnOptions& options_;
  const PartLearningTuning& tuning_;
  std::vector<Points> groups_;
  std::vector<std::vector<double>> weights_;  // of each group, an example
  std::vector<std::uint8_t> bytes_;           // of the stage being learnt
  std::vector<std::unique_ptr<Owned<PartReader>>> readers_;
  LearntPart out_;
};

std::vector<PartExample> draw_examples(const Model& model, const FaceSamples& faces, const PartRecord& record,
                                       const LearnOptions& options, std::size_t samples,
                                       const LearnProgress& progress, const PartLearningTuning& tuning) {
  std::vector<std::unique_ptr<PartExamples>> sources;
  for (int t = 0; t < options.threads; ++t)
    sources.push_back(std::make_unique<PartExamples>(model, record, tuning));
  std::vector<std::vector<PartExample>> drawn(samples);
  run_parallel(options.threads, samples, [&](std::size_t k, std::size_t thread) {
    SampleRandom random(options.seed ^ 0x9a27, k);
    drawn[k] = sources[thread]->draw(faces.draw(k), random);
    if (thread == 0 && progress) progress("parts: samples", k, samples);
  });
  std::vector<PartExample> out;
  for (auto& examples : drawn) std::move(examples.begin(), examples.end(), std::back_inserter(out));
  return out;
}

}  // namespace

LearntPart learn_part(const Model& model, const FaceSamples& faces, const PartRecord& record,
                      const LearnOptions& options, std::size_t samples, const LearnProgress& progress,
                      const PartLearningTuning& tuning) {
  PartCascade cascade(draw_examples(model, faces, record, options, samples, progress, tuning), record,
                      options, tuning);
  for (std::size_t k = 0; k < record.stage_count; ++k) {
    if (progress) progress("parts: stages", k, record.stage_count);
    cascade.learn(k);
  }
  return cascade.finish();
}

}  // namespace pliant::host::learn
