#include "host/learn/learn_detector.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <string>

#include "host/io/failure.hpp"
#include "host/io/table_checksum.hpp"
#include "host/learn/boosted_trees.hpp"
#include "host/learn/detector_calibration.hpp"
#include "host/learn/detector_examples.hpp"
#include "host/learn/detector_learning_tuning.hpp"

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

using PartialSums = std::vector<std::vector<int>>;

// Of checked faces, the lowest last sum first.
PartialSums checked_sums(const std::vector<DetectorTree>& trees, const std::vector<FaceWindows>& faces) {
  PartialSums sums;
  for (const FaceWindows& windows : faces) sums.push_back(best_partial_sums(trees, windows));
  std::sort(sums.begin(), sums.end(), [](const auto& a, const auto& b) { return a.back() < b.back(); });
  return sums;
}

// Sets the rejection thresholds: the highest ones that keep all faces but those with the `lost` lowest sums.
void set_thresholds(const PartialSums& faces, std::size_t lost, std::vector<DetectorTree>* trees) {
  for (std::size_t t = 0; t < trees->size(); ++t) {
    int least = 32767;
    for (std::size_t k = lost; k < faces.size(); ++k) least = std::min(least, faces[k][t]);
    (*trees)[t].rejection = to_int16(least);
  }
}

void set_thresholds(const PartialSums& faces, double lost_fraction, std::vector<DetectorTree>* trees) {
  set_thresholds(faces, static_cast<std::size_t>(lost_fraction * static_cast<double>(faces.size())), trees);
}

// The sum that as many frames without faces reach as may have a false hit.
int sum_of_false_hits(std::vector<int> best_in_frames) {
  std::sort(best_in_frames.begin(), best_in_frames.end());
  const auto allowed =
      static_cast<std::size_t>(kTuning.false_hits * static_cast<double>(best_in_frames.size()));
  return best_in_frames[best_in_frames.size() - 1 - allowed] + 1;
}

// The last thresholds, and the calibration of what passes them.
Calibration conclude(const FaceExamples& examples, const OtherPictures& others, const LearnOptions& options,
                     std::vector<DetectorTree>* trees) {
  const PartialSums faces = checked_sums(*trees, examples.checking);
  set_thresholds(faces, kTuning.lost_faces, trees);
  const std::vector<int> false_sums = best_sums_without_faces(*trees, others, options);
  const int least = sum_of_false_hits(false_sums);
  std::size_t lost = 0;
  while (lost + 1 < faces.size() &&
         (faces[lost].back() < least || faces[lost].back() < trees->back().rejection))
    ++lost;
  set_thresholds(faces, lost, trees);
  trees->back().rejection = to_int16(std::max(least, int{trees->back().rejection}));
  std::vector<int> face_sums;
  for (const auto& sums : faces) face_sums.push_back(sums.back());
  return calibrate(face_sums, false_sums, trees->back().rejection);
}

std::vector<std::uint8_t> bytes_of(const std::vector<DetectorTree>& trees, const Calibration& calibration) {
  DetectorHeader header{};
  header.magic = kDetectorMagic;
  header.tree_count = static_cast<std::uint16_t>(trees.size());
  header.tree_depth = kTreeDepth;
  header.total_bytes = static_cast<std::uint32_t>(sizeof header + trees.size() * sizeof(DetectorTree));
  set_knots(calibration, trees.back().rejection, &header);
  std::vector<std::uint8_t> bytes(header.total_bytes);
  std::memcpy(bytes.data(), &header, sizeof header);
  std::memcpy(bytes.data() + sizeof header, trees.data(), trees.size() * sizeof(DetectorTree));
  set_checksum<DetectorHeader>(bytes);
  return bytes;
}

}  // namespace

std::vector<std::uint8_t> learn_detector(const FaceSamples& faces, const OtherPictures& others,
                                         const LearnOptions& options, const LearnProgress& progress) {
  const auto fraction = [&](std::size_t count) {
    return std::max(std::size_t{1}, static_cast<std::size_t>(options.effort * static_cast<double>(count)));
  };
  const FaceExamples examples = draw_faces(faces, fraction(kTuning.samples), options, progress);
  if (examples.training.empty() || examples.checking.empty())
    fail_input("detection", std::to_string(examples.training.size()) + " windows of faces train, and " +
                                std::to_string(examples.checking.size()) +
                                " faces of other people set thresholds: give photographs of more people, or more effort");
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
    set_thresholds(checked_sums(trees, examples.checking), kTuning.lost_faces, &trees);
  }
  const Calibration calibration = conclude(examples, others, options, &trees);
  return bytes_of(trees, calibration);
}

}  // namespace pliant::host::learn
