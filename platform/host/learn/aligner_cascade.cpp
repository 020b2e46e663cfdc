#include "host/learn/aligner_cascade.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "host/learn/aligner_components.hpp"
#include "host/learn/parallel.hpp"

namespace pliant::host::learn {

namespace {

/// sum over rows of a dot product.
double predicted(const std::vector<double>& rows, std::size_t row, std::size_t bytes,
                 const std::uint8_t* block) {
  float sum = 0;
  const double* const w = rows.data() + row * bytes;
  for (std::size_t k = 0; k < bytes; ++k) sum += static_cast<float>(w[k]) * static_cast<float>(block[k]);
  return static_cast<double>(sum);
}

/// A local stage that moves nothing.
LearntStage idle_stage(std::size_t landmarks) {
  LearntStage idle;
  idle.shape = {2, 64, 1, 4, 0, 0, 0, 1, 1, 0};
  idle.local.rows.assign(2 * landmarks * block_bytes(idle.shape), 0);
  idle.local.bias.assign(2 * landmarks, 0);
  idle.local.information.assign(3 * landmarks, 0);
  idle.local.blend.assign(landmarks, 0);
  return idle;
}

/// Sets the weights of two landmarks that mirror each other from the solution of learn_pair.
void set_pair(const std::vector<double>& solution, std::size_t bytes, std::size_t k, std::size_t other,
              LearntLocal* local) {
  const std::size_t inputs = 2 * bytes + 1;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const double* const row = solution.data() + axis * inputs;
    const double sign = axis == 0 ? -1 : 1;
    double* const of_k = local->rows.data() + (2 * k + axis) * bytes;
    double* const of_other = local->rows.data() + (2 * other + axis) * bytes;
    for (std::size_t i = 0; i < bytes; ++i) {
      of_other[i] = sign * row[bytes + i];
      of_k[i] = row[i];
    }
    local->bias[2 * other + axis] = sign * row[inputs - 1];
    local->bias[2 * k + axis] = row[inputs - 1];
  }
}

}  // namespace

AlignerCascade::AlignerCascade(const Model& model, std::vector<int> numbers, const LearnOptions& options,
                               const AlignerCascadeTuning& tuning)
    : model_(model),
      numbers_(std::move(numbers)),
      options_(options),
      tuning_(tuning),
      stages_(static_cast<std::size_t>(tuning.folds) + 1) {
  for (int t = 0; t < options.threads; ++t) {
    passes_.push_back(std::make_unique<OwnedPass>(model, numbers_.size()));
    const std::vector<std::uint8_t> names(numbers_.begin(), numbers_.end());
    if ((*passes_.back())->choose_landmarks(model, names.data(), names.size()) != names.size())
      fail_input("the model", "lacks landmarks");
  }
}

std::vector<std::uint8_t> AlignerCascade::table(int fold, const LearntCheck* check) const {
  const auto& stages = stages_[static_cast<std::size_t>(fold)];
  const LearntCheck blank = blank_check(numbers_.size(), stages.back().shape);
  return encode_aligner(numbers_, stages, check != nullptr ? *check : blank);
}

void AlignerCascade::learn(const AlignerStage& shape) {
  if (!is_valid(shape)) fail_input("alignment", "a stage is out of range");
  if (shape.components == 0)
    learn_local(shape);
  else
    learn_global(shape);
  blocks_.clear();
  wanted_.clear();
  move_examples();
}

double AlignerCascade::choose_ridge(const std::vector<RidgeSums>& folds) const {
  const RidgeSums all = sum_of(folds);
  double best = tuning_.ridges[0], least = 1e300;
  for (const double ridge : tuning_.ridges) {
    double error = 0;
    for (const RidgeSums& f : folds) {
      RidgeSums others = all;
      others.add(f, -1);
      for (const double e : squared_errors(f, solve_ridge(others, ridge))) error += e;
    }
    if (error < least) {
      least = error;
      best = ridge;
    }
  }
  return best;
}

std::vector<double> AlignerCascade::information(const std::vector<double>& moments, double weight) const {
  const double least = tuning_.least_variance;
  const double xx = moments[0] / std::max(weight, 1e-9) + least, xy = moments[1] / std::max(weight, 1e-9),
               yy = moments[2] / std::max(weight, 1e-9) + least;
  const double determinant = xx * yy - xy * xy;
  return {yy / determinant, -xy / determinant, xx / determinant};
}

/// A thread's pass, at the view and the parameters that an example has now.
AlignerPass& AlignerCascade::start_pass(std::size_t thread, const AlignerExample& example) const {
  AlignerPass& pass = **passes_[thread];
  pass.start(frame_of(*example.picture), Lens{}, example.view, example.q.data(), nullptr);
  return pass;
}

