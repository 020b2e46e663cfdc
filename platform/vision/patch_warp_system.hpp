#pragma once
// The least squares system that explains a window of the current image by a template, its light, warp and shift.
#include "pliant/geometry.hpp"
#include "vision/patch_workspace.hpp"

namespace pliant::patch {

/// Place of an entry of a lower triangle, row by row. \pre column <= row.
constexpr int lower(int row, int column) {
  return row * (row + 1) / 2 + column;
}

/// Normal equations in the images X = (x, y; T; x gx, y gx, x gy, y gy; gx, gy) of a template, all less their means, with
/// the priors on ramp and warp, and their factor L diag(d) L'. Order of the unknowns: kRamp, kLight, kStretch, kShift.
struct WarpSystem {
  int first;                         ///< unknown that is fitted: kRamp, or kLight where there is no ramp
  const i16* images[kUnknowns + 1];  ///< from the first one on, and the mask
  i32 n;                             ///< usable pixels
  float inverse_n;
  i32 sums[kUnknowns];
  float products[lower(kUnknowns, 0)];  ///< without the priors; lower triangle
  float l[lower(kUnknowns, 0)];         ///< unit lower triangle
  float d[kUnknowns], inverse_d[kUnknowns];
  Vec2 along;        ///< unit direction of the only texture there is; zero: in both
  bool is_solvable;  ///< there is enough texture; otherwise only the sums are meaningful
};

/// Sets up the system of a template's images and their mask. \param images  kUnknowns + 1 arrays of `count` elements.
/// \param ramp_sd  as PatchOptions::ramp_sd; 0: the images of the ramp are not read.
void prepare(const i16* const* images, int window, float ramp_sd, bool accepts_edges, WarpSystem& s);

/// The fit to one image: right-hand side b, solution x, and the image's sum.
struct WarpFit {
  i32 sum;
  float b[kUnknowns], x[kUnknowns];
};
/// Fits the image; the stretch is expected to be `expected`, in the units of the images. Precondition: is_solvable.
WarpFit fit(const WarpSystem& s, const Mat2& expected, const i16* image, int count);

/// Sum of squares of the image (centred, `variance_sum`) that the fit leaves unexplained, at least 0.
float unexplained(const WarpSystem& s, const WarpFit& fit, float variance_sum);

/// Information of the shift, the Schur complement of all other unknowns, times `scale`.
Sym2 shift_information(const WarpSystem& s, float scale);

}  // namespace pliant::patch
