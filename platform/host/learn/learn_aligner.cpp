#include "host/learn/learn_aligner.hpp"

#include <algorithm>

#include "host/learn/aligner_check.hpp"
#include "host/learn/parallel.hpp"

namespace pliant::host::learn {

namespace {

/// Tuning of the training of alignment. Each constant: reason, experiment.
struct AlignerTuning {
  int samples =
      6000;  ///< pictures, count; twice as many lower the error of people left out by less than a tenth of it
  int starts = 2;  ///< a picture
  int first_landmark = 17,
      last_landmark = 67;  ///< brows to lips: the landmarks of the jaw have no fixed place on the surface
  /// Of the samples: of drawn people; how many people those are; and how far they turn, rad. With more of them rendered heads are
  /// aligned better, and the recorded face in some trainings worse: docs/experiments.md, Drawn people.
  float drawn_fraction = 0.15f;
  std::size_t drawn_people = 80;
  DrawnTurn drawn_turn{0.35f, 0.35f};
};
constexpr AlignerTuning kTuning{};

/// The stages: millimetres a pixel and side of the crop, cells and their side, blocks and components, refines, stride, prior.
/// Global stages catch position, roll, yaw and scale of a start; local ones go from coarse to fine.
const AlignerStage kStages[] = {
    {3.0f, 72, 4, 6, 3, 16, 0, 3, 2, 0},   {2.6f, 72, 4, 6, 3, 20, 0, 3, 1, 0},
    {2.4f, 76, 5, 4, 0, 0, 1, 2, 1.5f, 0}, {1.6f, 96, 5, 4, 0, 0, 1, 1, 2, 0},
    {1.4f, 104, 6, 3, 0, 0, 1, 1, 1, 0},
};

void draw_examples(const FaceSamples& faces, AlignerCascade& cascade, const LearnProgress& progress) {
  const LearnOptions& options = cascade.options();
  const auto samples = static_cast<std::size_t>(std::max(16.0, options.effort * kTuning.samples));
  std::vector<std::unique_ptr<AlignerExamples>> sources;
  for (int t = 0; t < options.threads; ++t)
    sources.push_back(std::make_unique<AlignerExamples>(cascade.model(), faces, cascade.numbers(),
                                                        cascade.folds(), options.seed));
  std::vector<std::vector<AlignerExample>> drawn(samples);
  run_parallel(options.threads, samples, [&](std::size_t k, std::size_t thread) {
    drawn[k] = sources[thread]->draw(k, kTuning.starts);
    if (thread == 0 && progress) progress("alignment: samples", k, samples);
  });
  for (auto& examples : drawn)
    std::move(examples.begin(), examples.end(), std::back_inserter(cascade.examples()));
}

}  // namespace

FaceSampleTuning aligner_sample_tuning() {
  FaceSampleTuning t;
  t.drawn_fraction = kTuning.drawn_fraction;
  t.drawn_people = kTuning.drawn_people;
  t.drawn_turn = kTuning.drawn_turn;
  return t;
}

std::vector<std::uint8_t> learn_aligner(const Model& model, const FaceSamples& faces,
                                        const OtherPictures& others, const OtherPictures& drawn,
                                        const std::vector<std::uint8_t>& detector,
                                        const LearnOptions& options, const LearnProgress& progress) {
  std::vector<int> numbers;
  for (int k = kTuning.first_landmark; k <= kTuning.last_landmark; ++k) numbers.push_back(k);
  AlignerCascade cascade(model, numbers, options);
  draw_examples(faces, cascade, progress);
  std::size_t done = 0;
  for (const AlignerStage& stage : kStages) {
    if (progress) progress("alignment: stages", done++, std::size(kStages));
    cascade.learn(stage);
  }
  cascade.learn_blend();
  const LearntCheck check = learn_check(cascade, others, drawn, detector, progress);
  return cascade.table(cascade.folds(), &check);
}

}  // namespace pliant::host::learn
