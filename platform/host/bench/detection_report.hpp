#pragma once
/// \file detection_report.hpp
/// What the parts of `pliant bench detection` print.
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/bench/rows.hpp"
#include "host/io/files.hpp"
#include "host/io/image.hpp"

namespace pliant::host {

/// A value that there is not: NaN.
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// Rows, and a line a case in the file of details.
class DetectionReport {
 public:
  /// \param details  file of the cases, or none.
  DetectionReport(std::ostream& out, const std::optional<std::string>& details);

  /// \param frame  in which it was found, -1: never. \param error, estimate, lost  NaN: none. `lost` is the frame in which a track
  ///               was lost, or how many frames had none.
  void add(const char* what, const std::string& name, int frame, double error, double estimate,
           double lost = kUnknown);
  void commit();

  const BenchRows rows;

 private:
  void add_line(const std::string& line);
  std::unique_ptr<OutputFile> details_;
};

/// Landmark errors of many cases.
struct DetectionErrors {
  std::size_t cases = 0;
  std::vector<double> errors;  ///< of those that were found
  std::vector<double> frames;  ///< in which they were found

  void add(bool is_found, double error, std::size_t frame);
  void print(const BenchRows& rows, const std::string& name) const;
};

}  // namespace pliant::host
