#include "host/commands/track_report.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "host/io/page.hpp"
#include "host/io/statistics.hpp"
#include "host/io/truth.hpp"
#include "host/render/overlay.hpp"
#include "host/render/svg_chart.hpp"

namespace pliant::host {

namespace {

constexpr int kJpegQuality = 82;
/// An expression that stays within this fraction of its range is listed without a chart.
constexpr float kStillFraction = 0.02f;
constexpr double kDegrees = 57.29577951308232;

/// Yaw, pitch and roll in degrees, R = Rz(roll) Ry(yaw) Rx(pitch).
struct Angles {
  double yaw, pitch, roll;
};
Angles angles_of(Quat q) {
  const Mat3 r = rotation_matrix(q);
  const auto at = [&](int i, int j) { return static_cast<double>(r.m[i][j]); };
  return {kDegrees * std::atan2(-at(2, 0), std::hypot(at(2, 1), at(2, 2))),
          kDegrees * std::atan2(at(2, 1), at(2, 2)), kDegrees * std::atan2(at(1, 0), at(0, 0))};
}

std::string fixed(double value, int digits) {
  char text[40];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

/// 1234567 as 1,234,567.
std::string grouped(std::size_t value) {
  std::string digits = std::to_string(value);
  for (std::size_t k = digits.size(); k > 3; k -= 3) digits.insert(k - 3, ",");
  return digits;
}

std::string tile(const std::string& value, const std::string& name) {
  return "<div class=\"tile\"><b>" + value + "</b>" + name + "</div>";
}

}  // namespace

void TrackReport::add(const TrackRow& row, std::optional<double> milliseconds) {
  if (!rows_.empty() && milliseconds) milliseconds_.push_back(*milliseconds);
  rows_.push_back(row);
  rows_.back().points.clear();
}

template <class Value>
std::vector<std::optional<double>> TrackReport::over_time(const Value& value) const {
  std::vector<std::optional<double>> out;
  for (const TrackRow& row : rows_)
    out.push_back(row.state == TrackState::lost ? std::nullopt : std::optional<double>(value(row)));
  return out;
}

std::string TrackReport::pictures(const ContactSheet& sheet) const {
  std::string out;
  for (const auto& [number, image] : sheet.pictures()) {
    const TrackRow& row = rows_[static_cast<std::size_t>(number)];
    const std::string caption =
        "frame " + std::to_string(row.frame) + ", " + fixed(row.time_s, 2) + " s, " + state_text(row.state);
    out += "<figure><img alt=\"" + caption + "\" src=\"" + jpeg_address(image, kJpegQuality) +
           "\"><figcaption>" + caption + "</figcaption></figure>\n";
  }
  return out;
}

std::string TrackReport::tiles(const ReportFacts& facts) const {
  std::size_t count[3] = {};
  for (const TrackRow& row : rows_) ++count[static_cast<std::size_t>(row.state)];
  return tile(grouped(rows_.size()), "frames") + tile(grouped(count[0]), "tracking") +
         tile(grouped(count[1]), "degraded") + tile(grouped(count[2]), "lost") +
         tile(fixed(facts.rms_px, 2) + " px", "rms") +
         tile(fixed(median(milliseconds_), 2) + " ms", "a frame, median") +
         tile(grouped(facts.vertices), "vertices") +
         tile(grouped(facts.arena_bytes / 1024) + " KiB", "arena");
}

std::string TrackReport::pose_charts() const {
  const double first = rows_.front().time_s, last = rows_.back().time_s;
  ChartStyle degrees;
  degrees.unit = "\u00b0";
  ChartStyle millimetres;
  millimetres.unit = "mm";
  const auto known =
      std::find_if(rows_.begin(), rows_.end(), [](const TrackRow& r) { return r.state != TrackState::lost; });
  const Vec3 origin = known == rows_.end() ? Vec3{} : known->pose.t;
  const auto shift = [&](float Vec3::*axis) {
    return over_time(
        [&, axis](const TrackRow& r) { return static_cast<double>(r.pose.t.*axis - origin.*axis); });
  };
  const auto named = [&](const char* axis, float value) {
    return std::string(axis) + " from " + fixed(static_cast<double>(value), 0) + " mm";
  };
  return "<h3>Rotation</h3>" +
         line_chart({{"yaw", over_time([](const TrackRow& r) { return angles_of(r.pose.q).yaw; })},
                     {"pitch", over_time([](const TrackRow& r) { return angles_of(r.pose.q).pitch; })},
                     {"roll", over_time([](const TrackRow& r) { return angles_of(r.pose.q).roll; })}},
                    first, last, degrees) +
         "<h3>Position, against the first frame</h3>" +
         line_chart({{named("x right", origin.x), shift(&Vec3::x)},
                     {named("y down", origin.y), shift(&Vec3::y)},
                     {named("z away", origin.z), shift(&Vec3::z)}},
                    first, last, millimetres);
}

std::string TrackReport::expression_charts() const {
  ChartStyle style;
  style.width = 300;
  style.height = 44;
  style.has_axes = false;
  std::string out = "<div class=\"sparks\">", still;
  for (std::size_t k = 0; k < model_.parameters().count; ++k) {
    const Parameter& p = model_.parameters()[k];
    const Series series{p.name, over_time([k](const TrackRow& r) { return static_cast<double>(r.q[k]); })};
    double low = 1e300, high = -1e300;
    for (const auto& value : series.values)
      if (value) low = std::min(low, *value), high = std::max(high, *value);
    const bool moves = high - low > static_cast<double>(kStillFraction * (p.maximum - p.minimum));
    if (!moves && p.group == Group::expression) still += (still.empty() ? "" : ", ") + html_text(p.name);
    if (!moves) continue;
    style.at_least = static_cast<double>(p.minimum);
    style.at_most = static_cast<double>(p.maximum);
    out += "<div class=\"spark-box\"><span>" + html_text(p.name) + "</span><span class=\"range\">" +
           fixed(low, 2) + " to " + fixed(high, 2) + "</span>" + line_chart({series}, 0, 1, style) + "</div>";
  }
  out += "</div><p class=\"note\">Each box spans the parameter's whole range.";
  return out + (still.empty() ? "</p>" : " Within 2 % of theirs throughout: " + still + ".</p>");
}

std::string TrackReport::observation_charts() const {
  const double first = rows_.front().time_s, last = rows_.back().time_s;
  // Observations are shown for lost frames too.
  const auto counted = [&](int TrackRow::*number) {
    std::vector<std::optional<double>> out;
    for (const TrackRow& row : rows_) out.push_back(static_cast<double>(row.*number));
    return out;
  };
  ChartStyle counts, pixels;
  counts.at_least = pixels.at_least = 0;
  pixels.unit = "px";
  pixels.height = 120;
  return "<h3>Returned by the trackers, and used in the end</h3>" +
         line_chart({{"returned", counted(&TrackRow::tracked)}, {"inliers", counted(&TrackRow::inliers)}},
                    first, last, counts) +
         "<h3>Residual of the inliers, rms</h3>" +
         line_chart({{"rms", over_time([](const TrackRow& r) { return static_cast<double>(r.rms_px); })}},
                    first, last, pixels);
}

std::string TrackReport::memory_table(const ReportFacts& facts) const {
  const auto row = [](const char* what, const std::string& value, const char* note) {
    return std::string("<tr><td>") + what + "</td><td class=\"number\">" + value + "</td><td>" + note +
           "</td></tr>";
  };
  return "<table>" +
         row("arena", grouped(facts.arena_bytes) + " bytes",
             "all memory of the tracker at run time, fixed at its start") +
         row("model table", grouped(facts.table_bytes) + " bytes",
             "read in place, from flash or a mapped file") +
         row("one frame",
             grouped(static_cast<std::size_t>(facts.width) * static_cast<std::size_t>(facts.height)) +
                 " bytes",
             "the caller's, read during an update only") +
         "</table>";
}

std::string TrackReport::page(const ReportFacts& facts, const ContactSheet& sheet) const {
  std::vector<int> states;
  for (const TrackRow& row : rows_) states.push_back(static_cast<int>(row.state));
  ChartStyle band;
  band.height = 22;
  ChartStyle times;
  times.unit = "ms";
  const std::vector<std::pair<std::string, double>> marks{{"median", median(milliseconds_)},
                                                          {"95 %", quantile(milliseconds_, 0.95)}};
  return fill_page(kReportPage,
                   {{"title", html_text(facts.title)},
                    {"size", std::to_string(facts.width) + " x " + std::to_string(facts.height)},
                    {"tiles", tiles(facts)},
                    {"summary", html_text(facts.summary)},
                    {"pictures", pictures(sheet)},
                    {"states", ribbon(states, {"tracking", "degraded", "lost"}, band)},
                    {"pose", pose_charts()},
                    {"expressions", expression_charts()},
                    {"observations", observation_charts()},
                    {"times", histogram(milliseconds_, marks, times)},
                    {"slowest", fixed(milliseconds_.empty() ? 0 : quantile(milliseconds_, 1), 2)},
                    {"memory", memory_table(facts)}});
}

}  // namespace pliant::host
