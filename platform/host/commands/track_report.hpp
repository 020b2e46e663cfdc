#pragma once
/// \file track_report.hpp
/// `pliant track --report`: one run as a self-contained page.
#include <optional>
#include <string>
#include <vector>

#include "host/io/track_table.hpp"
#include "host/render/sheet.hpp"

namespace pliant::host {

/// Contents of a report besides its frames.
struct ReportFacts {
  std::string title;                             ///< what was tracked
  std::string summary;                           ///< the line of key=value that the command prints
  int width = 0, height = 0;                     ///< of the frames, px
  std::size_t arena_bytes = 0, table_bytes = 0;  ///< memory at run time; size of the model table
  std::size_t vertices = 0;                      ///< of the mesh in the last frame
  double rms_px = 0;                             ///< root mean square over the frames that are not lost
};

class TrackReport {
 public:
  explicit TrackReport(const Model& model) : model_(model) {}

  /// Adds a frame: its row and its time. The time of frame 0 is not counted.
  void add(const TrackRow& row, std::optional<double> milliseconds);

  /// The page: nine frames, state, pose, expressions, observations, times, memory.
  std::string page(const ReportFacts& facts, const ContactSheet& sheet) const;

 private:
  std::string pictures(const ContactSheet& sheet) const;
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
};

}  // namespace pliant::host
