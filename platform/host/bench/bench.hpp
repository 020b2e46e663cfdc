#pragma once
/// \file bench.hpp
/// The topics of `pliant bench`. Each prints rows `topic,peer,variant,metric,value`. Times are medians over repeats in one
/// process.
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "host/io/files.hpp"
#include "pliant/tracker_limits.hpp"

namespace pliant::host {

/// Times of stellar operators, restricted adaptation and criteria, and bytes of meshes. `model` may be null; if it is given,
/// its mesh is measured too.
void bench_mesh(std::ostream& out, const ModelFile* model);

/// Inputs of bench_klt. Each is optional.
struct KltInputs {
  std::optional<std::string> pairs;   ///< folder of pairs of pictures with truth.csv
  std::vector<std::string> motions;   ///< folders of 00001.pgm ... and motion.csv, to measure drift
  std::optional<std::string> frames;  ///< a recording
  int count = 480;                    ///< frames of the recording that are read, at most
};
/// Time of corner selection and patch tracking, and errors against known motions.
void bench_klt(std::ostream& out, const KltInputs& inputs);

/// Time of the minimum covariance determinant on generated data, and outliers that it misses.
void bench_mcd(std::ostream& out);

/// Time and error of Tracker::update on rendered frames, with the profiles and with several limits.
void bench_track(std::ostream& out, const ModelFile& file);
/// The same, with one of points, vertices, pixels and parameters changed at a time.
void bench_cost(std::ostream& out, const ModelFile& file);
/// The error with corners only, with edges, with flow, and with all three, on a face that has texture on one half only.
void bench_cues(std::ostream& out, const ModelFile& file);
/// The error over 5,000 frames, one row for every eighth swing of the head.
void bench_drift(std::ostream& out, const ModelFile& file);
/// Error and time of one frame's solve with false observations, for each method of rejection.
void bench_occlusion(std::ostream& out, const ModelFile& model);
/// Starts of a printed surface by its print: at known poses before pictures, and in pictures without it.
/// \param others  folder of pictures; none: blotches, and no pictures without the surface. \param count  starts a case.
void bench_print(std::ostream& out, const ModelFile& file, const std::optional<std::string>& others,
                 int count);

/// What the tracker says of a film with faults of light and camera, and with faces that leave (film_faults.hpp), against what it
/// finds in the film without them: frames said to be tracked and wrong, and frames until it is right again.
/// \param limits  of the tracker, but for the size of the frames.
/// \param film   of one face; every 300th frame begins a clip. \param clips  at most; those without a track throughout are
///               left out. Bad input: a film that cannot be read, or without such a clip.
void bench_faults(std::ostream& out, const ModelFile& file, const TrackerLimits& limits,
                  const std::string& film, std::size_t clips);

/// Positions and Jacobians a second, from cached samples and from the tables, and the time that a personalised identity
/// saves. `model` may be null; a synthetic model is then personalised.
void bench_fields(std::ostream& out, const ModelFile* model);

/// Time and accuracy of the solver on the fitting problems of `folder` (form: fit_problem.hpp). The folder has a
/// solutions.csv with the optimum of each: `problem,prior,cost`. Times are of the minimisation alone, and the median over
/// the problems. The cost is computed in double precision.
void bench_fit(std::ostream& out, const std::string& folder);

}  // namespace pliant::host
