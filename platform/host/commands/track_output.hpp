#pragma once
/// \file track_output.hpp
/// What one run of `pliant track` writes, and counts.
#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "host/commands/args.hpp"
#include "host/io/files.hpp"
#include "host/render/sheet.hpp"
#include "host/commands/track_report.hpp"
#include "host/io/track_table.hpp"
#include "host/io/truth.hpp"
#include "host/io/y4m_output.hpp"
#include "pliant/fit.hpp"
#include "pliant/tracker.hpp"

namespace pliant::host {

/// Whether landmarks are asked for.
bool has_landmarks(const Args& args);

class TrackOutput {
 public:
  /// Opens what --out, --overlay, --sheet, --report and --truth name, and writes the table's header.
  TrackOutput(const Args& args, const Model& model, const std::vector<std::string>& marker_names,
              FrameRate rate);

  /// Of a start in which landmarks were given: from now on they are where `personal` has them.
  void place_landmarks(Estimator& estimator, const std::vector<Correspondence>& personal);

  /// Takes on the tracker's present result for the frame of that number and time (since frame 0). `milliseconds` is what
  /// it took; frame 0 is not counted.
  void add(std::size_t number, double time_s, const FrameView& frame, Tracker& tracker, double milliseconds);

  /// A frame without a model, as before a start is found: state lost.
  void add_lost(std::size_t number, double time_s, const FrameView& frame);

  /// Gives all files their names. \param arena_bytes, focal_px  for the summary.
  /// \returns the summary, one line of key=value: frames, tracked (in state `tracking`), rms_px (root mean square over the
  /// frames), median_ms, arena_bytes, f_px, peak_kib (memory of the process); with a truth landmark_px (mean),
  /// rotation_deg (median) and compared (frames).
  std::string commit(std::size_t arena_bytes, float focal_px);

 private:
  using Points = std::vector<std::optional<Vec2>>;
  std::string summary(std::size_t arena_bytes, float focal_px) const;
  Points project_landmarks(Estimator& estimator) const;
  Points project_markers(Tracker& tracker) const;
  void write(const TrackRow& row, const FrameView& frame);
  void draw(const TrackRow& row, const FrameView& frame, Estimator* estimator, const Points& landmarks,
            const Points& markers, double milliseconds);

  Model model_;
  OutputFile table_;
  bool with_landmarks_;
  std::vector<Vec3> landmark_offsets_;
  std::size_t marker_count_;
  FrameRate rate_;
  std::unique_ptr<Y4mOutput> overlay_;
  std::unique_ptr<OutputFile> sheet_file_;
  std::unique_ptr<TruthComparison> truth_;
  ContactSheet sheet_;
  std::unique_ptr<OutputFile> report_file_;
  std::unique_ptr<TrackReport> report_;
  ReportFacts facts_;
  std::vector<double> milliseconds_;
  std::size_t frames_ = 0, tracked_ = 0, known_ = 0;
  double squared_sum_ = 0;
};

}  // namespace pliant::host
