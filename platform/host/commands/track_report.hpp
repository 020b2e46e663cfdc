#pragma once
/// \file track_report.hpp
/// `pliant track --report`: one run as a page that needs nothing else.
#include <string>
#include <vector>

#include "host/render/sheet.hpp"
#include "host/io/track_table.hpp"

namespace pliant::host {

/// What a report tells beside its frames.
struct ReportFacts {
  std::string title;                             ///< what was tracked
  std::string summary;                           ///< the line of key=value that the command prints
  int width = 0, height = 0;                     ///< of the frames, px
  std::size_t arena_bytes = 0, table_bytes = 0;  ///< memory at run time; the model's table in flash
  std::size_t vertices = 0;                      ///< of the mesh in the last frame
};

class TrackReport {
 public:
  explicit TrackReport(const Model& model) : model_(model) {}

  /// Takes a frame's row; `overlay` is the frame with what was found drawn on it. `milliseconds` of frame 0 is not
  /// counted.
  void add(const TrackRow& row, const Image& overlay, double milliseconds);

  /// The page: nine frames, state, pose, expressions, observations, times, memory.
  std::string page(const ReportFacts& facts) const;

 private:
  std::string pictures() const;
  std::string tiles(const ReportFacts& facts) const;
  std::string pose_charts() const;
  std::string expression_charts() const;
  std::string observation_charts() const;
  std::string memory_table(const ReportFacts& facts) const;
  template <class Value>
  std::vector<std::optional<double>> over_time(const Value& value) const;

  Model model_;
  std::vector<TrackRow> rows_;
  std::vector<double> milliseconds_;
  ContactSheet sheet_;
};

}  // namespace pliant::host
