#include "host/learn/boosted_trees.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "host/io/failure.hpp"
#include "host/learn/parallel.hpp"
#include "host/learn/sample_random.hpp"

namespace pliant::host::learn {

namespace {

constexpr std::size_t kBins = 256;
// Slopes and curvatures of the loss are integers, so that their sums do not depend on the order: this much is 1 on average
// over a class. The slopes of one class add up to kUnit / 2 a window of both at most, and so stay within the 32 bits of Terms
// below 2^18 windows. They begin with half of that, and become smaller as the trees learn: in practice there is room for 2^19
// windows. `weigh` checks it.
constexpr double kUnit = 1 << 14;

/// The sums of slope (y - p, upper half) and curvature (p (1 - p), lower half) in one word.
using Terms = std::int64_t;
double slope_of(Terms t) {
  return static_cast<double>(t >> 32);
}
double curvature_of(Terms t) {
  return static_cast<double>(t & 0xffffffff);
}

struct Split {
  double gain = -1;
  int place = 0, threshold = 0;
  bool better_than(const Split& o) const { return gain > o.gain || (gain == o.gain && place < o.place); }
};

class Booster {
 public:
  Booster(const std::vector<Window>& faces, const std::vector<Window>& others, const BoostTuning& tuning,
          std::uint64_t seed, int threads)
      : tuning_(tuning),
        seed_(seed),
        threads_(threads),
        face_count_(faces.size()),
        count_(faces.size() + others.size()),
        values_(count_ * kWindowFeatures),
        sums_(count_, 0),
        terms_(count_),
        leaves_(count_) {
    for (std::size_t i = 0; i < count_; ++i) {
      const Window& w = i < face_count_ ? faces[i] : others[i - face_count_];
      for (std::size_t f = 0; f < kWindowFeatures; ++f) values_[f * count_ + i] = w[f];
    }
  }

  DetectorTree add_tree(std::size_t number) {
    weigh();
    DetectorTree tree{};
    tree.rejection = -32768;
    std::fill(leaves_.begin(), leaves_.end(), std::uint8_t{0});
    for (int level = 0; level < kTreeDepth; ++level) split_level(number, level, &tree);
    set_leaves(&tree);
    for (std::size_t i = 0; i < count_; ++i) sums_[i] += tree.leaf[leaves_[i]];
    return tree;
  }

 private:
  // Of the loss log(1 + exp(-2 y F)), F = sum / kLeafUnit half the logarithm of the odds. Both classes weigh the same.
  void weigh() {
    const double each = kUnit * 0.5 * static_cast<double>(count_),
                 face = each / static_cast<double>(face_count_),
                 other = each / static_cast<double>(count_ - face_count_);
    Terms slope_of_class[2] = {}, curvature_of_all = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      const bool is_face = i < face_count_;
      const double p = 1 / (1 + std::exp(-2.0 / kLeafUnit * sums_[i])), weight = is_face ? face : other;
      const auto slope = static_cast<Terms>(std::lround(weight * ((is_face ? 1 : 0) - p)));
      const auto curvature = static_cast<Terms>(std::lround(weight * p * (1 - p)));
      terms_[i] = slope * (Terms{1} << 32) + curvature;
      slope_of_class[is_face] += slope;
      curvature_of_all += curvature;
    }
    // Slopes of faces are positive, those of others negative: no node's sums exceed these.
    const bool fit =
        slope_of_class[1] <= INT32_MAX && slope_of_class[0] >= INT32_MIN && curvature_of_all <= UINT32_MAX;
    if (!fit)
      fail_input("detection",
                 std::to_string(count_) + " windows are too many to sum up; learn with less effort");
  }

  double gain_of(Terms t) const {
    const double slope = slope_of(t);
    return slope * slope / (curvature_of(t) + smoothing());
  }
  double smoothing() const { return tuning_.smoothing * kUnit * static_cast<double>(count_); }

