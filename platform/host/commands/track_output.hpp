#pragma once
/// \file track_output.hpp
/// The files that one run of `pliant track` writes, and its summary.
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/commands/args.hpp"
#include "host/commands/frame_stream.hpp"
#include "host/commands/live_window.hpp"
#include "host/commands/reduced_tracker.hpp"
#include "host/commands/track_picture.hpp"
#include "host/commands/track_report.hpp"
#include "host/io/arkit.hpp"
#include "host/io/files.hpp"
#include "host/io/track_table.hpp"
#include "host/io/truth.hpp"
#include "host/io/y4m_writer.hpp"
#include "host/render/sheet.hpp"

namespace pliant::host {

/// Whether --landmarks or --model-landmarks is given.
bool has_landmarks(const Args& args);

/// The track table, and the overlay, sheet, report and comparison with a truth where the command line names them.
class TrackOutput {
 public:
  /// Opens the files that --out, --overlay, --sheet, --report and --truth name and the window of --show, and writes the header of
  /// the table.
  /// \param expected  number of frames; 0: unknown.
  /// Bad input: --arkit, and the model has no expression that ARKit has.
  TrackOutput(const Args& args, const Model& model, const std::vector<std::string>& marker_names,
              FrameRate rate, std::size_t expected);

  /// Adds the tracker's present result.
  /// \param frames        where the frame comes from, which is its last.
  /// \param milliseconds  that the update took; not counted for frame 0.
  void add(const FrameStream& frames, const FrameView& frame, ReducedTracker& tracker, double milliseconds);

  /// Whether another frame is wanted: the window of --show was not closed, and has not failed.
  bool goes_on() const { return window_ == nullptr || window_->is_open(); }
  /// Whether no frame so far has a pose.
  bool has_no_pose() const { return known_ == 0; }
  /// Whether the truth is to be doubted: most of its landmarks lie outside the frames.
  bool has_doubtful_truth() const { return truth_ && truth_->is_mostly_outside(); }
  /// Why an overlay or a window failed; empty if none did. The track is to be kept.
  const std::string& failure() const { return failure_; }

  /// Adds a frame that was searched for a face in vain: state lost, no pose, no parameters, no points.
  void add_lost(const FrameStream& frames, const FrameView& frame);

  /// Completes all files: until then they have temporary names.
  /// \param arena_bytes, focal_px  for the summary.
  /// \return the summary, one line of key=value: frames, tracked (in state `tracking`), rms_px (root mean square over
  /// the frames), median_ms, arena_bytes, f_px, peak_kib (memory of the process); with a truth landmark_px (mean),
  /// rotation_deg (median) and compared (frames).
  std::string commit(std::size_t arena_bytes, float focal_px);

 private:
  double rms_px() const;
  std::string summary(std::size_t arena_bytes, float focal_px) const;
  void write(const TrackRow& row, const FrameView& frame);
  /// Draws the frame where it is wanted. \param marks  is called only then.
  void show(const TrackRow& row, const FrameStream& frames, const FrameView& frame,
            const std::function<TrackMarks()>& marks, std::optional<double> milliseconds);
  void show(const Image& image);

  Model model_;
  OutputFile table_;
  std::unique_ptr<ArkitExpression> arkit_;  // null: columns are the model's parameters
  bool with_landmarks_;
  std::size_t marker_count_;
  std::unique_ptr<Y4mWriter> overlay_;
  std::unique_ptr<LiveWindow> window_;
  std::string failure_;
  std::unique_ptr<OutputFile> sheet_file_;
  std::unique_ptr<TruthComparison> truth_;
  ContactSheet sheet_;  // of --sheet and --report
  std::unique_ptr<OutputFile> report_file_;
  std::unique_ptr<TrackReport> report_;
  ReportFacts facts_;
  std::vector<double> milliseconds_;
  std::size_t frames_ = 0, tracked_ = 0, known_ = 0;
  double squared_sum_ = 0;
};

}  // namespace pliant::host
