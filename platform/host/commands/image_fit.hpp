#pragma once
/// \file image_fit.hpp
/// A model fitted to one image: to points, to a face detector's box, or as an earlier fit.json says.
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/commands/args.hpp"
#include "host/io/files.hpp"
#include "host/io/fit_file.hpp"
#include "host/io/points_file.hpp"
#include "pliant/face_box.hpp"
#include "pliant/fit.hpp"
#include "pliant/tracker.hpp"
#include "track/start_fit.hpp"

namespace pliant::host {

struct FitSetup {
  ImageSize size;
  float focal_px = 0;                 ///< 0: unknown
  std::optional<Camera> camera;       ///< intrinsics and lens, if known; they replace focal_px
  std::optional<View> view;           ///< initial view; none: found from the points
  std::vector<float> q;               ///< initial parameters; empty: all 0
  std::vector<std::uint8_t> is_free;  ///< one flag per parameter; empty: all are estimated
  FitMethod method = FitMethod::gauss_newton;
  EulerOptions euler;            ///< with FitMethod::euler
  float stiffness = 1;           ///< weight of the prior on the parameters
  bool match_silhouette = true;  ///< ibug00 to ibug16 are matched to the silhouette
};

/// Bad input: fewer than four points, a landmark that the model does not have, or all points within a few pixels.
/// \param source  name of the points, for messages.
void check_points(const ModelFile& file, const std::string& source, const std::vector<NamedPoint>& points);

/// Fits pose, focal length and parameters to points. Bad input: what `check_points` refuses, and points that do not
/// determine the pose.
FitFile fit_to_points(const ModelFile& file, const std::string& source, const std::vector<NamedPoint>& points,
                      const FitSetup& setup);

/// Reads `option` (X,Y,W,H) and --box-of. Bad usage: no numbers, a size that is not positive, or an unknown convention.
/// \return nothing without the option.
std::optional<GivenBox> box_of(const Args& args, const char* option);

/// Puts the frontal model with the parameters of `setup` into a box.
/// \param face  if not null, set to the face box; side 0 for a model without corners of eyes and mouth.
FitFile fit_to_box(const ModelFile& file, const GivenBox& box, const FitSetup& setup,
                   FaceBox* face = nullptr);

/// A fit without points: the view and the parameters given.
FitFile fit_of_view(const Model& model, const ImageSize& size, const View& view, const std::vector<float>& q);

/// Whether the text of a file is that of a fit.json; else it is that of a points.csv.
bool is_fit(std::string_view text);

/// Bad input in `path` unless the fit is of this model.
void check_model(const FitFile& fit, const std::string& path, const ModelFile& file);

/// Converts a fit to the camera that is known, with its lens, or else to the focal length that is known, with the lens of the fit.
/// If neither is, it stays as it is. \param focal_px, camera  as in FitSetup.
void set_camera(float focal_px, const std::optional<Camera>& camera, FitFile* fit);

/// The fit in the text of the file `path`: that of a fit.json, or the model's to a points.csv. Bad input: a fit of another model,
/// or of another image size than that of `image`. \param focal_px, camera  as in set_camera, and in FitSetup.
FitFile fit_in(const std::string& path, const std::string& text, const ModelFile& file, const ImageSize& size,
               const std::string& image, float focal_px, const std::optional<Camera>& camera = std::nullopt);

/// Landmarks with an offset from the model, and their image positions, px (track/offset_landmarks.hpp). Empty if
/// noise explains the residuals of the fit.
std::vector<NamedPoint> person_landmarks(const Model& model, const FitFile& fit);

/// The focal length that is assumed if none is known, px.
float default_focal(const ImageSize& size);
/// The view of a camera with another focal length that has the same image scale; the view itself for 0.
View with_focal(const View& view, float focal_px);
/// The view of a known camera that has the same image scale and position. The lens is ignored.
View with_camera(const View& view, const Camera& camera);

}  // namespace pliant::host
