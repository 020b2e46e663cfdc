#pragma once
/// \file retarget.hpp
/// A track's expressions and head motion, by name, on any model (the paper, section 7).
#include <string>
#include <vector>

#include "host/io/csv.hpp"
#include "host/io/fit_file.hpp"
#include "host/io/track_table.hpp"

namespace pliant::host {

struct RetargetFrame {
  double time_s = 0;
  PosedParameters state;  ///< all parameters of the model that is driven
};

/// What became of the columns of a track.
struct Retargeted {
  std::vector<RetargetFrame> frames;   ///< times grow
  std::vector<std::uint16_t> driven;   ///< expression parameters of the model that a column drives, ascending
  std::vector<std::string> unmatched;  ///< columns that drive nothing
  std::vector<std::string>
      limited;  ///< driven parameters that the track takes beyond their limits, where they stay
  bool has_pose = false;
  bool has_identity = false;  ///< columns that tell who it is
  std::size_t lost = 0;  ///< frames without a pose or expression of their own: they hold the frame before
};

struct RetargetSetup {
  const Model* source = nullptr;          ///< the model that was tracked, where its ranges are others
  const NamedValues* identity = nullptr;  ///< who it is; null: whom the track says, else the mean
  std::string identity_path;
  double rate = 30;  ///< frames a second of a table without time_s
};

/// Reads any table with the columns of a track. A column drives the parameter of its name; one name for a pair
/// (`browInnerUp`) drives both sides, and a pair drives one parameter of a model that has one, by its mean. With a
/// source model, values keep their share of the range. Frames in state lost, and empty cells, hold the value before,
/// those ahead of the first known one its value. Bad input: no row with values, a time that does not grow, what
/// `read_posed_parameters` calls bad.
Retargeted retarget(const CsvTable& table, const Model& model, const RetargetSetup& setup);

}  // namespace pliant::host
