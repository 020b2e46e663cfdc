#include "host/learn/boosted_trees.hpp"

#include <algorithm>
#include <cmath>

#include "host/learn/parallel.hpp"
#include "host/learn/sample_random.hpp"

namespace pliant::host::learn {

namespace {

constexpr std::size_t kBins = 256;
// Weights are integers, so that sums do not depend on their order. All of one class together weigh this.
constexpr double kClassWeight = 1 << 30;

struct Split {
  double loss = 1e300;
  int place = 0, threshold = 0;
  bool better_than(const Split& o) const { return loss < o.loss || (loss == o.loss && place < o.place); }
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
        weights_(count_),
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
  // w = exp(-y sum), each class with the same weight in all.
  void weigh() {
    weigh(0, face_count_, -1);
    weigh(face_count_, count_, 1);
  }
  void weigh(std::size_t begin, std::size_t end, int sign) {
    int highest = -0x7fffffff;
    for (std::size_t i = begin; i < end; ++i) highest = std::max(highest, sign * sums_[i]);
    const auto weight = [&](std::size_t i) {
      return std::exp(static_cast<double>(sign * sums_[i] - highest) / kLeafUnit);
    };
    double all = 0;
    for (std::size_t i = begin; i < end; ++i) all += weight(i);
    for (std::size_t i = begin; i < end; ++i)
      weights_[i] = static_cast<std::uint32_t>(kClassWeight / all * weight(i));
  }

  // The best splits of all nodes of a level by one feature. Histograms: node, class, value.
  void try_feature(int place, int nodes, Split* best) const {
    std::vector<std::uint32_t> sums(static_cast<std::size_t>(2 * nodes) * kBins, 0);
    const std::uint8_t* const value = values_.data() + static_cast<std::size_t>(place) * count_;
    for (std::size_t i = 0; i < face_count_; ++i) sums[2 * leaves_[i] * kBins + value[i]] += weights_[i];
    for (std::size_t i = face_count_; i < count_; ++i)
      sums[(2 * leaves_[i] + 1u) * kBins + value[i]] += weights_[i];
    for (int node = 0; node < nodes; ++node) {
      const std::uint32_t* const faces = sums.data() + static_cast<std::size_t>(2 * node) * kBins;
      const std::uint32_t* const others = faces + kBins;
      double all_faces = 0, all_others = 0, low_faces = 0, low_others = 0;
      for (std::size_t b = 0; b < kBins; ++b) {
        all_faces += faces[b];
        all_others += others[b];
      }
      for (std::size_t b = 0; b + 1 < kBins; ++b) {
        low_faces += faces[b];
        low_others += others[b];
        if (faces[b] + others[b] == 0 && b > 0) continue;
        const double loss = std::sqrt(low_faces * low_others) +
                            std::sqrt((all_faces - low_faces) * (all_others - low_others));
        const Split split{loss, place, static_cast<int>(b) + 1};
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
    run_parallel(threads_, places.size(), [&](std::size_t k) {
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
    double faces[kTreeLeaves] = {}, others[kTreeLeaves] = {};
    for (std::size_t i = 0; i < face_count_; ++i) faces[leaves_[i]] += weights_[i];
    for (std::size_t i = face_count_; i < count_; ++i) others[leaves_[i]] += weights_[i];
    const double smoothing = tuning_.smoothing * kClassWeight;
    for (int k = 0; k < kTreeLeaves; ++k) {
      const double value = 0.5 * std::log((faces[k] + smoothing) / (others[k] + smoothing));
      const double scaled = static_cast<double>(tuning_.shrinkage) * kLeafUnit * value;
      tree->leaf[k] = static_cast<std::int8_t>(std::lround(std::clamp(scaled, -127.0, 127.0)));
    }
  }

  BoostTuning tuning_;
  std::uint64_t seed_;
  int threads_;
  std::size_t face_count_, count_;
  std::vector<std::uint8_t> values_;  // by feature
  std::vector<int> sums_;
  std::vector<std::uint32_t> weights_;
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
