#pragma once
// The fit of linear shapes in double precision, written apart from the library with Eigen: Levenberg-Marquardt on the
// same residuals, priors and limits. What it reaches is the reference for what the library reaches.
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "dense.hpp"
#include "fit/fit_tuning.hpp"
#include "pliant/fit.hpp"

struct DoubleFit {
  using Matrix = Eigen::MatrixXd;
  using Vector = Eigen::VectorXd;

  /// Pinhole camera and shape.
  struct State {
    Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
    Eigen::Vector3d t{0, 0, 1000};
    double log_f = 0;
    Vector q;
  };

  Eigen::Vector2d centre;
  double log_f_prior = 0, log_f_sd = 0.3;
  Vector sd, low, high;       // of the parameters
  std::vector<Matrix> basis;  // a point: 3 x parameters
  std::vector<Eigen::Vector3d> mean;
  std::vector<Eigen::Vector2d> x;
  std::vector<double> point_sd;

  /// Points of a model whose free parameters act linearly on them (checked by the caller).
  DoubleFit(const pliant::Model& model, pliant::Cascade& cascade,
            const std::vector<pliant::Correspondence>& points, const pliant::FitOptions& options) {
    const auto columns = static_cast<Eigen::Index>(cascade.column_count());
    const double larger = double(options.width > options.height ? options.width : options.height);
    centre = {0.5 * (options.width - 1), 0.5 * (options.height - 1)};
    log_f_prior = std::log(double(pliant::kDefaultFocalRatio) * larger);
    log_f_sd = double(pliant::kFitTuning.focal_log_sd);
    sd.resize(columns);
    low = high = sd;
    for (Eigen::Index k = 0; k < columns; ++k) {
      const pliant::Parameter& p = model.parameters()[cascade.parameter_of(std::size_t(k))];
      sd(k) = double(p.sd);
      low(k) = double(p.minimum);
      high(k) = double(p.maximum);
    }
    std::vector<float> rest(model.parameters().count, 0.0f);
    std::vector<pliant::Vec3> baked(model.cascade().count);
    for (const pliant::Correspondence& c : points) {
      cascade.sample_point(c.uv, rest.data(), baked.data());
      pliant::Jacobian j;
      const pliant::Vec3 p = cascade.evaluate(baked.data(), rest.data(), &j);
      mean.push_back({double(p.x), double(p.y), double(p.z)});
      Matrix b = Matrix::Zero(3, columns);
      for (std::size_t k = 0; k < j.count; ++k) {
        const pliant::Vec3 v = j.column[j.list[k]];
        b.col(j.list[k]) << double(v.x), double(v.y), double(v.z);
      }
      basis.push_back(b);
      x.push_back({double(c.x.x), double(c.x.y)});
      point_sd.push_back(double(c.sd_px));
    }
  }

  State state_of(const pliant::View& view, const pliant::Cascade& cascade,
                 const std::vector<float>& q) const {
    const pliant::Pose pose = pliant::pose_of(view);
    State s;
    s.turn = Eigen::Quaterniond(double(pose.q.w), double(pose.q.x), double(pose.q.y), double(pose.q.z))
                 .normalized();
    s.t = {double(pose.t.x), double(pose.t.y), double(pose.t.z)};
    s.log_f = std::log(double(pliant::camera_of(view).f));
    s.q.resize(sd.size());
    for (Eigen::Index k = 0; k < sd.size(); ++k) s.q(k) = double(q[cascade.parameter_of(std::size_t(k))]);
    return s;
  }

  /// Half the sum of squares, priors included; and, if asked, J^T J and -J^T r of unknowns turn, t, log f, q.
  double cost(const State& s, Matrix* h = nullptr, Vector* g = nullptr) const {
    const Eigen::Index n = 7 + sd.size();
    if (h != nullptr) {
      *h = Matrix::Zero(n, n);
      *g = Vector::Zero(n);
    }
    const double f = std::exp(s.log_f), z_f = (s.log_f - log_f_prior) / log_f_sd;
    const Eigen::Matrix3d r = s.turn.toRotationMatrix() * Eigen::Vector3d(1, -1, -1).asDiagonal();
    double total = 0.5 * z_f * z_f + 0.5 * s.q.cwiseQuotient(sd).squaredNorm();
    Matrix row(2, n);
    for (std::size_t i = 0; i < mean.size(); ++i) {
      const Eigen::Vector3d turned = r * (mean[i] + basis[i].lazyProduct(s.q)), p = turned + s.t;
      const Eigen::Vector2d image = f * p.head<2>() / p.z(), e = (x[i] - centre - image) / point_sd[i];
      total += 0.5 * e.squaredNorm();
      if (h == nullptr) continue;
      Eigen::Matrix<double, 2, 3> d;
      d << f / p.z(), 0, -image.x() / p.z(), 0, f / p.z(), -image.y() / p.z();
      Eigen::Matrix3d cross;
      cross << 0, turned.z(), -turned.y(), -turned.z(), 0, turned.x(), turned.y(), -turned.x(), 0;
      row << d * cross, d, image, (d * r).lazyProduct(basis[i]);
      row /= point_sd[i];
      add_product(*h, row, row);
      *g += row.transpose().lazyProduct(e);
    }
    if (h == nullptr) return total;
    (*h)(6, 6) += 1 / (log_f_sd * log_f_sd);
    (*g)(6) -= z_f / log_f_sd;
    for (Eigen::Index k = 0; k < sd.size(); ++k) {
      (*h)(7 + k, 7 + k) += 1 / (sd(k) * sd(k));
      (*g)(7 + k) -= s.q(k) / (sd(k) * sd(k));
    }
    return total;
  }

  State moved(const State& s, const Vector& step) const {
    State out = s;
    const Eigen::Vector3d w = step.head<3>();
    const double angle = w.norm();
    if (angle > 0) out.turn = Eigen::Quaterniond(Eigen::AngleAxisd(angle, w / angle)) * s.turn;
    out.t += step.segment<3>(3);
    out.log_f += step(6);
    out.q = (s.q + step.tail(sd.size())).cwiseMax(low).cwiseMin(high);
    return out;
  }

  /// The minimum within the limits that is found from s: parameters at a limit with the force outwards are held there.
  State minimise(State s) const {
    double damping = 1e-4;
    Matrix h;
    Vector g;
    double best = cost(s, &h, &g);
    for (int iteration = 0; iteration < 300; ++iteration) {
      for (Eigen::Index k = 0; k < sd.size(); ++k) {
        const bool held = (s.q(k) >= high(k) && g(7 + k) > 0) || (s.q(k) <= low(k) && g(7 + k) < 0);
        if (!held) continue;
        h.row(7 + k).setZero();
        h.col(7 + k).setZero();
        h(7 + k, 7 + k) = 1;
        g(7 + k) = 0;
      }
      bool accepted = false;
      for (int k = 0; k < 25 && !accepted; ++k) {
        Matrix a = h;
        a.diagonal() *= 1 + damping;
        const State trial = moved(s, solve_symmetric(a, g));
        const double value = cost(trial);
        accepted = value < best;
        damping = accepted ? std::max(0.1 * damping, 1e-12) : 10 * damping;
        if (!accepted) continue;
        const bool done = best - value < 1e-12 * best;
        s = trial;
        best = cost(s, &h, &g);
        if (done) return s;
      }
      if (!accepted) return s;
    }
    return s;
  }
};
