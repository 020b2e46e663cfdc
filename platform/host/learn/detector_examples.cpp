#include "host/learn/detector_examples.hpp"

#include <algorithm>

#include "face/box_selection.hpp"
#include "host/learn/detector_calibration.hpp"
#include "host/learn/detector_learning_tuning.hpp"
#include "host/learn/learn_detector.hpp"
#include "host/learn/parallel.hpp"

namespace pliant::host::learn {

namespace {

constexpr const DetectorLearningTuning& kTuning = kDetectorLearningTuning;

// Streams of random numbers.
enum Stream : std::uint64_t { kFaceStream = 11, kOtherStream = 12, kHitStream = 13, kBesideStream = 15 };

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

// Windows of random hits, at most so many as one picture may add.
std::vector<Window> some_of(std::vector<WindowHit> hits, SampleRandom random) {
  std::vector<Window> windows;
  while (!hits.empty() && windows.size() < kTuning.hits_a_picture) {
    const std::size_t k = random.below(hits.size());
    windows.push_back(hits[k].window);
    hits[k] = hits.back();
    hits.pop_back();
  }
  return windows;
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
    run_parallel(options.threads, n, [&](std::size_t k, std::size_t) { draw(begin + k); });
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
  run_parallel(options.threads, count, [&](std::size_t k, std::size_t) {
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
  std::vector<Window> found;
  // Searches until `most` hits are found. search(k) gives the hits of one picture.
  const auto collect = [&](const char* stage, std::size_t searches, std::size_t most, const auto& search) {
    constexpr std::size_t kBlock = 16;
    for (std::size_t begin = 0; begin < searches && found.size() < most; begin += kBlock) {
      const std::size_t n = std::min(kBlock, searches - begin);
      std::vector<std::vector<Window>> hits(n);
      run_parallel(options.threads, n, [&](std::size_t k, std::size_t) { hits[k] = search(begin + k); });
      for (const auto& windows : hits) found.insert(found.end(), windows.begin(), windows.end());
      if (progress) progress(stage, begin + n, searches);
    }
    if (found.size() > most) found.resize(most);
  };
  const auto beside_faces = [&](std::size_t k) {
    FaceSample sample = faces.draw((round << 24) + k);
    if (k % 2 == 1) {  // so that windows are met that are much smaller than the face
      sample.picture = enlarged(sample.picture, 2);
      sample.box = {2 * sample.box.center + Vec2{0.5f, 0.5f}, 2 * sample.box.side};
    }
    std::vector<WindowHit> hits;
    for (WindowHit& hit : find_hits(sample.picture, trees))
      if (overlap(hit.box, sample.box) < kTuning.beside_overlap) hits.push_back(std::move(hit));
    return some_of(std::move(hits), SampleRandom(options.seed + kBesideStream, (round << 32) + k));
  };
  const auto samples =
      static_cast<std::size_t>(options.effort * static_cast<double>(kTuning.searched_samples));
  collect("searching beside faces", samples,
          static_cast<std::size_t>(kTuning.beside_hits * static_cast<double>(count)), beside_faces);
  collect("searching pictures without faces", pictures.size(), count, [&](std::size_t k) {
    return some_of(find_hits(others.picture(pictures[k]), trees),
                   SampleRandom(options.seed + kHitStream, (round << 32) + k + 1));
  });
  return found;
}

}  // namespace pliant::host::learn
