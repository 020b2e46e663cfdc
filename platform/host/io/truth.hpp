#pragma once
/// \file truth.hpp
/// Compares a track with the truth that `pliant render` wrote.
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host/io/image.hpp"
#include "pliant/geometry.hpp"
#include "pliant/model.hpp"

namespace pliant::host {

class TruthComparison {
 public:
  /// Reads a track CSV. Bad input unless it has the columns frame, qw, qx, qy, qz and x_NAME, y_NAME of at least one of
  /// the model's landmarks, if it has some, and its quaternions are nearly of unit length.
  TruthComparison(const std::string& path, const Model& model);

  /// Compares one frame that was not lost; `landmarks` in the model's order.
  void add(std::size_t frame, const Pose& pose, const std::vector<std::optional<Vec2>>& landmarks,
           ImageSize size);

  /// Over all landmarks of all frames, px.
  double mean_landmark_px() const;
  /// Median over the frames of the angle between the two rotations, degrees.
  double median_rotation_deg() const;
  std::size_t frame_count() const { return rotation_deg_.size(); }
  /// Whether most landmarks that were compared truly lie outside their frames: the truth of larger frames does.
  bool is_mostly_outside() const { return 2 * outside_count_ > distance_count_; }

 private:
  struct Row {
    Quat q;
    std::vector<std::optional<Vec2>> landmarks;
  };
  std::map<std::size_t, Row> rows_;
  std::vector<double> rotation_deg_;
  double distance_sum_ = 0;
  std::size_t distance_count_ = 0, outside_count_ = 0;
};

}  // namespace pliant::host
