// Scores a track of a sheet against the surface that sheet_film.py wrote. Beside it: what a rigid sheet and what the model's
// own shapes would leave (the floor: the shapes fitted to the true surface of each frame).
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <iostream>
#include <sstream>
#include <string>

#include "host/io/csv.hpp"
#include "host/io/failure.hpp"
#include "host/io/files.hpp"
#include "host/io/fit_file.hpp"
#include "host/io/owned.hpp"
#include "host/io/track_table.hpp"
#include "pliant/cascade.hpp"
#include "program.hpp"

namespace pliant {
namespace {

using Points = Eigen::Matrix3Xd;

/// A frame counts as wrong when its mean error is above this fraction of the width.
constexpr double kWrong = 0.05;
/// Distance in the chart of the pairs whose lengths tell the stretch: a tenth of a side.
constexpr double kPairFraction = 0.1;

struct Truth {
  Camera camera;
  std::vector<Vec2> uv;
  Points rest;                 // mm
  std::vector<Points> frames;  // mm, camera's axes
  double width = 0;            // mm
  std::vector<std::pair<Eigen::Index, Eigen::Index>> pairs;
};

Truth read_truth(const std::string& path) {
  std::istringstream in(host::read_file(path));
  Truth truth;
  std::vector<Eigen::Vector3d> rest;
  std::string line, word;
  Eigen::Index next = 0;
  while (std::getline(in, line)) {
    std::istringstream words(line);
    double a = 0, b = 0, c = 0, d = 0;
    if (line.rfind("camera", 0) == 0) {
      words >> word >> a >> b >> truth.camera.f >> truth.camera.cx >> truth.camera.cy;
    } else if (line.rfind("rest", 0) == 0) {
      words >> word >> a >> b >> c >> d;
      truth.uv.push_back({static_cast<float>(a), static_cast<float>(b)});
      rest.push_back({c, d, 0});
    } else if (line.rfind("frame", 0) == 0) {
      truth.frames.emplace_back(Points::Zero(3, static_cast<Eigen::Index>(rest.size())));
      next = 0;
    } else {
      words >> a >> b >> c;
      truth.frames.back().col(next++) = Eigen::Vector3d(a, b, c);
    }
    if (words.fail()) throw host::Failure(host::kBadInput, path + ": cannot read '" + line + "'");
  }
  truth.rest.resize(3, static_cast<Eigen::Index>(rest.size()));
  for (std::size_t k = 0; k < rest.size(); ++k) truth.rest.col(static_cast<Eigen::Index>(k)) = rest[k];
  truth.width = truth.rest.row(0).maxCoeff() - truth.rest.row(0).minCoeff();
  const double reach = kPairFraction * truth.width;
  for (Eigen::Index i = 0; i < truth.rest.cols(); ++i)
    for (Eigen::Index k = 0; k < i; ++k) {
      const double length = (truth.rest.col(i) - truth.rest.col(k)).norm();
      if (length > 0.95 * reach && length < 1.05 * reach) truth.pairs.emplace_back(i, k);
    }
  return truth;
}

/// Mean distance after the best rigid motion of `points` (Kabsch), mm. Size is not adapted.
double rigid_error(const Points& points, const Points& truth, Points* aligned = nullptr) {
  const Eigen::Matrix4d m = Eigen::umeyama(points, truth, false);
  const Points moved = (m.topLeftCorner<3, 3>() * points).colwise() + m.topRightCorner<3, 1>();
  if (aligned != nullptr) *aligned = moved;
  return (moved - truth).colwise().norm().mean();
}

/// Root mean square relative change of length of the pairs.
double stretch(const Points& points, const Truth& truth) {
  double sum = 0;
  for (const auto& [i, k] : truth.pairs) {
    const double change =
        (points.col(i) - points.col(k)).norm() / (truth.rest.col(i) - truth.rest.col(k)).norm() - 1;
    sum += change * change;
  }
  return std::sqrt(sum / static_cast<double>(truth.pairs.size()));
}

double image_error(const Points& points, const Points& truth, const Camera& camera) {
  return static_cast<double>(camera.f) * (points.topRows<2>().array().rowwise() / points.row(2).array() -
                                          truth.topRows<2>().array().rowwise() / truth.row(2).array())
                                             .matrix()
                                             .colwise()
                                             .norm()
                                             .mean();
}

class Shape {
 public:
  Shape(const Model& model, const std::vector<Vec2>& uv) : model_(model), cascade_(model) {
    for (const Vec2 p : uv) {
      samples_.emplace_back(cascade_->samples_per_point());
      cascade_->sample_point(p, std::vector<float>(model.parameters().count).data(), samples_.back().data());
    }
  }

  Points at(const std::vector<float>& q) {
    Points points(3, static_cast<Eigen::Index>(samples_.size()));
    for (std::size_t k = 0; k < samples_.size(); ++k)
      points.col(static_cast<Eigen::Index>(k)) = vector(cascade_->evaluate(samples_[k].data(), q.data()));
    return points;
  }

