#pragma once
/// \file start.hpp
/// Where a model is in one picture: fitted to named points, put into a box, or taken from an earlier fit.
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "host/commands/args.hpp"
#include "host/io/files.hpp"
#include "host/io/fit_file.hpp"
#include "host/io/points_file.hpp"
#include "pliant/fit.hpp"

namespace pliant::host {

struct FitSetup {
  ImageSize size;
  float focal_px = 0;                 ///< 0: unknown
  std::optional<Camera> camera;       ///< known intrinsics and lens, instead of `focal_px`
  std::optional<View> view;           ///< a rough pose, else found from the points
  std::vector<float> q;               ///< where the parameters start; empty: all 0
  std::vector<std::uint8_t> is_free;  ///< a flag a parameter; empty: all free
  FitMethod method = FitMethod::gauss_newton;
  EulerOptions euler;
  float stiffness = 1;
  bool match_silhouette = true;  ///< ibug00 to ibug16 are where the face ends in the picture
};

/// Fits pose, focal length and parameters. Bad input: a landmark that the model does not have, fewer than
/// four points, points that do not determine the pose.
FitFile fit_to_points(const ModelFile& file, const std::string& source, const std::vector<NamedPoint>& points,
                      const FitSetup& setup);

/// The neutral model, frontal, in a face detector's box: x, y of the upper left corner, width, height (px).
FitFile fit_to_box(const ModelFile& file, const std::vector<float>& box, const FitSetup& setup);

/// Whether a start's text is that of a fit.json; else it is that of points.
bool is_fit(const std::string& text);
/// The start that a file holds: a fit.json, or points that are fitted. Bad input: a fit of another model, or of another
/// size than that of `picture`.
FitFile read_start(const std::string& path, const ModelFile& file, const ImageSize& size,
                   const std::string& picture, float focal_px,
                   const std::optional<Camera>& camera = std::nullopt);

/// Where the person has the landmarks that a fit was given points of (track/personal_landmarks.hpp).
std::vector<Correspondence> personal_landmarks(const Model& model, const FitFile& fit);

/// Parameters by name and everything else of a fit without points.
FitFile describe(const Model& model, const ImageSize& size, const View& view, const std::vector<float>& q);

/// The focal length that is assumed when none is given.
float default_focal(const ImageSize& size);
/// The same model in the same place of the picture, seen by a known camera: another focal length and principal point. The
/// lens is not looked at.
View with_camera(const View& view, const Camera& camera);
/// The view that looks the same at its depth, of a camera with another focal length; unchanged for 0.
View with_focal(const View& view, float focal_px);

/// One line that names the parameters of `source` which the model does not have; nothing when there are none.
void list_unmatched(const std::vector<std::string>& names, const std::string& source, std::ostream& err);

}  // namespace pliant::host
