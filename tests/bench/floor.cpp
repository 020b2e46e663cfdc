// The floor under a tracking error: what a model leaves when it is fitted to the annotated points of each frame
// themselves, identity and focal length as fitted in frame 0. What a tracker's error has above it is the tracker's.
#include <cstdlib>
#include <iostream>
#include <map>
#include <optional>

#include "host/commands/image_fit.hpp"
#include "host/io/csv.hpp"
#include "host/io/failure.hpp"
#include "host/io/owned.hpp"
#include "pliant/estimator.hpp"
#include "pliant/fit.hpp"
#include "program.hpp"

namespace pliant {
namespace {

using Frame = std::map<std::string, Vec2>;

/// Frames in order; a frame without points is left out.
std::map<int, Frame> read_truth(const std::string& path) {
  const host::CsvTable table(path, host::read_file(path));
  const std::size_t frame = table.column("frame"), name = table.column("landmark"), x = table.column("x"),
                    y = table.column("y");
  std::map<int, Frame> out;
  for (std::size_t i = 0; i < table.row_count(); ++i)
    out[static_cast<int>(table.number(i, frame))][table.cell(i, name)] = {table.number(i, x),
                                                                          table.number(i, y)};
  return out;
}

struct Named {
  std::string name;
  Vec2 uv;
};

std::vector<Named> landmarks_of(const Model& model) {
  std::vector<Named> out;
  for (const Landmark& l : model.landmarks())
    if (std::string(l.name).rfind("ibug", 0) == 0) out.push_back({l.name, l.uv()});
  return out;
}

/// The surface points under the markers of frame 0.
std::vector<Named> cast_markers(const Model& model, const host::FitFile& fit, const std::vector<float>& q,
                                const std::string& path) {
  host::Owned<Estimator> estimator(model, EstimatorLimits{});
  host::require(estimator->start(fit.camera, fit.width, fit.height, fit.pose, q.data(), nullptr, {}), path);
  std::vector<Named> out;
  for (const host::NamedPoint& p : host::read_points(path)) {
    Vec2 uv;
    if (estimator->surface_at(p.x, &uv) >= 0) out.push_back({p.name, uv});
  }
  return out;
}

/// Mean distance of the outer eye corners: by either naming of the points.
double eye_distance(const std::map<int, Frame>& truth) {
  double sum = 0;
  int count = 0;
  for (const auto& [number, frame] : truth)
    for (const auto& [a, b] : {std::pair("ibug36", "ibug45"), std::pair("fgnet27", "fgnet32")})
      if (frame.count(a) && frame.count(b)) {
        sum += static_cast<double>(length(frame.at(a) - frame.at(b)));
        ++count;
        break;
      }
  return count > 0 ? sum / count : 0;
}

class FrameFits {
 public:
  FrameFits(const Model& model, const host::FitFile& start, std::vector<float> q, std::size_t points)
      : fitter_(model, FitLimits{static_cast<std::uint16_t>(points)}),
        q_(std::move(q)),
        view_(view_of(start.pose, start.camera)) {
    options_.width = start.width;
    options_.height = start.height;
    options_.focal_px = start.camera.f;
    for (const Parameter& p : model.parameters()) is_free_.push_back(p.group == Group::expression);
    options_.is_free = is_free_.data();
  }

  /// Sum of distances after the fit; nothing when it could not be made.
  std::optional<double> add(const std::vector<Correspondence>& points) {
    std::vector<Vec2> residual(points.size());
    FitReport report;
    options_.start = &view_;
    if (fitter_->fit({points.data(), points.size()}, options_, q_.data(), &report, {nullptr, residual.data()}) != Status::ok)
      return std::nullopt;
    view_ = report.view;
    double sum = 0;
    for (Vec2 r : residual) sum += static_cast<double>(length(r));
    return sum;
  }

 private:
  host::Owned<Fitter> fitter_;
  std::vector<float> q_;
  View view_;
  std::vector<std::uint8_t> is_free_;
  FitOptions options_;
};

void print_floor(const char* kind, const Model& model, const host::FitFile& start, const std::vector<float>& q,
                 const std::vector<Named>& points, const std::map<int, Frame>& truth) {
  FrameFits fits(model, start, q, points.size());
  double sum = 0;
  std::size_t count = 0, failed = 0;
  for (const auto& [number, frame] : truth) {
    std::vector<Correspondence> seen;
    for (const Named& p : points)
      if (const auto found = frame.find(p.name); found != frame.end())
        seen.push_back({p.uv, found->second, 1});
    const std::optional<double> distances = fits.add(seen);
    if (!distances) {
      ++failed;
      continue;
    }
    sum += *distances;
    count += seen.size();
  }
  const double mean = count > 0 ? sum / static_cast<double>(count) : 0;
  std::cout << kind << ": frames=" << truth.size() - failed << " failed=" << failed
            << " points=" << points.size() << " mean_px=" << mean
            << " nme=" << 100 * mean / eye_distance(truth) << "\n";
}

int run(int count, char** words) {
  int width = 0, height = 0;
  if ((count != 5 && count != 6) || std::sscanf(words[2], "%dx%d", &width, &height) != 2) {
    std::cerr << "usage: tracking_floor face.plm WxH INIT.csv TRUTH.csv [MARKERS.csv]\n"
                 "INIT and MARKERS as landmark,x,y in frame 0, TRUTH as frame,landmark,x,y.\n";
    return 2;
  }
  const host::ModelFile file(words[1]);
  const Model& model = file.model();
  host::FitSetup setup;
  setup.size = {width, height};
  const host::FitFile start = host::fit_to_points(file, words[3], host::read_points(words[3]), setup);
  std::vector<float> q(model.parameters().count, 0.0f);
  host::apply(start.parameters, words[3], model, q.data());
  const std::map<int, Frame> truth = read_truth(words[4]);
  if (truth.empty()) host::fail_input(words[4], "has no rows");
  std::vector<Named> landmarks;
  for (const Named& l : landmarks_of(model))
    if (truth.begin()->second.count(l.name)) landmarks.push_back(l);
  print_floor("landmarks", model, start, q, landmarks, truth);
  if (count == 6) print_floor("markers", model, start, q, cast_markers(model, start, q, words[5]), truth);
  return 0;
}

}  // namespace
}  // namespace pliant

int main(int count, char** words) {
  return pliant::run_program("tracking_floor", pliant::run, count, words);
}
