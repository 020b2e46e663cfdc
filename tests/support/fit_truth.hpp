#pragma once
// Fits of random faces whose truth is known, by the library and by an independent double-precision routine, and what is wrong
// with each: pose, shape, and where points of the surface that took no part are seen.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "baked_model.hpp"
#include "double_fit.hpp"
#include "model_builder.hpp"
#include "random.hpp"

namespace fit_truth {

using namespace pliant;

constexpr int kWidth = 640, kHeight = 480;
constexpr float kNoisePx = 0.5f, kEyeDistancePx = 100, kMostTurn = 0.5236f;
constexpr std::size_t kHeldOut = 200;

inline double quantile(std::vector<double> v, double fraction) {
  std::sort(v.begin(), v.end());
  return v.empty() ? 0 : v[static_cast<std::size_t>(fraction * static_cast<double>(v.size() - 1))];
}

/// A random person under a random camera: parameters of the free group in standard deviations, turned by up to 30 degrees,
/// the eyes 100 px apart, focal length between 700 and 1100 px and not told.
struct Person {
  std::vector<float> q;
  View view;
  std::vector<Correspondence> points;  // with noise
  std::vector<Vec2> held_out;
};

struct Errors {
  double rms_px = 0, turn_deg = 0, surface_mm = 0;
};

class Study {
 public:
  Study(BakedModel& face, std::size_t points)
      : face_(face), fitter_(face.model, limits(points)), most_(points) {
    for (const Parameter& p : face.model.parameters()) is_free_.push_back(p.group == Group::identity);
    face.cascade.set_free(is_free_.data());
  }
  std::size_t required_bytes() const { return measured_bytes<Fitter>(face_.model, limits(most_)); }

  Person person(std::uint64_t seed, std::size_t count) {
    Random random(seed);
    Person out;
    out.q = face_.rest();
    for (std::size_t k = 0; k < out.q.size(); ++k) {
      const Parameter& p = face_.model.parameters()[k];
      if (is_free_[k]) out.q[k] = clamp(p.sd * random.normal(), p.minimum, p.maximum);
    }
    const Vec3 right = face_.at("ibug36", out.q), left = face_.at("ibug45", out.q);
    const float f = random.uniform(700, 1100), depth = f * length(left - right) / kEyeDistancePx;
    Vec3 turn{1, 1, 1};
    while (length(turn) > kMostTurn)
      turn = {random.uniform(-kMostTurn, kMostTurn), random.uniform(-kMostTurn, kMostTurn),
              random.uniform(-kMostTurn, kMostTurn)};
    out.view = view_of({exp_rotation(turn), {random.uniform(-30, 30), random.uniform(-20, 20), depth}},
                       centred_camera(kWidth, kHeight, f));
    const Projector projector(out.view, true);
    while (out.points.size() < count) {
      Correspondence c{visible_point(random, projector, out.q), {}, kNoisePx};
      REQUIRE(projector.project(face_.at(c.uv, out.q), &c.x));
      c.x = c.x + Vec2{kNoisePx * random.normal(), kNoisePx * random.normal()};
      out.points.push_back(c);
    }
    while (out.held_out.size() < kHeldOut) out.held_out.push_back(visible_point(random, projector, out.q));
    return out;
  }

  FitOptions options() const {
    FitOptions o;
    o.width = kWidth;
    o.height = kHeight;
    o.is_free = is_free_.data();
    o.misfit_mm = 0;
    o.robust = false;
    return o;
  }
  FitReport fit(const std::vector<Correspondence>& points, const FitOptions& options, std::vector<float>& q) {
    FitReport report;
    q = face_.rest();
    REQUIRE(fitter_->fit({points.data(), points.size()}, options, q.data(), &report) == Status::ok);
    return report;
  }
  /// The mean face under the pose that fits it best.
  FitReport fit_mean(const std::vector<Correspondence>& points) {
    const std::vector<std::uint8_t> none(is_free_.size(), 0);
    FitOptions o = options();
    o.is_free = none.data();
    std::vector<float> q;
    return fit(points, o, q);
  }
  /// Cost of the library's fit over the double-precision optimum, less 1. That is sought from the fit and from the truth.
  double excess_cost(const Person& person, const FitReport& report, const std::vector<float>& q) {
    face_.cascade.set_free(is_free_.data());
    const DoubleFit exact(face_.model, face_.cascade, person.points, options());
    const auto reached = exact.state_of(report.view, face_.cascade, q);
    const double best =
        std::min(exact.cost(exact.minimise(reached)),
                 exact.cost(exact.minimise(exact.state_of(person.view, face_.cascade, person.q))));
    return exact.cost(reached) / best - 1;
  }
  Errors errors(const Person& person, const View& view, const std::vector<float>& q) {
    Errors out;
    out.turn_deg = turn_between(view, person.view);
    const Projector seen(person.view, true), found(view, true);
    std::vector<Eigen::Vector3d> a, b;
    for (Vec2 uv : person.held_out) {
      const Vec3 p = face_.at(uv, person.q), e = face_.at(uv, q);
      Vec2 x, y;
      REQUIRE(seen.project(p, &x));
      REQUIRE(found.project(e, &y));
      out.rms_px += double(dot(x - y, x - y));
      const Vec3 d = p - e;
      out.surface_mm += double(dot(d, d));
    }
    const auto n = static_cast<double>(person.held_out.size());
    out.rms_px = std::sqrt(out.rms_px / n);
    out.surface_mm = std::sqrt(out.surface_mm / n);
    return out;
  }
  static double turn_between(const View& a, const View& b) {
    return 57.29578 * double(length(log_rotation(a.q * conjugate(b.q))));
  }