  // The best splits of all nodes of a level by one feature.
  void try_feature(int place, int nodes, Split* best) const {
    std::vector<Terms> sums(static_cast<std::size_t>(nodes) * kBins, 0);
    const std::uint8_t* const value = values_.data() + static_cast<std::size_t>(place) * count_;
    for (std::size_t i = 0; i < count_; ++i) sums[leaves_[i] * kBins + value[i]] += terms_[i];
    for (int node = 0; node < nodes; ++node) {
      const Terms* const of = sums.data() + static_cast<std::size_t>(node) * kBins;
      Terms all = 0, low = 0;
      for (std::size_t b = 0; b < kBins; ++b) all += of[b];
      for (std::size_t b = 0; b + 1 < kBins; ++b) {
        low += of[b];
        if (of[b] == 0 && b > 0) continue;
        const Split split{gain_of(low) + gain_of(all - low), place, static_cast<int>(b) + 1};
        if (split.better_than(best[node])) best[node] = split;
      }
    }
  }

  void split_level(std::size_t number, int level, DetectorTree* tree) {
    const int nodes = 1 << level;
    SampleRandom random(seed_, number * kTreeDepth + static_cast<std::size_t>(level));
    std::vector<int> places;
    for (int f = 0; f < kWindowFeatures; ++f)
      if (random.chance(tuning_.feature_fraction)) places.push_back(f);
    std::vector<Split> best(places.size() * static_cast<std::size_t>(nodes));
    run_parallel(threads_, places.size(), [&](std::size_t k, std::size_t) {
      try_feature(places[k], nodes, best.data() + k * static_cast<std::size_t>(nodes));
    });
    std::vector<Split> chosen(static_cast<std::size_t>(nodes));
    for (std::size_t k = 0; k < best.size(); ++k) {
      Split& c = chosen[k % static_cast<std::size_t>(nodes)];
      if (best[k].better_than(c)) c = best[k];
    }
    for (int node = nodes - 1; node < kTreeNodes && node < 2 * nodes - 1; ++node) {
      const Split& s = chosen[static_cast<std::size_t>(node - nodes + 1)];
      tree->feature[node] = feature_at(s.place);
      tree->threshold[node] = static_cast<std::uint8_t>(s.threshold);
    }
    for (std::size_t i = 0; i < count_; ++i) {
      const Split& s = chosen[leaves_[i]];
      const bool is_high = values_[static_cast<std::size_t>(s.place) * count_ + i] >= s.threshold;
      leaves_[i] = static_cast<std::uint8_t>(2 * leaves_[i] + (is_high ? 1 : 0));
    }
  }

  void set_leaves(DetectorTree* tree) {
    Terms sums[kTreeLeaves] = {};
    for (std::size_t i = 0; i < count_; ++i) sums[leaves_[i]] += terms_[i];
    for (int k = 0; k < kTreeLeaves; ++k) {
      const double step = 0.5 * slope_of(sums[k]) / (curvature_of(sums[k]) + smoothing());
      const double scaled = static_cast<double>(tuning_.shrinkage) * kLeafUnit * step;
      tree->leaf[k] = static_cast<std::int8_t>(std::lround(std::clamp(scaled, -127.0, 127.0)));
    }
  }

  BoostTuning tuning_;
  std::uint64_t seed_;
  int threads_;
  std::size_t face_count_, count_;
  std::vector<std::uint8_t> values_;  // by feature
  std::vector<int> sums_;
  std::vector<Terms> terms_;
  std::vector<std::uint8_t> leaves_;  // the node or leaf that a window has reached, counted in its level
};

}  // namespace

std::vector<DetectorTree> boost_trees(const std::vector<Window>& faces, const std::vector<Window>& others,
                                      std::size_t tree_count, const BoostTuning& tuning, std::uint64_t seed,
                                      int threads, const std::function<void(std::size_t)>& done) {
  Booster booster(faces, others, tuning, seed, threads);
  std::vector<DetectorTree> trees;
  for (std::size_t k = 0; k < tree_count; ++k) {
    trees.push_back(booster.add_tree(k));
    if (done) done(k + 1);
  }
  return trees;
}

}  // namespace pliant::host::learn
