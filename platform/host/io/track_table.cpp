#include "host/io/track_table.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "host/io/csv.hpp"
#include "host/io/failure.hpp"
#include "host/io/files.hpp"
#include "host/io/fit_file.hpp"
#include "host/io/numbers.hpp"
#include "pliant/camera.hpp"

namespace pliant::host {

namespace {

constexpr const char* kFirstColumns[] = {"frame",  "time_s",   "state",          "tracked",   "inliers",
                                         "rms_px", "vertices", "landmark_error", "gaze_left", "gaze_up"};
constexpr const char* kPoseColumns[] = {"qw", "qx", "qy", "qz", "tx", "ty", "tz"};

float* pose_member(Pose& pose, std::size_t column) {
  float* const members[] = {&pose.q.w, &pose.q.x, &pose.q.y, &pose.q.z, &pose.t.x, &pose.t.y, &pose.t.z};
  return members[column];
}

std::string text_of(float x) {
  return number_text(static_cast<double>(is_finite(x) ? x : 0));
}

std::string text_of_px(float x) {
  return decimal_text(static_cast<double>(x));
}

template <std::size_t kCount>
bool is_in(const std::string& name, const char* const (&names)[kCount]) {
  return std::find(std::begin(names), std::end(names), name) != std::end(names);
}

bool is_of_point(const std::string& name) {
  return name.rfind("x_", 0) == 0 || name.rfind("y_", 0) == 0;
}

/// The column of a table and what it sets.
struct Target {
  std::size_t column;
  std::vector<std::uint16_t> parameters;  // if empty, a member of the pose
  std::size_t pose_index = 0;
};

std::vector<Target> targets(const CsvTable& table, const Model& model, std::vector<std::string>* unmatched) {
  std::vector<Target> out;
  GivenParameters given(table.source());
  for (std::size_t c = 0; c < table.columns().size(); ++c) {
    const std::string& name = table.columns()[c];
    const auto pose = std::find(std::begin(kPoseColumns), std::end(kPoseColumns), name);
    const auto parameters = parameters_named(model, name);
    given.add(name, parameters);
    if (pose != std::end(kPoseColumns))
      out.push_back({c, {}, static_cast<std::size_t>(pose - std::begin(kPoseColumns))});
    else if (!parameters.empty())
      out.push_back({c, parameters});
    else if (!is_in(name, kFirstColumns) && !is_of_point(name))
      unmatched->push_back(name);
  }
  return out;
}

}  // namespace

GazeAngles gaze_angles(Vec3 gaze) {
  const double x = static_cast<double>(gaze.x), y = static_cast<double>(gaze.y),
               z = static_cast<double>(gaze.z);
  return {std::atan2(x, z), std::atan2(y, std::hypot(x, z))};
}

const char* state_text(TrackState state) {
  switch (state) {
    case TrackState::tracking:
      return "tracking";
    case TrackState::degraded:
      return "degraded";
    case TrackState::lost:
      return "lost";
  }
  return "lost";
}

bool is_track_column(const std::string& name) {
  return is_in(name, kFirstColumns) || is_in(name, kPoseColumns) || is_of_point(name);
}

std::string track_header(const Model& model, const std::vector<std::string>& point_names) {
  std::vector<std::string> names;
  for (const Parameter& p : model.parameters()) names.push_back(p.name);
  return track_header(names, point_names);
}

std::string track_header(const std::vector<std::string>& value_names,
                         const std::vector<std::string>& point_names) {
  std::string line;
  for (const char* name : kFirstColumns) line += (line.empty() ? "" : ",") + std::string(name);
  for (const char* name : kPoseColumns) line += "," + std::string(name);
  for (const std::string& name : value_names) line += "," + csv_cell(name);
  for (const std::string& name : point_names)
    line += "," + csv_cell("x_" + name) + "," + csv_cell("y_" + name);
  return line + "\n";
}

std::string track_line(const TrackRow& row) {
  std::string line = std::to_string(row.frame) + "," + number_text(row.time_s) + "," + state_text(row.state) +
                     "," + std::to_string(row.tracked) + "," + std::to_string(row.inliers) + "," +
                     text_of(row.rms_px) + "," + std::to_string(row.vertices);
  const bool is_known = row.state != TrackState::lost;
  line +=
      "," + (is_known && row.landmark_error > 0 ? decimal_text(static_cast<double>(row.landmark_error)) : "");
  const bool has_gaze = is_known && dot(row.gaze, row.gaze) > 0;
  const GazeAngles gaze = gaze_angles(row.gaze);
  line += has_gaze ? "," + decimal_text(gaze.left) + "," + decimal_text(gaze.up) : ",,";
  Pose pose = row.pose;
  for (std::size_t k = 0; k < std::size(kPoseColumns); ++k)
    line += "," + (is_known ? text_of(*pose_member(pose, k)) : "");
  for (const float value : row.q) line += "," + (is_known ? text_of(value) : "");
  for (const auto& x : row.points) {
    const bool is_seen = is_known && x && is_finite(*x);
    line += is_seen ? "," + text_of_px(x->x) + "," + text_of_px(x->y) : ",,";
  }
  return line + "\n";
}

std::vector<PosedParameters> read_posed_parameters(const CsvTable& table, const Model& model,
                                                   const PosedParameters& neutral,
                                                   std::vector<std::string>* unmatched, EmptyCell empty) {
  const auto columns = targets(table, model, unmatched);
  std::vector<PosedParameters> rows;
  PosedParameters now = neutral;
  for (std::size_t r = 0; r < table.row_count(); ++r) {
    if (empty == EmptyCell::neutral) now = neutral;
    for (const Target& target : columns) {
      if (table.cell(r, target.column).empty()) continue;
      const float value = table.number(r, target.column);
      if (target.parameters.empty()) *pose_member(now.pose, target.pose_index) = value;
      for (const std::uint16_t k : target.parameters) now.q[k] = value;
    }
    if (!is_nearly_unit(now.pose.q)) fail_input(table.where(r), "the quaternion is not of unit length");
    if (!(now.pose.t.z * kMaxRho > 0.999f && now.pose.t.z * kMinRho < 1.001f))
      fail_input(table.where(r), "column 'tz': not between 50 mm and 100 m in front of the camera");
    now.pose.q = unit_of(now.pose.q);
    rows.push_back(now);
  }
  return rows;
}

void list_lost(std::size_t lost, std::size_t rows, const std::string& source, std::ostream& err) {
  if (lost == 0) return;
  err << source << ": " << lost << " of " << rows
      << " frames are lost; they repeat the pose and expression before\n";
}

std::vector<std::string> clamp_to_limits(const Model& model, std::vector<PosedParameters>& rows) {
  std::vector<std::string> names;
  for (std::size_t k = 0; k < model.parameters().count; ++k) {
    const Parameter& p = model.parameters()[k];
    bool is_outside = false;
    for (PosedParameters& row : rows) {
      is_outside = is_outside || row.q[k] < p.minimum || row.q[k] > p.maximum;
      row.q[k] = clamp(row.q[k], p.minimum, p.maximum);
    }
    if (is_outside) names.push_back(p.name);
  }
  return names;
}

}  // namespace pliant::host
