#pragma once
/// \file svg_chart.hpp
/// Charts over time as SVG elements. The page (pages/report.html) has their styles.
#include <optional>
#include <string>
#include <vector>

namespace pliant::host {

/// One line of a chart: one value a frame; a missing value is a gap.
struct Series {
  std::string name;
  std::vector<std::optional<double>> values;
};

struct ChartStyle {
  int width = 1000, height = 180;
  std::string unit;                         ///< printed at the highest tick
  bool has_axes = true;                     ///< without axes: only the line, for small multiples
  std::optional<double> at_least, at_most;  ///< values that the axis shows in any case
};

/// Lines over a common time axis from `first_s` to `last_s`, with a legend. With more frames than columns of pixels, a line
/// shows the lowest and highest value of each column.
std::string line_chart(const std::vector<Series>& series, double first_s, double last_s,
                       const ChartStyle& style);

/// A band with one coloured section for each run of equal classes. Class k has the style "state-NAMES[k]". A column of pixels
/// with several classes shows the largest.
std::string ribbon(const std::vector<int>& classes, const std::vector<std::string>& names,
                   const ChartStyle& style);

/// A histogram of equally wide bins up to the 99 % quantile; the last bin holds all larger values. Lines mark `marks`.
std::string histogram(const std::vector<double>& values,
                      const std::vector<std::pair<std::string, double>>& marks, const ChartStyle& style);

}  // namespace pliant::host
