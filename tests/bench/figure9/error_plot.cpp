#include "error_plot.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace pliant::figure9 {

namespace {

constexpr double kWidth = 960, kHeight = 420, kLeft = 60, kRight = 170, kTop = 40, kBottom = 50;
const char* const kColours[] = {"#888888", "#d1495b", "#00798c", "#edae49", "#6a4c93", "#2e8b57"};

std::vector<double> smoothed(const std::vector<double>& values, std::size_t window) {
  std::vector<double> out;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t from = i > window / 2 ? i - window / 2 : 0,
                      to = std::min(values.size(), i + window / 2 + 1);
    double sum = 0;
    for (std::size_t k = from; k < to; ++k) sum += values[k];
    out.push_back(sum / static_cast<double>(to - from));
  }
  return out;
}

struct Axes {
  double frames, seconds, top;  // top: px of error at the upper end
  double x(double frame) const { return kLeft + (kWidth - kLeft - kRight) * frame / frames; }
  double y(double px) const {
    return kHeight - kBottom - (kHeight - kTop - kBottom) * std::min(px, top) / top;
  }
};

void draw_axes(std::ostream& svg, const Axes& axes, const std::string& title) {
  svg << "<text x='" << kLeft << "' y='24' font-size='16'>" << title << "</text>\n";
  const double step = axes.top > 4 ? 1 : axes.top > 1.6 ? 0.5 : 0.2;
  for (double px = 0; px <= axes.top + 1e-9; px += step)
    svg << "<path d='M" << kLeft << " " << axes.y(px) << "H" << kWidth - kRight
        << "' stroke='#ddd'/><text x='" << kLeft - 8 << "' y='" << axes.y(px) + 4 << "' text-anchor='end'>"
        << px << "</text>\n";
  for (double s = 0; s <= axes.seconds; s += 10)
    svg << "<text x='" << axes.x(axes.frames * s / axes.seconds) << "' y='" << kHeight - kBottom + 18
        << "' text-anchor='middle'>" << s << "</text>\n";
  svg << "<text x='" << (kLeft + kWidth - kRight) / 2 << "' y='" << kHeight - 10
      << "' text-anchor='middle'>seconds</text>\n<text transform='translate(18 " << kHeight / 2
      << ") rotate(-90)' text-anchor='middle'>mean marker error, px</text>\n";
}

}  // namespace

std::string error_plot(const std::string& title, const std::vector<Curve>& curves,
                       const std::vector<std::uint8_t>& is_hidden, double frames_per_second) {
  const auto window = static_cast<std::size_t>(std::max(1.0, frames_per_second));
  std::vector<std::vector<double>> lines;
  double top = 0.5;
  for (const Curve& c : curves) {
    lines.push_back(smoothed(c.error, window));
    for (double e : lines.back()) top = std::max(top, e);
  }
  const auto frames = static_cast<double>(std::max<std::size_t>(is_hidden.size(), 1));
  const Axes axes{frames, frames / frames_per_second, std::min(std::ceil(2 * top) / 2, 12.0)};
  std::ostringstream svg;
  svg << "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 " << kWidth << " " << kHeight
      << "' font-family='sans-serif' font-size='12'>\n<rect width='100%' height='100%' fill='white'/>\n";
  for (std::size_t k = 0, end = 0; k < is_hidden.size(); k = end) {
    for (end = k + 1; end < is_hidden.size() && is_hidden[end] == is_hidden[k];) ++end;
    if (is_hidden[k] == 0) continue;
    const double from = axes.x(static_cast<double>(k));
    svg << "<rect x='" << from << "' y='" << kTop << "' width='" << axes.x(static_cast<double>(end)) - from
        << "' height='" << kHeight - kTop - kBottom << "' fill='#f2f0e6'/>\n";
  }
  draw_axes(svg, axes, title);
  for (std::size_t c = 0; c < lines.size(); ++c) {
    const char* colour = kColours[c % (sizeof kColours / sizeof *kColours)];
    svg << "<polyline fill='none' stroke='" << colour << "' stroke-width='1.6' points='";
    svg.precision(4);
    const std::size_t step = std::max<std::size_t>(1, lines[c].size() / 360);  // two pixels
    for (std::size_t k = 0; k < lines[c].size(); k += step)
      svg << axes.x(static_cast<double>(k)) << "," << axes.y(lines[c][k]) << " ";
    const double y = kTop + 16 + 20 * static_cast<double>(c);
    svg << "'/>\n<path d='M" << kWidth - kRight + 10 << " " << y - 4 << "h22' stroke='" << colour
        << "' stroke-width='3'/><text x='" << kWidth - kRight + 38 << "' y='" << y << "'>" << curves[c].name
        << "</text>\n";
  }
  svg << "</svg>\n";
  return svg.str();
}

}  // namespace pliant::figure9
