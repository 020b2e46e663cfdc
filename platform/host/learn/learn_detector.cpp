#include "host/learn/learn_detector.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <string>

#include "host/learn/boosted_trees.hpp"
#include "host/learn/detector_calibration.hpp"
#include "host/learn/detector_examples.hpp"
#include "host/learn/detector_learning_tuning.hpp"
#include "pliant/model.hpp"

namespace pliant::host::learn {

namespace {

constexpr const DetectorLearningTuning& kTuning = kDetectorLearningTuning;

std::int16_t to_int16(int value) {
  return static_cast<std::int16_t>(std::clamp(value, -32768, 32767));
}

// The window of a face with the highest sum: the search finds the face if it finds this one.
std::vector<int> best_partial_sums(const std::vector<DetectorTree>& trees, const FaceWindows& windows) {
  std::vector<int> best, sums;
  for (const Window& w : windows) {
    full_sum(trees, w, &sums);
    if (best.empty() || sums.back() > best.back()) best = sums;
  }
  return best;
}

// Sets the rejection thresholds: the highest ones that keep all checked faces but the worst.
void set_thresholds(const std::vector<FaceWindows>& faces, double lost, std::vector<DetectorTree>* trees) {
  std::vector<std::vector<int>> sums;
  for (const FaceWindows& windows : faces) sums.push_back(best_partial_sums(*trees, windows));
  std::sort(sums.begin(), sums.end(), [](const auto& a, const auto& b) { return a.back() < b.back(); });
  const auto first = static_cast<std::size_t>(lost * static_cast<double>(sums.size()));
  for (std::size_t t = 0; t < trees->size(); ++t) {
    int least = 32767;
    for (std::size_t k = first; k < sums.size(); ++k) least = std::min(least, sums[k][t]);
    (*trees)[t].rejection = to_int16(least);
  }
}

std::vector<std::uint8_t> bytes_of(const std::vector<DetectorTree>& trees, const Calibration& calibration) {
  DetectorHeader header{};
  header.magic = kDetectorMagic;
  header.tree_count = static_cast<std::uint16_t>(trees.size());
  header.total_bytes = static_cast<std::uint32_t>(sizeof header + trees.size() * sizeof(DetectorTree));
  set_knots(calibration, trees.back().rejection, &header);
  std::vector<std::uint8_t> bytes(header.total_bytes);
  std::memcpy(bytes.data(), &header, sizeof header);
  std::memcpy(bytes.data() + sizeof header, trees.data(), trees.size() * sizeof(DetectorTree));
  constexpr std::size_t kSummedFrom = offsetof(DetectorHeader, tree_count);
  header.crc32 = crc32(bytes.data() + kSummedFrom, bytes.size() - kSummedFrom);
  std::memcpy(bytes.data(), &header, sizeof header);
  return bytes;
}

}  // namespace

std::vector<std::uint8_t> learn_detector(const FaceSamples& faces, const OtherPictures& others,
                                         const LearnOptions& options, const LearnProgress& progress) {
  const auto fraction = [&](std::size_t count) {
    return std::max(std::size_t{1}, static_cast<std::size_t>(options.effort * static_cast<double>(count)));
  };
  const FaceExamples examples = draw_faces(faces, fraction(kTuning.samples), options, progress);
  std::vector<Window> negatives = draw_others(others, fraction(kTuning.random_others), options);
  std::vector<DetectorTree> trees;
  for (std::size_t round = 0; round < std::size(kTuning.trees); ++round) {
    if (round > 0) {
      const std::vector<Window> hits =
          find_false_hits(trees, others, faces, fraction(kTuning.hits_a_round), round, options, progress);
      negatives.insert(negatives.end(), hits.begin(), hits.end());
      const std::size_t most = fraction(kTuning.most_others);
      if (negatives.size() > most)
        negatives.erase(negatives.begin(),
                        negatives.begin() + static_cast<std::ptrdiff_t>(negatives.size() - most));
    }
    const std::size_t count = kTuning.trees[round];
    const std::string stage = "boosting, round " + std::to_string(round + 1) + ", " +
                              std::to_string(examples.training.size()) + " faces, " +
                              std::to_string(negatives.size()) + " others";
    trees = boost_trees(examples.training, negatives, count, kTuning.boosting, options.seed + round,
                        options.threads, [&](std::size_t done) {
                          if (progress) progress(stage.c_str(), done, count);
                        });
    const bool is_last = round + 1 == std::size(kTuning.trees);
    set_thresholds(examples.checking, is_last ? kTuning.lost_faces : kTuning.lost_faces_before, &trees);
  }
  std::vector<int> checked;
  for (const FaceWindows& windows : examples.checking)
    checked.push_back(best_partial_sums(trees, windows).back());
  return bytes_of(trees, calibrate(trees, checked, others, options));
}

}  // namespace pliant::host::learn