/// Reads the blocks of a local stage in all examples, and the displacements of their landmarks.
void AlignerCascade::collect_blocks(const AlignerStage& shape) {
  const std::size_t landmarks = numbers_.size(), bytes = block_bytes(shape), n = examples_.size();
  blocks_.assign(landmarks, std::vector<std::uint8_t>(n * bytes));
  wanted_.assign(landmarks, std::vector<double>(2 * n));
  gates_.assign(n, 0);
  run_parallel(options_.threads, n, [&](std::size_t e, std::size_t thread) {
    const AlignerExample& example = examples_[e];
    AlignerPass& pass = start_pass(thread, example);
    pass.prepare(shape);
    gates_[e] = pass.gate();
    for (std::size_t k = 0; k < landmarks; ++k) {
      const Vec2 middle =
          pass.describe_around(pass.shape().evaluate(k).x, shape, blocks_[k].data() + e * bytes);
      const Vec2 d = shape.mm_per_px * (pass.map().to_crop(example.truth[k]) - middle);
      wanted_[k][2 * e] = static_cast<double>(d.x);
      wanted_[k][2 * e + 1] = static_cast<double>(d.y);
    }
  });
}

void AlignerCascade::learn_local(const AlignerStage& shape) {
  const std::size_t landmarks = numbers_.size(), bytes = block_bytes(shape);
  collect_blocks(shape);
  std::vector<LearntStage> learnt(stages_.size());
  for (LearntStage& s : learnt) {
    s.shape = shape;
    s.local.rows.resize(2 * landmarks * bytes);
    s.local.bias.resize(2 * landmarks);
    s.local.information.resize(3 * landmarks);
    s.local.blend.assign(landmarks, 0);
  }
  // The landmarks of a pair are learnt together.
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t k = 0; k < landmarks; ++k) {
    const auto other = std::find(numbers_.begin(), numbers_.end(), mirrored_landmark_number(numbers_[k]));
    if (other == numbers_.end()) fail_input("alignment", "a landmark is without its counterpart");
    const auto o = static_cast<std::size_t>(other - numbers_.begin());
    if (k <= o) pairs.emplace_back(k, o);
  }
  run_parallel(options_.threads, pairs.size(), [&](std::size_t p, std::size_t) {
    learn_pair(shape, pairs[p].first, pairs[p].second, &learnt);
  });
  run_parallel(options_.threads, pairs.size(), [&](std::size_t p, std::size_t) {
    learn_information(shape, pairs[p].first, pairs[p].second, &learnt);
    if (pairs[p].first != pairs[p].second) learn_information(shape, pairs[p].second, pairs[p].first, &learnt);
  });
  for (std::size_t f = 0; f < learnt.size(); ++f) stages_[f].push_back(std::move(learnt[f]));
}

/// Weight of a landmark of an example; 0 where it is no example.
double AlignerCascade::weight_of(std::size_t e, std::size_t k) const {
  const double* const y = &wanted_[k][2 * e];
  if (std::hypot(y[0], y[1]) > tuning_.most_displacement_mm) return 0;
  return tuning_.weight_of_trust[examples_[e].trust[k]];
}

/// Sums up a landmark's examples of one fold, and those of its counterpart on the other side, mirrored.
void AlignerCascade::sum_pair(const AlignerStage& shape, std::size_t k, std::size_t other, int fold,
                              RidgeSums* sums) const {
  const std::size_t bytes = block_bytes(shape);
  sums->resize(2 * bytes + 1, 2);
  RidgeRows rows(*sums);
  std::vector<float> x(2 * bytes);
  std::vector<std::uint8_t> mirrored(bytes);
  for (std::size_t e = 0; e < examples_.size(); ++e) {
    if (examples_[e].fold != fold) continue;
    for (const bool is_mirrored : {false, true}) {
      const std::size_t l = is_mirrored ? other : k;
      const double weight = weight_of(e, l);
      if (!(weight > 0)) continue;
      const std::uint8_t* const block = blocks_[l].data() + e * bytes;
      mirror_block(block, shape.cells, mirrored.data());
      const std::uint8_t* const near = is_mirrored ? mirrored.data() : block;
      const std::uint8_t* const far = is_mirrored ? block : mirrored.data();
      const float right = is_mirrored ? 1 - gates_[e] : gates_[e];
      for (std::size_t i = 0; i < bytes; ++i) {
        x[i] = (1 - right) * static_cast<float>(near[i]);
        x[bytes + i] = right * static_cast<float>(far[i]);
      }
      const double y[2] = {is_mirrored ? -wanted_[l][2 * e] : wanted_[l][2 * e], wanted_[l][2 * e + 1]};
      rows.add(x.data(), y, weight);
    }
  }
}