 private:
  static FitLimits limits(std::size_t points) {
    FitLimits l;
    l.points = static_cast<std::uint16_t>(points);
    return l;
  }
  Vec2 visible_point(Random& random, const Projector& projector, const std::vector<float>& q) {
    for (;;) {
      const Vec2 uv{random.uniform(0.05f, 0.95f), random.uniform(0.05f, 0.95f)};
      if (!face_.model.is_on_surface(uv)) continue;
      const SurfaceFrame f = face_.cascade.surface_frame(uv, q.data());
      const Vec3 n = projector.rotated(normalised(cross(f.pv, f.pu)));
      if (-dot(n, normalised(projector.to_camera(f.p))) > 0.25f) return uv;
    }
  }

  BakedModel& face_;
  InArena<Fitter> fitter_;
  std::size_t most_;
  std::vector<std::uint8_t> is_free_;
};

/// 30 % of the points anywhere within 150 px of the face's middle.
inline std::vector<Correspondence> with_outliers(const Person& person, std::uint64_t seed) {
  Random random(seed);
  auto points = person.points;
  for (Correspondence& c : points)
    if (random.below(10) < 3) c.x = {320 + random.uniform(-150, 150), 240 + random.uniform(-150, 150)};
  return points;
}

struct Summary {
  std::vector<double> excess, outlier_turn;
  std::vector<Errors> fit, null;

  static std::vector<double> of(const std::vector<Errors>& errors, double Errors::*member) {
    std::vector<double> out;
    for (const Errors& e : errors) out.push_back(e.*member);
    return out;
  }
  double median(const std::vector<Errors>& errors, double Errors::*member) const {
    return quantile(of(errors, member), 0.5);
  }
};

inline Summary run(Study& study, std::size_t points, int faces) {
  Summary out;
  for (int k = 0; k < faces; ++k) {
    const Person person = study.person(1000 + static_cast<std::uint64_t>(k), points);
    std::vector<float> q, rough, mean(person.q.size(), 0.0f);
    const FitReport report = study.fit(person.points, study.options(), q);
    out.excess.push_back(study.excess_cost(person, report, q));
    out.fit.push_back(study.errors(person, report.view, q));
    out.null.push_back(study.errors(person, study.fit_mean(person.points).view, mean));
    FitOptions robust = study.options();
    robust.robust = true;
    const FitReport spoilt = study.fit(with_outliers(person, static_cast<std::uint64_t>(k)), robust, rough);
    out.outlier_turn.push_back(Study::turn_between(spoilt.view, person.view));
  }
  return out;
}

inline void print(const Summary& s, const std::string& name, std::size_t points) {
  const auto line = [&](const char* what, const std::vector<Errors>& e) {
    const auto turn = Summary::of(e, &Errors::turn_deg), px = Summary::of(e, &Errors::rms_px),
               mm = Summary::of(e, &Errors::surface_mm);
    std::printf(
        "%s, %zu points, %-9s pose %.2f (95 %%: %.2f) degrees, 200 held-out points %.2f (%.2f) px rms, "
        "surface %.2f (%.2f) mm rms\n",
        name.c_str(), points, what, quantile(turn, 0.5), quantile(turn, 0.95), quantile(px, 0.5),
        quantile(px, 0.95), quantile(mm, 0.5), quantile(mm, 0.95));
  };
  line("fit:", s.fit);
  line("mean face:", s.null);
  std::printf(
      "%s, %zu points: cost above the double-precision optimum %.5f %% median, %.4f %% worst; pose with 30 "
      "%% gross "
      "outliers %.2f degrees\n",
      name.c_str(), points, 100 * quantile(s.excess, 0.5), 100 * quantile(s.excess, 1),
      quantile(s.outlier_turn, 0.5));
}

}  // namespace fit_truth
