#pragma once
/// \file klt.hpp
/// Common parts of `pliant bench klt`: two pyramids and a tracker, affine motions, and error statistics.
#include "host/bench/rows.hpp"
#include "host/io/owned.hpp"
#include "host/io/pnm.hpp"
#include "pliant/corners.hpp"
#include "pliant/patch_tracker.hpp"

namespace pliant::host {

/// Reads a PGM or PPM picture. Any other file is bad input.
LumaPicture read_luma(const std::string& path);
FrameView view_of(const LumaPicture& picture);

constexpr int kKltLevels = 3;

/// Two frames and a tracker between them.
struct KltRig {
  Owned<Pyramid> before, after;
  Owned<PatchTracker> tracker;

  KltRig(int width, int height, int window, int slots)
      : before(PyramidLimits{width, height, kKltLevels, true}),
        after(PyramidLimits{width, height, kKltLevels, true}),
        tracker(PatchLimits{slots, window, kKltLevels, 5}) {}
};

/// x -> (a x + b y + tx, c x + d y + ty).
struct Affinity {
  double a = 1, b = 0, c = 0, d = 1, tx = 0, ty = 0;

  Vec2 operator()(Vec2 p) const {
    return {static_cast<float>(a * double(p.x) + b * double(p.y) + tx),
            static_cast<float>(c * double(p.x) + d * double(p.y) + ty)};
  }
  Mat2 matrix() const {
    return {static_cast<float>(a), static_cast<float>(b), static_cast<float>(c), static_cast<float>(d)};
  }
};

/// Errors (px) of the points that were kept, and counts of those that were tried, lost, or wrong by more than 1 px.
struct KltOutcome {
  std::vector<double> errors;
  int tried = 0, lost = 0, wrong = 0, hidden = 0, hidden_kept = 0;

  void add(bool is_kept, Vec2 found, Vec2 truth);
  void print(const BenchRows& row, const std::string& variant) const;
};

/// The best `most` corners of the allowed cells (see find_corners); all cells if `allowed` is empty.
std::vector<Vec2> best_corners(const ImageView& image, std::size_t most, const CornerOptions& options,
                               const std::vector<std::uint8_t>& allowed = {});

/// Drift over a known motion, and time on a recording.
void bench_klt_drift(const BenchRows& row, const std::string& folder);
void bench_klt_sequence(const BenchRows& row, const std::string& frames, int count);

}  // namespace pliant::host