/// Learns the weights of a landmark and of its counterpart on the other side. Every example teaches twice: landmark k as it is,
/// and landmark `other` of the mirror image. The weights of landmark `other` are those that read k's mirrored block.
void AlignerCascade::learn_pair(const AlignerStage& shape, std::size_t k, std::size_t other,
                                std::vector<LearntStage>* learnt) const {
  std::vector<RidgeSums> folds(static_cast<std::size_t>(tuning_.folds));
  for (std::size_t f = 0; f < folds.size(); ++f) sum_pair(shape, k, other, static_cast<int>(f), &folds[f]);
  const double ridge = choose_ridge(folds);
  const RidgeSums all = sum_of(folds);
  for (std::size_t f = 0; f < learnt->size(); ++f) {
    RidgeSums others = all;
    if (f < folds.size()) others.add(folds[f], -1);
    set_pair(solve_ridge(others, ridge), block_bytes(shape), k, other, &(*learnt)[f].local);
  }
}

/// Covariance of the errors on examples of people left out.
void AlignerCascade::learn_information(const AlignerStage& shape, std::size_t k, std::size_t other,
                                       std::vector<LearntStage>* learnt) const {
  const std::size_t bytes = block_bytes(shape);
  std::vector<double> moments(3);
  std::vector<std::uint8_t> mirrored(bytes);
  double weight = 0;
  for (std::size_t e = 0; e < examples_.size(); ++e) {
    const double w = weight_of(e, k);
    if (!(w > 0)) continue;
    const LearntLocal& local = (*learnt)[static_cast<std::size_t>(examples_[e].fold)].local;
    const std::uint8_t* const block = blocks_[k].data() + e * bytes;
    mirror_block(block, shape.cells, mirrored.data());
    const double right = static_cast<double>(gates_[e]);
    double r[2];
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const double sign = axis == 0 ? -1 : 1;
      r[axis] = wanted_[k][2 * e + axis] - local.bias[2 * k + axis] -
                (1 - right) * predicted(local.rows, 2 * k + axis, bytes, block) -
                sign * right * predicted(local.rows, 2 * other + axis, bytes, mirrored.data());
    }
    moments[0] += w * r[0] * r[0];
    moments[1] += w * r[0] * r[1];
    moments[2] += w * r[1] * r[1];
    weight += w;
  }
  const std::vector<double> known = information(moments, weight);
  for (LearntStage& s : *learnt)
    std::copy(known.begin(), known.end(), s.local.information.begin() + static_cast<std::ptrdiff_t>(3 * k));
}

/// Reads the grids of a global stage in all examples, and the displacements of their landmarks.
void AlignerCascade::collect_grids(const AlignerStage& shape) {
  const std::size_t block = block_bytes(shape), bytes = grid_bytes(shape), outputs = 2 * numbers_.size();
  blocks_.assign(1, std::vector<std::uint8_t>(examples_.size() * bytes));
  wanted_.assign(1, std::vector<double>(outputs * examples_.size()));
  run_parallel(options_.threads, examples_.size(), [&](std::size_t e, std::size_t thread) {
    const AlignerExample& example = examples_[e];
    AlignerPass& pass = start_pass(thread, example);
    pass.prepare(shape);
    std::uint8_t* to = blocks_[0].data() + e * bytes;
    for (int j = 0; j < shape.blocks; ++j)
      for (int i = 0; i < shape.blocks; ++i, to += block) pass.describe_place(i, j, shape, to);
    for (std::size_t k = 0; k < numbers_.size(); ++k) {
      const Vec2 d = shape.mm_per_px *
                     (pass.map().to_crop(example.truth[k]) - pass.map().to_crop(pass.shape().evaluate(k).x));
      wanted_[0][outputs * e + 2 * k] = static_cast<double>(d.x);
      wanted_[0][outputs * e + 2 * k + 1] = static_cast<double>(d.y);
    }
  });
}

void AlignerCascade::learn_global(const AlignerStage& shape) {
  const std::size_t bytes = grid_bytes(shape), outputs = 2 * numbers_.size();
  collect_grids(shape);
  std::vector<RidgeSums> folds(static_cast<std::size_t>(tuning_.folds));
  run_parallel(options_.threads, folds.size(), [&](std::size_t f, std::size_t) {
    folds[f].resize(bytes + 1, outputs);
    RidgeRows rows(folds[f]);
    for (std::size_t e = 0; e < examples_.size(); ++e)
      if (examples_[e].fold == static_cast<int>(f) && !examples_[e].is_refinement)
        rows.add(blocks_[0].data() + e * bytes, &wanted_[0][outputs * e], 1);
  });
  const double ridge = choose_ridge(folds);
  const RidgeSums all = sum_of(folds);
  std::vector<LearntStage> learnt(stages_.size());
  run_parallel(options_.threads, learnt.size(), [&](std::size_t f, std::size_t) {
    RidgeSums others = all;
    if (f < folds.size()) others.add(folds[f], -1);
    learnt[f].shape = shape;
    learnt[f].global = reduce_to_components(others, solve_ridge(others, ridge), shape.components);
    learnt[f].shape.components = static_cast<std::uint8_t>(learnt[f].global.bias.size());
  });
  learn_global_information(bytes, &learnt);
  for (std::size_t f = 0; f < learnt.size(); ++f) stages_[f].push_back(std::move(learnt[f]));
}

