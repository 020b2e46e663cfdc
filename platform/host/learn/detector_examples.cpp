#include "host/learn/detector_examples.hpp"

#include <algorithm>
#include <cmath>

#include "face/box_selection.hpp"
#include "host/learn/detector_calibration.hpp"
#include "host/learn/detector_learning_tuning.hpp"
#include "host/learn/learn_detector.hpp"
#include "host/learn/parallel.hpp"

namespace pliant::host::learn {

namespace {

constexpr const DetectorLearningTuning& kTuning = kDetectorLearningTuning;

// Streams of random numbers.
enum Stream : std::uint64_t { kFaceStream = 11, kOtherStream = 12, kHitStream = 13 };

FaceBox moved(const FaceBox& box, float x, float y, float zoom) {
  return {box.center + box.side * Vec2{x, y}, box.side * zoom};
}

// The pictures that train.
std::vector<std::size_t> training_pictures(const OtherPictures& others) {
  std::vector<std::size_t> numbers;
  for (std::size_t k = 0; k < others.count(); ++k)
    if (!calibrates(k, others.count())) numbers.push_back(k);
  return numbers;
}

// The places around a face where the nearest windows of the search may be.
FaceWindows checked_windows(const FaceSample& sample) {
  FaceWindows windows;
  constexpr float kShift = 1.0f / (2 * kWindowCells);
  windows.push_back(window_of(sample.picture, sample.box));
  for (const float x : {-kShift, kShift})
    for (const float y : {-kShift, kShift})
      for (const float zoom : {0.93f, 1.07f})
        windows.push_back(window_of(sample.picture, moved(sample.box, 0.5f * x, 0.5f * y, zoom)));
  return windows;
}

}  // namespace

FaceExamples draw_faces(const FaceSamples& faces, std::size_t count, const LearnOptions& options,
                        const LearnProgress& progress) {
  constexpr std::size_t kBlock = 200;
  std::vector<std::vector<Window>> training(count);
  std::vector<FaceWindows> checking(count);
  const auto draw = [&](std::size_t k) {
    const FaceSample sample = faces.draw(k);
    if (sample.person % kCheckedPersons == 0) {
      checking[k] = checked_windows(sample);
      return;
    }
    SampleRandom random(options.seed + kFaceStream, k);
    for (std::size_t j = 0; j < kTuning.windows_a_sample; ++j) {
      const float x = random.between(-kTuning.shift, kTuning.shift),
                  y = random.between(-kTuning.shift, kTuning.shift),
                  zoom = random.octaves_between(1 / kTuning.zoom, kTuning.zoom);
      training[k].push_back(window_of(sample.picture, moved(sample.box, x, y, zoom)));
    }
  };
  for (std::size_t begin = 0; begin < count; begin += kBlock) {
    const std::size_t n = std::min(kBlock, count - begin);
    run_parallel(options.threads, n, [&](std::size_t k) { draw(begin + k); });
    if (progress) progress("drawing faces", begin + n, count);
  }
  FaceExamples examples;
  for (const auto& windows : training)
    examples.training.insert(examples.training.end(), windows.begin(), windows.end());
  for (auto& windows : checking)
    if (!windows.empty()) examples.checking.push_back(std::move(windows));
  return examples;
}

std::vector<Window> draw_others(const OtherPictures& others, std::size_t count, const LearnOptions& options) {
  std::vector<Window> windows(count);
  const std::vector<std::size_t> pictures = training_pictures(others);
  run_parallel(options.threads, count, [&](std::size_t k) {
    SampleRandom random(options.seed + kOtherStream, k);
    const Image& picture = others.picture(pictures[random.below(pictures.size())]);
    const float width = static_cast<float>(picture.width), height = static_cast<float>(picture.height);
    const float side = random.octaves_between(kWindowPx, std::max(kWindowPx + 1.0f, std::min(width, height)));
    windows[k] = window_of(picture, {{random.between(0, width), random.between(0, height)}, side});
  });
  return windows;
}

std::vector<Window> find_false_hits(const std::vector<DetectorTree>& trees, const OtherPictures& others,
                                    const FaceSamples& faces, std::size_t count, std::size_t round,
                                    const LearnOptions& options, const LearnProgress& progress) {
  SampleRandom order(options.seed + kHitStream, round);
  std::vector<std::size_t> pictures = training_pictures(others);
  for (std::size_t k = pictures.size(); k > 1; --k) std::swap(pictures[k - 1], pictures[order.below(k)]);
  // Between pictures come samples of faces, so that both are among the hits.
  const std::size_t searches = 2 * pictures.size();
  constexpr std::size_t kBlock = 16;
  std::vector<Window> found;
  for (std::size_t begin = 0; begin < searches && found.size() < count; begin += kBlock) {
    const std::size_t n = std::min(kBlock, searches - begin);
    std::vector<std::vector<Window>> hits(n);
    run_parallel(options.threads, n, [&](std::size_t k) {
      const std::size_t number = begin + k;
      SampleRandom random(options.seed + kHitStream, (round << 32) + number + 1);
      std::vector<WindowHit> all;
      if (number % 2 == 0) {
        all = find_hits(others.picture(pictures[number / 2]), trees);
      } else {
        const FaceSample sample = faces.draw((round << 24) + number);
        for (WindowHit& hit : find_hits(sample.picture, trees))
          if (overlap(hit.box, sample.box) < 0.3f) all.push_back(std::move(hit));
      }
      for (std::size_t taken = 0; taken < kTuning.hits_a_picture && !all.empty(); ++taken) {
        const std::size_t which = random.below(all.size());
        hits[k].push_back(all[which].window);
        all[which] = all.back();
        all.pop_back();
      }
    });
    for (const auto& windows : hits) found.insert(found.end(), windows.begin(), windows.end());
    if (progress) progress("searching for false hits", std::min(found.size(), count), count);
  }
  if (found.size() > count) found.resize(count);
  return found;
}

}  // namespace pliant::host::learn
