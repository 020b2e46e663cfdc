#pragma once
/// \file initial_state.hpp
/// The initial state of a track, read from the file of `--init`, and the start of the tracker from it.
#include <optional>
#include <ostream>
#include <string>
#include <variant>
#include <vector>

#include "host/commands/args.hpp"
#include "host/commands/image_fit.hpp"
#include "host/io/files.hpp"
#include "host/io/points_file.hpp"
#include "pliant/tracker.hpp"

namespace pliant::host {

/// A known state of the model in one frame, from a fit or a detection.
struct InitialState {
  Camera camera;
  Pose pose;
  std::vector<float> q;  ///< all parameters, in the model's order
  /// Landmarks with an offset from the model, and their image positions, px.
  std::vector<NamedPoint> landmarks = {};
};

/// Landmarks of one frame. The tracker fits person, pose and focal length to them.
struct InitialLandmarks {
  std::string path;
  std::vector<NamedPoint> points;
};

using Initial = std::variant<InitialState, InitialLandmarks, GivenBox>;

/// Options of the command line besides the file.
struct InitialOptions {
  float focal_px = 0;            ///< 0: unknown
  std::optional<Camera> camera;  ///< intrinsics and lens, if known; they replace focal_px
};

/// The same for the tracker.
StartOptions start_options(const InitialOptions& options);

/// Reads a fit.json, or a points.csv. Points with u,v of their own are fitted here: the tracker takes landmarks by
/// name. Bad input: what `fit_in` and `check_points` refuse. Parameters that the model does not have are listed on
/// `err`.
/// \param frames  name of the frames, for messages.
Initial read_initial(const std::string& path, const ModelFile& file, const ImageSize& size,
                     const std::string& frames, const InitialOptions& options, std::ostream& err);

/// Starts the tracker: start_from_landmarks, start_from_box, or start_from_pose and place_landmarks. Bad input, with the name of
/// the file: landmarks that do not determine the pose. \return every other status of the start.
Status start_tracker(Tracker& tracker, const FrameView& frame, const Initial& initial,
                     const InitialOptions& options, const TrackerOptions& tracker_options,
                     const std::vector<Vec2>& markers);

}  // namespace pliant::host
