#pragma once
/// \file retarget.hpp
/// Transfers a track's expressions and head motion to any model by name (the paper, section 7).
#include <string>
#include <vector>

#include "host/io/csv.hpp"
#include "host/io/fit_file.hpp"
#include "host/io/track_table.hpp"

namespace pliant::host {

struct RetargetFrame {
  double time_s = 0;
  PosedParameters state;  ///< all parameters of the target model
};

/// The result, and how the columns of the track were used.
struct Retargeted {
  std::vector<RetargetFrame> frames;  ///< in ascending time
  std::vector<std::uint16_t>
      driven;  ///< expression parameters of the target model that a column drives, ascending
  std::vector<std::string> unmatched;  ///< columns that drive nothing
  std::vector<std::string>
      unscaled;  ///< columns that the source model has no parameter for: taken as they are
  std::vector<std::string> limited;  ///< driven parameters whose values exceed the limits and are clamped
  bool has_pose = false;             ///< the track has columns of the pose; the others are frontal, at 1 m
  bool has_identity = false;  ///< the track has columns of identity
  std::size_t lost = 0;       ///< frames without pose and expression; they repeat the frame before
};

struct RetargetSetup {
  const Model* source = nullptr;          ///< the model that was tracked, if its ranges differ; else null
  const NamedValues* identity = nullptr;  ///< the person; null: the track's identity, or the mean
  std::string identity_path;
  double rate = 30;  ///< frames per second of a table without time_s
};

/// Reads any table with the columns of a track. A column drives the parameter of its name. One name for a pair (`browInnerUp`)
/// drives both sides. The two sides of a pair drive a single parameter of the target model by their mean. With a source model, a
/// value keeps its fraction of the range. Frames in state lost and empty cells repeat the value before. Lost frames at the start
/// repeat the first tracked one; cells that are empty there are neutral. Bad input: no row with values, times that do not ascend,
/// and as read_posed_parameters.
Retargeted retarget(const CsvTable& table, const Model& model, const RetargetSetup& setup);

}  // namespace pliant::host
