#pragma once
/// \file track_table.hpp
/// Reads and writes track CSV: one row a frame with state, pose and parameters.
#include <optional>
#include <string>
#include <vector>

#include "host/io/csv.hpp"
#include "pliant/estimator.hpp"
#include "pliant/model.hpp"

namespace pliant::host {

struct TrackRow {
  std::size_t frame = 0;
  double time_s = 0;
  TrackState state = TrackState::tracking;
  int tracked = 0, inliers = 0;
  float rms_px = 0;
  int vertices = 0;
  float landmark_error = 0;  ///< as FrameResult::landmark_error; 0: unknown, an empty cell
  Vec3 gaze;                 ///< as FrameResult::gaze; 0: not seen, empty cells
  Pose pose;
  std::vector<float> q;                     ///< all parameters, or what the header has instead
  std::vector<std::optional<Vec2>> points;  ///< landmarks and markers; empty cells where there is none
};

/// Angles of a gaze relative to the head, rad: to the subject's left, and up. 0 for no gaze.
struct GazeAngles {
  double left = 0, up = 0;
};
/// \param gaze  as FrameResult::gaze.
GazeAngles gaze_angles(Vec3 gaze);

/// The state as the table spells it: tracking, degraded or lost.
const char* state_text(TrackState state);

/// Whether a track has a column of this name besides those of parameters: no parameter can be called so.
bool is_track_column(const std::string& name);
/// The header: the fixed columns, a parameter each, then x_NAME,y_NAME for each point name.
std::string track_header(const Model& model, const std::vector<std::string>& point_names);
/// The same with other columns instead of the parameters.
std::string track_header(const std::vector<std::string>& value_names,
                         const std::vector<std::string>& point_names);
/// One row. When lost, pose, parameters and points are empty; nothing is ever NaN.
std::string track_line(const TrackRow& row);

/// Pose and parameters of one row of a CSV.
struct PosedParameters {
  Pose pose;
  std::vector<float> q;
};

/// What an empty cell stands for: in frames, which follow each other, the value of the row before.
enum class EmptyCell { row_before, neutral };

/// Reads any CSV with columns of those names. A missing column keeps the value of `neutral`. Columns that are neither parameters
/// nor of the track CSV go to `unmatched`. Bad input for two columns that give one parameter (GivenParameters), a cell that is no
/// finite number, a quaternion that is not nearly of unit length, or a place out of range.
std::vector<PosedParameters> read_posed_parameters(const CsvTable& table, const Model& model,
                                                   const PosedParameters& neutral,
                                                   std::vector<std::string>* unmatched,
                                                   EmptyCell empty = EmptyCell::row_before);

/// Writes one line that so many rows of a track are lost; nothing if none is. \param source  the file that has them.
void list_lost(std::size_t lost, std::size_t rows, const std::string& source, std::ostream& err);

/// Clamps all parameters to the model's limits. \return the names of those that were outside.
std::vector<std::string> clamp_to_limits(const Model& model, std::vector<PosedParameters>& rows);

}  // namespace pliant::host
