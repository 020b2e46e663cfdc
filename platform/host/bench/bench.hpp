#pragma once
/// \file bench.hpp
/// The topics of `pliant bench`. Each prints rows `topic,peer,variant,metric,value`; times are medians over repeats in one
/// process, to be compared with another program's of the same run.
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "host/io/files.hpp"

namespace pliant::host {

/// Stellar operators, restricted adaptation, criteria, memory. With a model also its own mesh.
void bench_mesh(std::ostream& out, const ModelFile* model);

/// Corner selection and patch tracking against known motions. `pairs`: a folder of pairs of pictures with truth.csv;
/// `motions`: folders of 00001.pgm ... with motion.csv, for the drift; `frames`: a recording, of which `count` are used.
struct KltInputs {
  std::optional<std::string> pairs;
  std::vector<std::string> motions;
  std::optional<std::string> frames;
  int count = 480;
};
void bench_klt(std::ostream& out, const KltInputs& inputs);

/// The minimum covariance determinant on generated data.
void bench_mcd(std::ostream& out);

/// The tracker's whole step on rendered frames: time, against points, vertices, parameters and pixels, and error in the
/// same runs.
void bench_track(std::ostream& out, const ModelFile& file);
/// The same against points, vertices, pixels and parameters, one of them changed at a time: to plan with.
void bench_cost(std::ostream& out, const ModelFile& file);
/// The error with corners only, with edges, with flow, and with all three, on a face without texture on one half.
void bench_cues(std::ostream& out, const ModelFile& file);
/// The error at the end of 5,000 frames, against that at the 50th.
void bench_drift(std::ostream& out, const ModelFile& file);
/// One frame's error with false observations, by each way to deal with them.
void bench_occlusion(std::ostream& out, const ModelFile& model);

/// Fields and Jacobians a second, baked and from the tables; what folding an identity saves, of the model if there is one.
void bench_fields(std::ostream& out, const ModelFile* model);

/// The solver on the fitting problems of `folder` (bench_fit_problem.hpp tells their form), with solutions.csv beside them:
/// `problem,prior,cost`. Times are of the minimisation alone, of the median problem; cost is measured in double.
void bench_fit(std::ostream& out, const std::string& folder);

}  // namespace pliant::host
