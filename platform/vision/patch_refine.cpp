// The last steps, at full size. `align` leaves two errors: the phase error of bilinear sampling, and the shift that a
// warp that was not predicted causes. Here the image is sampled by cubic convolution and explained by least squares
// as
//   I' = gain T' + sum_k c_k X_k' + r . x' + a . G',        X = (x gx, y gx, x gy, y gy);
// the shift is -a / gain (docs/algorithms.md, section 7.2). The prior of c is centred on the part of the predicted
// warp that the template was not resampled by, as if the gain were one; that of the ramp r on zero.
#include "vision/patch_refine.hpp"

#include "vision/patch_sums.hpp"
#include "vision/patch_warp_system.hpp"
#include "vision/patch_window.hpp"

namespace pliant::patch {
namespace {

constexpr float kUnit = 1.0f / kGreyScale;

// Fraction of white noise's variance that cubic sampling at a phase leaves: fitted to the sum of its squared weights.
float noise_left(int coordinate) {
  const float t = static_cast<float>(phase(coordinate)) / kSubpixel, p = t * (1 - t);
  return 1 - 5.76f * p * p;
}

Measurement measure(const WarpSystem& s, const WarpFit& f, GridPosition at, const Workspace& work) {
  Measurement r;
  const auto n = static_cast<float>(s.n);
  const i32 squares = sum_squares(work.image, s.images[kUnknowns], work.count);
  const float variance_sum = centred(s.n, s.inverse_n, squares, f.sum, f.sum);
  const float left = unexplained(s, f, variance_sum);
  r.gain = f.x[kLight];
  r.bias = kUnit * (static_cast<float>(f.sum) / n + kGreyOffset -
                    r.gain * (static_cast<float>(s.sums[kLight]) / n + kGreyOffset));
  const float both = variance_sum * s.products[lower(kLight, kLight)];
  r.correlation = both > 0 ? f.b[kLight] / square_root(both) : 0;
  r.pixels = n;
  r.residual_square = kUnit * kUnit * left / n;
  // Sampling between pixels averages noise in the residual, but not in the sums with the smooth gradient.
  const float smoothing = 2.0f / (1.0f + noise_left(at.x) * noise_left(at.y));
  r.noise_square = kUnit * kUnit * smoothing * left / max(n - static_cast<float>(kUnknowns - s.first + 1), 1);
  r.information = shift_information(s, r.gain * r.gain * kUnit * kUnit);
  return r;
}

// The system of all usable pixels, unless a cached one is there. The images of stretch and ramp belong to the workspace,
// so that they are made in either case.
void prepare_whole(Workspace& work, bool accepts_edges) {
  const Template& t = work.active;
  multiply_by_position(t.gx, work.x, work.y, work.count, work.stretch[0], work.stretch[1]);
  multiply_by_position(t.gy, work.x, work.y, work.count, work.stretch[2], work.stretch[3]);
  if (work.ramp_sd > 0) {
    apply_mask(work.x, t.m, work.count, work.ramp[0]);
    apply_mask(work.y, t.m, work.count, work.ramp[1]);
  }
  if (work.has_system) return;
  const i16* const images[] = {work.ramp[0],    work.ramp[1],    t.t,  work.stretch[0], work.stretch[1],
                               work.stretch[2], work.stretch[3], t.gx, t.gy,            t.m};
  prepare(images, work.window, work.ramp_sd, accepts_edges, *work.system);
  work.has_system = true;
}

// The same system without the pixels that are clipped in the image.
void prepare_unclipped(Workspace& work, bool accepts_edges) {
  const i16* images[kUnknowns + 1] = {};
  for (int i = work.system->first; i < kUnknowns; ++i) {
    apply_mask(work.system->images[i], work.unclipped, work.count, work.masked[i]);
    images[i] = work.masked[i];
  }
  images[kUnknowns] = work.unclipped;
  prepare(images, work.window, work.ramp_sd, accepts_edges, *work.unclipped_system);
}

Vec2 step_of(const WarpFit& f, Vec2 along) {
  const float gain = clamp(f.x[kLight], kPatchTuning.min_gain, kPatchTuning.max_gain);
  Vec2 shift{f.x[kShift], f.x[kShift + 1]};
  if (is_edge(along)) shift = dot(shift, along) * along;
  return (kPatchTuning.step_scale / gain) * shift;
}

}  // namespace

PatchStatus refine(const ImageView& image, const SearchOptions& o, Workspace& work, SearchPosition& p,
                   Measurement& result) {
  constexpr float kStop = kPatchTuning.refine_stop_ratio * kPatchTuning.epsilon_px;
  constexpr float kDiverged = kPatchTuning.diverged_step_ratio * kStop;
  prepare_whole(work, o.accepts_edges);
  // The stretch images are in 16ths, and their gradients fall short of the slope.
  constexpr float kUnits = 16 / kPatchTuning.step_scale;
  const Mat2& left = work.residual_warp;
  const Mat2 expected{kUnits * left.a, kUnits * left.b, kUnits * left.c, kUnits * left.d};
  const Vec2 start = p.x;
  for (int step = 1;; ++step) {
    const GridPosition at = on_grid(p.x);
    if (!is_inside(image, at, work.window / 2)) return PatchStatus::outside_image;
    const bool is_linear = step == 1 && o.is_far, is_last = step == kPatchTuning.max_refine_steps;
    sample_window(image, at, is_linear ? Sampling::linear : Sampling::cubic, work);
    ++p.iterations;
    const bool is_whole = is_all_unclipped(work.system->n, work);
    if (!is_whole) prepare_unclipped(work, o.accepts_edges);
    const WarpSystem& system = is_whole ? *work.system : *work.unclipped_system;
    if (!system.is_solvable) return PatchStatus::flat;
    p.along = system.along;
    const WarpFit f = fit(system, expected, work.image, work.count);
    const Vec2 moved = position(at) - step_of(f, p.along);
    const Vec2 move = moved - p.x, way = moved - start;
    p.x = moved;
    if (!(dot(way, way) < 1) || (is_last && dot(move, move) > kDiverged * kDiverged))
      return PatchStatus::diverged;
    if (is_last || (!is_linear && dot(move, move) < kStop * kStop)) {
      result = measure(system, f, at, work);
      return PatchStatus::ok;
    }
  }
}

}  // namespace pliant::patch
