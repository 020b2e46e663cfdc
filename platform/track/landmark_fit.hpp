#pragma once
/// \file landmark_fit.hpp
/// The fit that a start from landmarks needs: person, expression, pose and focal length from named points of one image.
#include <cstddef>
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/fit.hpp"
#include "pliant/model.hpp"

namespace pliant {

/// Tuning of the fit of landmarks. Each constant: unit, reason, experiment.
struct LandmarkFitTuning {
  /// Standard deviation of a landmark around the model, as a fraction of the points' spread: noise of the
  /// annotation, and what the model's identity cannot express. With the annotation's alone (0.005) 43 % of
  /// fits of portraits ended with an identity parameter at its limit and focal lengths from 0.4 picture
  /// widths on; with 0.01 none of 87 did, 0.6 to 1.4 widths. 0.02 costs accuracy of starts from 11 points
  /// (docs/experiments.md, section Tuning).
  float point_sd_fraction = 0.01f;
  /// Standard deviation of an annotation alone, as a fraction of the points' spread. Residuals beyond it become landmark
  /// offsets. A model with a hundred identities fits points to less than 0.005, which left no offsets: its brows were off by
  /// 2.3 px in the originals of the recorded face, 0.95 px with 0.003 (docs/experiments.md, section Tuning).
  /// 0.002 is no better.
  float annotation_sd_fraction = 0.003f;
  /// Factor on point_sd_fraction while expressions are fitted. A person's thinner lips, or a landmark
  /// annotated at another position, must not be explained by an expression. 1 and 2 make starts from 5 points
  /// worse, 6 is no better.
  float expression_caution = 3;
  /// Spread below which the points count as one spot, px. Round value, not tuned.
  float least_spread_px = 4;
};
inline constexpr LandmarkFitTuning kLandmarkFitTuning{};

/// Diagonal of the points' bounding box, px; infinite without points.
float spread_of(Span<const Correspondence> points);

/// Whether a landmark's name is one of `ibug00` to `ibug16`: annotations put those on the silhouette of the face.
bool is_silhouette_landmark(const char* name);

/// The camera of a start: the one given, else centred with the focal length given, else with the assumed one.
Camera start_camera(const Camera* known, float focal_px, int width, int height);

/// Fits a model to landmarks. First all parameters, with cautious deviations; then the identity, with the expression
/// held. A model without identity, as a sheet, has nothing that an expression could be mistaken for: one fit
/// with the plain deviations.
class LandmarkFit {
 public:
  /// Lays out memory for that many points, silhouette points included. \param samples_base_mesh  as in FitLimits.
  void lay_out(Arena& arena, const Model& model, std::size_t points, bool samples_base_mesh = false);

  /// \param points   sd_px is set here. \param options  is_free null: the two stages above; else one fit of those.
  /// \param q        all parameters, start and result.
  /// \return underdetermined (points within least_spread_px), and the statuses of Fitter::fit.
  Status fit(Span<Correspondence> points, const FitOptions& options, float* q);

  /// Of the last fit.
  const FitReport& report() const { return report_; }
  /// FitDetails::point_sd of each parameter, of the stage that estimated it.
  const float* sd() const { return sd_; }
  const Vec2* residuals() const { return residuals_; }  ///< px, a point: projected minus observed
  const float* weights() const { return weights_; }     ///< in [0,1], a point
  /// Whether the fit moved silhouette point k away from its own (u,v).
  bool has_slid(std::size_t k) const { return fitter_.has_slid(k); }

  /// Where the person has the landmarks (find_offset_landmarks). `points` are those of the fit; they are rearranged,
  /// and their sd_px becomes that of an annotation.
  Span<Correspondence> offset_landmarks(Span<Correspondence> points);

 private:
  Status fit_in_stages(Span<Correspondence> points, FitOptions options, float* q);

  Fitter fitter_;
  FitReport report_;
  bool has_identity_ = false;
  std::uint8_t *is_identity_ = nullptr, *is_landmark_ = nullptr;
  float *sd_ = nullptr, *stage_sd_ = nullptr, *weights_ = nullptr;
  Vec2* residuals_ = nullptr;
};

}  // namespace pliant