/// Covariance of the errors on examples of people left out.
void AlignerCascade::learn_global_information(std::size_t bytes, std::vector<LearntStage>* learnt) const {
  const std::size_t landmarks = numbers_.size();
  std::vector<double> moments(3 * landmarks);
  double count = 0;
  for (std::size_t e = 0; e < examples_.size(); ++e) {
    if (examples_[e].is_refinement) continue;
    const LearntGlobal& g = (*learnt)[static_cast<std::size_t>(examples_[e].fold)].global;
    const std::size_t components = g.bias.size();
    std::vector<double> value(components);
    for (std::size_t c = 0; c < components; ++c)
      value[c] = g.bias[c] + predicted(g.basis, c, bytes, blocks_[0].data() + e * bytes);
    for (std::size_t k = 0; k < landmarks; ++k) {
      double r[2];
      for (std::size_t axis = 0; axis < 2; ++axis) {
        r[axis] = wanted_[0][2 * (landmarks * e + k) + axis] - g.mean[2 * k + axis];
        for (std::size_t c = 0; c < components; ++c)
          r[axis] -= g.output[(2 * k + axis) * components + c] * value[c];
      }
      moments[3 * k] += r[0] * r[0];
      moments[3 * k + 1] += r[0] * r[1];
      moments[3 * k + 2] += r[1] * r[1];
    }
    count += 1;
  }
  for (std::size_t k = 0; k < landmarks; ++k) {
    const auto known = information({moments[3 * k], moments[3 * k + 1], moments[3 * k + 2]}, count);
    for (LearntStage& s : *learnt)
      s.global.information.insert(s.global.information.end(), known.begin(), known.end());
  }
}

void AlignerCascade::move_examples() {
  std::vector<std::unique_ptr<OpenAlignerTable>> tables;
  for (int f = 0; f < tuning_.folds; ++f) {
    // The runtime wants a local stage at the end; a global one alone gets an idle one.
    tables.push_back(nullptr);
    std::vector<LearntStage> stages = {stages_[static_cast<std::size_t>(f)].back()};
    if (stages[0].shape.components > 0) {
      stages.push_back(idle_stage(numbers_.size()));
    }
    tables.back() = std::make_unique<OpenAlignerTable>(
        encode_aligner(numbers_, stages, blank_check(numbers_.size(), stages.back().shape)));
  }
  const AlignerStage shape = (*tables[0])->stage(0);
  run_parallel(options_.threads, examples_.size(), [&](std::size_t e, std::size_t thread) {
    AlignerExample& example = examples_[e];
    if (example.is_refinement && shape.refines == 0) return;
    AlignerPass& pass = start_pass(thread, example);
    pass.run_stage(**tables[static_cast<std::size_t>(example.fold)], 0);
    if (!pass.shape().is_usable()) return;
    example.view = pass.shape().view();
    example.q.assign(pass.shape().q(), pass.shape().q() + example.q.size());
  });
}

void AlignerCascade::learn_blend() {
  std::vector<std::unique_ptr<OpenAlignerTable>> tables;
  for (int f = 0; f < tuning_.folds; ++f) tables.push_back(std::make_unique<OpenAlignerTable>(table(f)));
  const std::size_t landmarks = numbers_.size(), last = stages_[0].size() - 1;
  std::vector<std::vector<double>> terms(examples_.size());
  run_parallel(options_.threads, examples_.size(), [&](std::size_t e, std::size_t thread) {
    const AlignerExample& example = examples_[e];
    AlignerPass& pass = start_pass(thread, example);
    pass.weigh(**tables[static_cast<std::size_t>(example.fold)]);
    for (std::size_t k = 0; k < landmarks; ++k) {
      const Vec2 x = pass.image(k), d = pass.target(k) - x;
      const double w = tuning_.weight_of_trust[example.trust[k]] /
                       static_cast<double>(example.eye_distance * example.eye_distance);
      terms[e].push_back(w * static_cast<double>(dot(example.truth[k] - x, d)));
      terms[e].push_back(w * static_cast<double>(dot(d, d)));
    }
  });
  for (std::size_t k = 0; k < landmarks; ++k) {
    double above = 0, below = 1e-12;
    for (const auto& t : terms) {
      above += t[2 * k];
      below += t[2 * k + 1];
    }
    const double blend = std::clamp(above / below, 0.0, 1.0);
    for (auto& stages : stages_) stages[last].local.blend[k] = blend;
  }
}

}  // namespace pliant::host::learn
