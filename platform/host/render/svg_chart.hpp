#pragma once
/// \file svg_chart.hpp
/// Charts over time as SVG elements for a page that has their styles (pages/report.html).
#include <optional>
#include <string>
#include <vector>

namespace pliant::host {

/// One line of a chart: a value a frame, nothing where there was none. Gaps stay gaps.
struct Series {
  std::string name;
  std::vector<std::optional<double>> values;
};

struct ChartStyle {
  int width = 1000, height = 180;
  std::string unit;                         ///< behind the highest tick
  bool has_axes = true;                     ///< else a bare line with its range, for small multiples
  std::optional<double> at_least, at_most;  ///< that the value axis shows at any rate
};

/// Lines over the same time axis, `first_s` at the left, `last_s` at the right, told apart by a legend. Where there are
/// more frames than columns, a line shows the lowest and highest value of each column.
std::string line_chart(const std::vector<Series>& series, double first_s, double last_s,
                       const ChartStyle& style);

/// A band of coloured stretches, one a run of equal classes: class k has the style "state-NAMES[k]". A column with several
/// shows the largest.
std::string ribbon(const std::vector<int>& classes, const std::vector<std::string>& names,
                   const ChartStyle& style);

/// Bars of equally wide bins, up to the 99 % quantile; the last one holds all above. Lines at the values of `marks`.
std::string histogram(const std::vector<double>& values,
                      const std::vector<std::pair<std::string, double>>& marks, const ChartStyle& style);

}  // namespace pliant::host
