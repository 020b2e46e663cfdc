#include "host/bench/fit_problem.hpp"

#include <cmath>
#include <sstream>

#include "host/io/failure.hpp"
#include "host/io/files.hpp"

namespace pliant::host {

namespace {

/// Reads the text word by word. Error messages name the file.
class Words {
 public:
  explicit Words(const std::string& path) : path_(path), in_(read_file(path)) {}
  void expect(const char* word) {
    std::string found;
    if (!(in_ >> found) || found != word)
      fail_input(path_, "expected '" + std::string(word) + "', found '" + found + "'");
  }
  double number() {
    double value = 0;
    if (!(in_ >> value) || !std::isfinite(value)) fail_input(path_, "a number is missing or not finite");
    return value;
  }
  std::size_t count(std::size_t most) {
    const double value = number();
    if (!(value >= 1 && value <= static_cast<double>(most))) fail_input(path_, "a count is out of range");
    return static_cast<std::size_t>(value);
  }
  std::vector<double> numbers(const char* name, std::size_t n) {
    expect(name);
    std::vector<double> out(n);
    for (double& v : out) v = number();
    return out;
  }
  void skip_comment() {
    std::string line;
    while (in_ >> std::ws && in_.peek() == '#') std::getline(in_, line);
  }

 private:
  std::string path_;
  std::istringstream in_;
};

/// Sum of products in eight lanes, so that the compiler can use vector registers.
float dot_product(const float* a, const float* b, std::size_t n) {
  float lane[8] = {};
  std::size_t k = 0;
  for (; k + 8 <= n; k += 8)
    for (std::size_t j = 0; j < 8; ++j) lane[j] += a[k + j] * b[k + j];
  float total = ((lane[0] + lane[1]) + (lane[2] + lane[3])) + ((lane[4] + lane[5]) + (lane[6] + lane[7]));
  for (; k < n; ++k) total += a[k] * b[k];
  return total;
}

}  // namespace

LinearShapeFit::LinearShapeFit(const std::string& path) {
  Words words(path);
  words.expect("corr");
  const std::size_t points = words.count(20000);
  words.expect("modes");
  modes_ = words.count(1000);
  words.expect("cx");
  centre_.x = static_cast<float>(words.number());
  words.expect("cy");
  centre_.y = static_cast<float>(words.number());
  words.expect("sigma_px");
  sigma_ = static_cast<float>(words.number());
  camera_true_ = words.numbers("camera_true", 7);
  camera_start_ = words.numbers("camera_start", 7);
  coefficients_true_ = words.numbers("coef_true", modes_);
  words.skip_comment();
  for (std::size_t i = 0; i < points; ++i) {
    const auto value = [&] { return static_cast<float>(words.number()); };
    Vec2 x;
    x.x = value();
    x.y = value();
    observed_.push_back(x);
    Vec3 p;  // the file has camera axes; y and z change sign in model axes
    p.x = value();
    p.y = -value();
    p.z = -value();
    mean_.push_back(p);
    for (std::size_t k = 0; k < 3 * modes_; ++k) basis_.push_back(k < modes_ ? value() : -value());
  }
  along_x_.resize(kPoseUnknownsWithFocal + modes_);
  along_y_.resize(kPoseUnknownsWithFocal + modes_);
  start_at(camera_start_, std::vector<double>(modes_, 0.0));
}

void LinearShapeFit::start_at(const std::vector<double>& camera, const std::vector<double>& coefficients) {
  const auto at = [&](std::size_t k) { return static_cast<float>(camera[k]); };
  const Pose pose{exp_rotation({at(0), at(1), at(2)}), {at(3), at(4), at(5)}};
  view_ = view_of(pose, {at(6), centre_.x, centre_.y});
  coefficients_.assign(coefficients.begin(), coefficients.end());
  trial_ = coefficients_;
}

Vec3 LinearShapeFit::position(std::size_t point, const float* c) const {
  const float* b = &basis_[3 * modes_ * point];
  const Vec3 m = mean_[point];
  return {m.x + dot_product(b, c, modes_), m.y + dot_product(b + modes_, c, modes_),
          m.z + dot_product(b + 2 * modes_, c, modes_)};
}

float LinearShapeFit::prior_cost(const float* c) const {
  return 0.5f * prior_ * dot_product(c, c, modes_);
}

float LinearShapeFit::cost(const View& view, const float* c) const {
  const Projector projector(view, focal_is_known_);
  const float inverse = 1 / sigma_;
  float total = 0;
  for (std::size_t i = 0; i < observed_.size(); ++i) {
    Vec2 x;
    if (!projector.project(position(i, c), &x)) return 1e30f;
    total += evaluate(loss_, inverse * length(observed_[i] - x)).rho;
  }
  return total + prior_cost(c);
}

float LinearShapeFit::linearise(NormalEquations& equations) {
  const std::size_t pose = pose_unknowns();
  equations.reset(pose + modes_);
  const Projector projector(view_, focal_is_known_);
  const float inverse = 1 / sigma_;
  float total = 0;
  for (std::size_t i = 0; i < observed_.size(); ++i) {
    Vec2 x;
    Projector::Derivatives d;
    if (!projector.project(position(i, coefficients_.data()), &x, &d)) continue;
    const Vec2 residual = observed_[i] - x;
    const LossValue value = evaluate(loss_, inverse * length(residual));
    total += value.rho;
    for (std::size_t k = 0; k < pose; ++k) {
      along_x_[k] = d.pose[k].x;
      along_y_[k] = d.pose[k].y;
    }
    const float *bx = &basis_[3 * modes_ * i], *by = bx + modes_, *bz = by + modes_;
    float *to_x = &along_x_[pose], *to_y = &along_y_[pose];
    for (std::size_t k = 0; k < modes_; ++k) {
      to_x[k] = d.m[0][0] * bx[k] + d.m[0][1] * by[k] + d.m[0][2] * bz[k];
      to_y[k] = d.m[1][0] * bx[k] + d.m[1][1] * by[k] + d.m[1][2] * bz[k];
    }
    const float w = value.weight * inverse * inverse;
    equations.add_dense(along_x_.data(), along_y_.data(), residual, {w, 0, w});
  }
  for (std::size_t k = 0; k < modes_; ++k) equations.add_prior(pose + k, -coefficients_[k], prior_);
  return total + prior_cost(coefficients_.data());
}

float LinearShapeFit::try_step(const float* step) {
  trial_view_ = moved(view_, step, static_cast<int>(pose_unknowns()));
  for (std::size_t k = 0; k < modes_; ++k) trial_[k] = coefficients_[k] + step[pose_unknowns() + k];
  return cost(trial_view_, trial_.data());
}

LeastSquaresProblem LinearShapeFit::problem() {
  return {this, [](void* p, NormalEquations& e) { return static_cast<LinearShapeFit*>(p)->linearise(e); },
          [](void* p, const float* s) { return static_cast<LinearShapeFit*>(p)->try_step(s); },
          [](void* p) {
            auto& fit = *static_cast<LinearShapeFit*>(p);
            fit.view_ = fit.trial_view_;
            fit.coefficients_ = fit.trial_;
          }};
}

double LinearShapeFit::exact_cost() const {
  const Projector projector(view_, true);
  const Vec3 axis[3] = {projector.rotated({1, 0, 0}), projector.rotated({0, 1, 0}),
                        projector.rotated({0, 0, 1})};
  double total = 0;
  for (std::size_t i = 0; i < observed_.size(); ++i) {
    double p[3] = {double(mean_[i].x), double(mean_[i].y), double(mean_[i].z)};
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t k = 0; k < modes_; ++k)
        p[c] += double(basis_[(3 * i + c) * modes_ + k]) * double(coefficients_[k]);
    double r[3] = {};
    for (int c = 0; c < 3; ++c) {
      r[0] += p[c] * double(axis[c].x);
      r[1] += p[c] * double(axis[c].y);
      r[2] += p[c] * double(axis[c].z);
    }
    const double scale = double(view_.s) / (1 + double(view_.rho) * r[2]);
    const double dx = double(observed_[i].x) - double(view_.c.x) - scale * (r[0] + double(view_.tau.x));
    const double dy = double(observed_[i].y) - double(view_.c.y) - scale * (r[1] + double(view_.tau.y));
    const double u = std::hypot(dx, dy) / double(sigma_);
    total += loss_ == Loss::huber && u > 1.345 ? 1.345 * (u - 0.5 * 1.345) : 0.5 * u * u;
  }
  for (float c : coefficients_) total += 0.5 * double(prior_) * double(c) * double(c);
  return total;
}

}  // namespace pliant::host
