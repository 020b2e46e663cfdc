#include "host/render/svg_chart.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "host/io/append.hpp"
#include "host/io/page.hpp"

namespace pliant::host {

namespace {

/// Margins for tick labels, px.
constexpr int kLeft = 56, kBottom = 18, kTop = 8, kRight = 8;

/// The part of a chart that lines are drawn in.
struct Area {
  double left, top, right, bottom;
  double low = 0, high = 1;  // values at bottom and top
  double x(double fraction) const { return left + fraction * (right - left); }
  double y(double value) const { return bottom - (value - low) / (high - low) * (bottom - top); }
};

Area area_of(const ChartStyle& style) {
  if (!style.has_axes) return {1, 2, style.width - 1.0, style.height - 2.0};
  return {kLeft, kTop, static_cast<double>(style.width - kRight),
          static_cast<double>(style.height - kBottom)};
}

std::string open_svg(const ChartStyle& style) {
  std::string out;
  append(out, "<svg viewBox=\"0 0 %d %d\" class=\"%s\">", style.width, style.height,
         style.has_axes ? "chart" : "spark");
  return out;
}

/// A step of 1, 2 or 5 times a power of ten that divides `range` into about `count` parts.
double nice_step(double range, int count) {
  const double rough = range / count, power = std::pow(10.0, std::floor(std::log10(rough)));
  const double fraction = rough / power;
  return power * (fraction < 1.5 ? 1 : fraction < 3.5 ? 2 : fraction < 7.5 ? 5 : 10);
}

std::string tick_text(double value, double step) {
  char text[40];
  const int digits = std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 6);
  std::snprintf(text, sizeof text, "%.*f", digits, std::fabs(value) < 1e-9 * step ? 0.0 : value);
  return text;
}

void add_value_axis(std::string& out, const Area& area, const std::string& unit) {
  const double step = nice_step(area.high - area.low, 4);
  for (double value = std::ceil(area.low / step - 1e-9) * step; value <= area.high + 1e-9 * step;
       value += step) {
    append(out, "<line class=\"grid\" x1=\"%.1f\" x2=\"%.1f\" y1=\"%.1f\" y2=\"%.1f\"/>", area.left,
           area.right, area.y(value), area.y(value));
    append(out, "<text class=\"tick\" x=\"%.1f\" y=\"%.1f\" text-anchor=\"end\">", area.left - 5,
           area.y(value) + 4);
    out += tick_text(value, step) +
           (value + step > area.high + 1e-9 * step && !unit.empty() ? " " + html_text(unit) : "") + "</text>";
  }
}

void add_base_axis(std::string& out, const Area& area, double first, double last, const char* unit) {
  if (!(last > first)) return;
  const double step = nice_step(last - first, 8);
  for (double value = std::ceil(first / step - 1e-9) * step; value <= last + 1e-9 * step; value += step) {
    const double x = area.x((value - first) / (last - first));
    append(out, "<line class=\"grid\" x1=\"%.1f\" x2=\"%.1f\" y1=\"%.1f\" y2=\"%.1f\"/>", x, x, area.bottom,
           area.bottom + 3);
    append(out, "<text class=\"tick\" x=\"%.1f\" y=\"%.1f\" text-anchor=\"middle\">", x, area.bottom + 14);
    out += tick_text(value, step) + (value + step > last + 1e-9 * step ? std::string(" ") + unit : "") +
           "</text>";
  }
}

void set_range(Area& area, const std::vector<Series>& series, const ChartStyle& style) {
  double low = style.at_least.value_or(1e300), high = style.at_most.value_or(-1e300);
  for (const Series& s : series)
    for (const auto& value : s.values)
      if (value) low = std::min(low, *value), high = std::max(high, *value);
  if (low > high) low = 0, high = 1;
  const double margin = high > low ? 0.04 * (high - low) : std::max(0.5, 0.05 * std::fabs(low));
  area.low = style.at_least && low >= *style.at_least ? low : low - margin;
  area.high = style.at_most && high <= *style.at_most ? high : high + margin;
}

/// One or two points (lowest, highest) for each column of pixels; a column with a gap is a gap.
std::string path_of(const Series& s, const Area& area) {
  const std::size_t count = s.values.size();
  const auto columns = std::min(count, static_cast<std::size_t>(area.right - area.left));
  std::string path;
  bool is_open = false;
  for (std::size_t c = 0; c < columns; ++c) {
    const std::size_t first = c * count / columns, end = std::max(first + 1, (c + 1) * count / columns);
    double low = 1e300, high = -1e300;
    bool has_gap = false;
    for (std::size_t k = first; k < end; ++k) {
      has_gap = has_gap || !s.values[k];
      if (s.values[k]) low = std::min(low, *s.values[k]), high = std::max(high, *s.values[k]);
    }
    if (has_gap) {
      is_open = false;
      continue;
    }
    const double x = area.x(count > 1 ? static_cast<double>(first) / static_cast<double>(count - 1) : 0.5);
    append(path, "%s%.1f %.1f", is_open ? "L" : "M", x, area.y(low));
    if (high > low) append(path, "L%.1f %.1f", x, area.y(high));
    if (!is_open && high <= low) path += "h.1";  // a single frame is a dot
    is_open = true;
  }
  return path;
}

}  // namespace

