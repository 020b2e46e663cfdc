#include "host/bench/detection_report.hpp"

#include <algorithm>
#include <cmath>

#include "host/bench/detection_run.hpp"
#include "host/io/csv.hpp"
#include "host/io/numbers.hpp"

namespace pliant::host {

namespace {

std::string text_of(double value) {
  return std::isnan(value) ? "" : decimal_text(value);
}

}  // namespace

DetectionReport::DetectionReport(std::ostream& out, const std::optional<std::string>& details)
    : rows(out, "detection") {
  if (details) details_ = std::make_unique<OutputFile>(*details);
  add_line("case,name,frame,error,estimate,lost");
}

void DetectionReport::add(const char* what, const std::string& name, int frame, double error, double estimate,
                          double lost) {
  add_line(std::string(what) + "," + csv_cell(name) + "," + std::to_string(frame) + "," + text_of(error) +
           "," + text_of(estimate) + "," + text_of(lost));
}

void DetectionReport::commit() {
  if (details_) details_->commit();
}

void DetectionReport::add_line(const std::string& line) {
  if (details_) details_->write(line + "\n");
}

void DetectionErrors::add(bool is_found, double error, std::size_t frame) {
  ++cases;
  if (!is_found) return;
  errors.push_back(std::isnan(error) ? 1 : error);
  frames.push_back(static_cast<double>(frame));
}

void DetectionErrors::print(const BenchRows& rows, const std::string& name) const {
  const auto right = std::count_if(errors.begin(), errors.end(), [](double e) { return e < kRightError; });
  const double percent = 100 / static_cast<double>(std::max<std::size_t>(cases, 1));
  rows(name, "cases", static_cast<double>(cases));
  rows(name, "found_percent", percent * static_cast<double>(errors.size()));
  rows(name, "right_percent", percent * static_cast<double>(right));
  if (errors.empty()) return;
  rows(name, "median_nme_percent", 100 * quantile(errors, 0.5));
  rows(name, "nme_percent_at_90", 100 * quantile(errors, 0.9));
  rows(name, "median_frame", quantile(frames, 0.5));
}

}  // namespace pliant::host