  /// The least mean square error that the model can have: Gauss-Newton over q, aligned anew in each step.
  double floor(const Points& truth, std::vector<float>& q) {
    const auto n = static_cast<Eigen::Index>(q.size());
    for (int step = 0; step < 8; ++step) {
      const Points points = at(q);
      const Eigen::Matrix4d m = Eigen::umeyama(points, truth, false);
      const Eigen::Matrix3d r = m.topLeftCorner<3, 3>();
      const Eigen::Index unknowns = n + 6;
      Eigen::MatrixXd h = Eigen::MatrixXd::Zero(unknowns, unknowns);
      Eigen::VectorXd g = Eigen::VectorXd::Zero(unknowns);
      for (Eigen::Index k = 0; k < n; ++k) h(k, k) = 1e-3;
      for (std::size_t k = 0; k < samples_.size(); ++k) {
        Jacobian jacobian;
        const Eigen::Vector3d p = r * vector(cascade_->evaluate(samples_[k].data(), q.data(), &jacobian)) +
                                  m.topRightCorner<3, 1>();
        Eigen::MatrixXd row = Eigen::MatrixXd::Zero(3, unknowns);
        for (std::size_t c = 0; c < jacobian.count; ++c)
          row.col(jacobian.list[c]) = r * vector(jacobian.column[jacobian.list[c]]);
        row.rightCols<3>() = Eigen::Matrix3d::Identity();
        for (int a = 0; a < 3; ++a) row.col(n + a) = Eigen::Vector3d::Unit(a).cross(p);
        h += row.transpose() * row;
        g += row.transpose() * (truth.col(static_cast<Eigen::Index>(k)) - p);
      }
      const Eigen::VectorXd d = h.ldlt().solve(g);
      for (Eigen::Index k = 0; k < n; ++k) {
        const Parameter& p = model_.parameters()[static_cast<std::size_t>(k)];
        float& value = q[static_cast<std::size_t>(k)];
        value = std::min(std::max(value + static_cast<float>(d(k)), p.minimum), p.maximum);
      }
    }
    return rigid_error(at(q), truth);
  }

 private:
  static Eigen::Vector3d vector(Vec3 p) {
    return {static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)};
  }

  const Model& model_;
  host::Owned<Cascade> cascade_;
  std::vector<std::vector<Vec3>> samples_;
};

Points in_camera(const Points& points, const Pose& pose) {
  Points out(3, points.cols());
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    const Eigen::Vector3f p = points.col(k).cast<float>();
    const Vec3 seen = rotation_matrix(pose.q) * Vec3{p.x(), -p.y(), -p.z()} + pose.t;
    out.col(k) = Eigen::Vector3f(seen.x, seen.y, seen.z).cast<double>();
  }
  return out;
}

struct Sums {
  std::vector<double> aligned, placed, pixels, stretched, rigid, floor, floor_stretch;
  std::size_t tracking = 0, degraded = 0, lost = 0, wrong = 0;
};

double mean(const std::vector<double>& x) {
  double sum = 0;
  for (const double value : x) sum += value;
  return x.empty() ? 0 : sum / static_cast<double>(x.size());
}

double at_fraction(std::vector<double> x, double fraction) {
  if (x.empty()) return 0;
  std::sort(x.begin(), x.end());
  return x[std::min(x.size() - 1, static_cast<std::size_t>(fraction * static_cast<double>(x.size())))];
}

int run(int count, char** words) {
  if (count != 4 && count != 5) {
    std::cerr << "usage: sheet_score MODEL.plm TRUTH.txt TRACK.csv [FRAMES.csv]\n";
    return 2;
  }
  const host::ModelFile file(words[1]);
  const Model& model = file.model();
  const Truth truth = read_truth(words[2]);
  const host::CsvTable table(words[3], host::read_file(words[3]));
  std::vector<std::string> unmatched;
  const auto rows = host::read_posed_parameters(
      table, model, {{}, std::vector<float>(model.parameters().count)}, &unmatched);
  if (!unmatched.empty()) host::fail_input(words[3], "the model has no parameter " + unmatched[0]);
  const std::size_t state = table.column("state");
  std::ofstream details;
  if (count == 5) details.open(words[4]);
  details << "frame,state,aligned,placed,pixels,stretch,floor,rigid\n";
  Shape shape(model, truth.uv);
  std::vector<float> q(model.parameters().count);
  Sums sums;
  for (std::size_t k = 0; k < std::min(rows.size(), truth.frames.size()); ++k) {
    const Points& now = truth.frames[k];
    sums.rigid.push_back(rigid_error(truth.rest, now) / truth.width);
    sums.floor.push_back(shape.floor(now, q) / truth.width);
    sums.floor_stretch.push_back(stretch(shape.at(q), truth));
    const std::string& text = table.cell(k, state);
    (text == "tracking" ? sums.tracking : text == "degraded" ? sums.degraded : sums.lost) += 1;
    if (text == "lost") continue;
    const Points points = shape.at(rows[k].q), seen = in_camera(points, rows[k].pose);
    sums.aligned.push_back(rigid_error(points, now) / truth.width);
    sums.placed.push_back((seen - now).colwise().norm().mean() / truth.width);
    sums.pixels.push_back(image_error(seen, now, truth.camera));
    sums.stretched.push_back(stretch(points, truth));
    sums.wrong += text == "tracking" && sums.aligned.back() > kWrong;
    details << k << ',' << text << ',' << sums.aligned.back() << ',' << sums.placed.back() << ','
            << sums.pixels.back() << ',' << sums.stretched.back() << ',' << sums.floor.back() << ','
            << sums.rigid.back() << '\n';
  }
  std::cout << "frames=" << rows.size() << " tracking=" << sums.tracking << " degraded=" << sums.degraded
            << " lost=" << sums.lost << " wrong=" << sums.wrong << " error=" << 100 * mean(sums.aligned)
            << " error95=" << 100 * at_fraction(sums.aligned, 0.95) << " placed=" << 100 * mean(sums.placed)
            << " px=" << mean(sums.pixels) << " stretch=" << 100 * mean(sums.stretched)
            << " floor=" << 100 * mean(sums.floor) << " floor_stretch=" << 100 * mean(sums.floor_stretch)
            << " rigid=" << 100 * mean(sums.rigid) << '\n';
  return 0;
}

}  // namespace
}  // namespace pliant

int main(int count, char** words) {
  return pliant::run_program("sheet_score", pliant::run, count, words);
}