std::string line_chart(const std::vector<Series>& series, double first_s, double last_s,
                       const ChartStyle& style) {
  Area area = area_of(style);
  set_range(area, series, style);
  std::string out = open_svg(style);
  if (style.has_axes) {
    add_value_axis(out, area, style.unit);
    add_base_axis(out, area, first_s, last_s, "s");
  }
  for (std::size_t k = 0; k < series.size(); ++k)
    out += "<path class=\"line line-" + std::to_string(k) + "\" d=\"" + path_of(series[k], area) +
           "\"><title>" + html_text(series[k].name) + "</title></path>";
  out += "</svg>";
  if (series.size() < 2) return out;
  std::string legend = "<div class=\"legend\">";
  for (std::size_t k = 0; k < series.size(); ++k)
    legend += "<span class=\"key key-" + std::to_string(k) + "\">" + html_text(series[k].name) + "</span>";
  return legend + "</div>" + out;
}

std::string ribbon(const std::vector<int>& classes, const std::vector<std::string>& names,
                   const ChartStyle& style) {
  const Area area = area_of(style);
  const std::size_t count = classes.size();
  const auto columns = std::min(count, static_cast<std::size_t>(area.right - area.left));
  std::vector<int> shown;
  for (std::size_t c = 0; c < columns; ++c)
    shown.push_back(
        *std::max_element(classes.begin() + static_cast<std::ptrdiff_t>(c * count / columns),
                          classes.begin() + static_cast<std::ptrdiff_t>((c + 1) * count / columns)));
  std::string out = open_svg(style);
  for (std::size_t c = 0; c < columns;) {
    std::size_t end = c;
    while (end < columns && shown[end] == shown[c]) ++end;
    const double x0 = area.x(static_cast<double>(c) / static_cast<double>(columns)),
                 x1 = area.x(static_cast<double>(end) / static_cast<double>(columns));
    const std::string& name = names[static_cast<std::size_t>(shown[c])];
    append(out, "<rect x=\"%.2f\" y=\"0\" width=\"%.2f\" height=\"%d\" ", x0, x1 - x0, style.height);
    append(out, "class=\"state-%s\"><title>%s, from frame %zu</title></rect>", name.c_str(), name.c_str(),
           c * count / columns);
    c = end;
  }
  return out + "</svg>";
}

std::string histogram(const std::vector<double>& values,
                      const std::vector<std::pair<std::string, double>>& marks, const ChartStyle& style) {
  std::string out = open_svg(style);
  if (values.empty()) return out + "</svg>";
  std::vector<double> sorted = values;
  std::sort(sorted.begin(), sorted.end());
  const double last = std::max(1e-6, sorted[(sorted.size() - 1) * 99 / 100] * 1.05);
  constexpr std::size_t kBins = 60;
  std::vector<std::size_t> bins(kBins + 1, 0);
  for (const double value : values)
    ++bins[std::min(kBins, static_cast<std::size_t>(std::max(0.0, value) / last * kBins))];
  Area area = area_of(style);
  area.high = 1.05 * static_cast<double>(*std::max_element(bins.begin(), bins.end()));
  add_value_axis(out, area, "frames");
  const double end = last * (kBins + 1) / kBins;
  add_base_axis(out, area, 0, end, style.unit.c_str());
  for (std::size_t k = 0; k <= kBins; ++k) {
    const double x0 = area.x(static_cast<double>(k) / (kBins + 1)),
                 x1 = area.x(static_cast<double>(k + 1) / (kBins + 1));
    const double top = area.y(static_cast<double>(bins[k]));
    append(out, "<rect class=\"bar\" x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\">", x0 + 0.5, top,
           x1 - x0 - 1, area.bottom - top);
    append(out, "<title>%zu frames %s %.3f</title></rect>", bins[k], k < kBins ? "from" : "above",
           last * static_cast<double>(k) / kBins);
  }
  double label_y = area.top + 10;
  for (const auto& [name, value] : marks) {
    if (value > end) continue;
    const double x = area.x(value / end);
    append(out, "<line class=\"mark\" x1=\"%.1f\" x2=\"%.1f\" y1=\"%.1f\" y2=\"%.1f\"/>", x, x, area.top,
           area.bottom);
    append(out, "<text class=\"tick\" x=\"%.1f\" y=\"%.1f\">%s %.2f</text>", x + 4, label_y, name.c_str(),
           value);
    label_y += 14;
  }
  return out + "</svg>";
}

}  // namespace pliant::host
