#include "host/bench/occlusion_experiment.hpp"

#include <algorithm>
#include <memory>
#include <random>
#include <vector>

#include "host/bench/rows.hpp"
#include "host/io/owned.hpp"

namespace pliant::host {

namespace {

constexpr int kWidth = 320, kHeight = 240;
constexpr std::size_t kSurfacePoints = 120;
constexpr float kNoisePx = 0.4f;

/// Random numbers. std::mt19937 gives the same numbers everywhere; the distributions of the standard library may not.
class Dice {
 public:
  float uniform(float low, float high) {
    return low + (high - low) * static_cast<float>(engine_() >> 8) * (1.0f / 16777216);
  }
  float normal() {
    float sum = 0;
    for (int k = 0; k < 12; ++k) sum += uniform(0, 1);
    return sum - 6;
  }

 private:
  std::mt19937 engine_{2024};
};

struct Situation {
  View view;
  std::vector<float> q;
};

/// A person, a pose and points, and an estimator for each rejection method.
class CoveredPerson {
 public:
  CoveredPerson(const Model& model, Dice& dice) : model_(model), dice_(dice), truth_(model) {
    before_.q.resize(model.parameters().count);
    for (std::size_t i = 0; i < before_.q.size(); ++i) {
      const Parameter& p = model.parameters()[i];
      before_.q[i] = p.group == Group::identity ? dice.normal()
                                                : clamp(0.3f * p.sd * dice.normal(), p.minimum, p.maximum);
    }
    const Pose pose{exp_rotation({0.1f * dice.normal(), 0.2f * dice.normal(), 0.1f * dice.normal()}),
                    {10 * dice.normal(), 10 * dice.normal(), 480}};
    const Camera camera = centred_camera(kWidth, kHeight, 450);
    before_.view = view_of(pose, camera);
    EstimatorLimits limits;
    limits.points = kSurfacePoints;
    limits.vertices = 1024;
    for (int d = 0; d < kMethods; ++d) {
      estimators_.push_back(std::make_unique<Owned<Estimator>>(model, limits));
      EstimatorOptions options;
      options.mesh_error_mm = 100;
      options.model_error_mm = 0.6f;  // the points are on the model's surface
      options.rejection = rejection_of(static_cast<RejectionMethod>(d));
      Estimator& e = **estimators_.back();
      require(e.start(camera, kWidth, kHeight, pose, before_.q.data(), nullptr, options), "occlusion");
      if (d == 0) choose_points(e);
      for (const Vec2 uv : uv_) {
        std::uint16_t id;
        require(e.add_point(uv, &id), "occlusion");
      }
    }
  }

  void run(Disturbance disturbance, double fraction, OcclusionResult* sum) {
    Situation after = moved_from(before_, 1), foreign = moved_from(before_, 3);
    if (disturbance == Disturbance::expression) {
      const std::uint16_t jaw = model_.find_parameter("jawOpen");
      if (jaw != kNone) after.q[jaw] = before_.q[jaw] + model_.parameters()[jaw].maximum / 3;
    }
    foreign.q = before_.q;
    const Situation predicted = between(before_, after);
    std::vector<Observation> seen = observe(after, foreign, disturbance, fraction);
    for (int d = 0; d < kMethods; ++d) {
      std::vector<Observation> copy = seen;
      const bool predicts = d >= static_cast<int>(RejectionMethod::weights_predicted);
      const double error = solve(**estimators_[static_cast<std::size_t>(d)], predicts ? predicted : before_,
                                 after, copy, &sum->us[d]);
      sum->mean_px[d] += error;
      sum->fraction_over_3px[d] += error > 3;
    }
  }

 private:
  static Rejection rejection_of(RejectionMethod d) {
    switch (d) {
      case RejectionMethod::least_squares:
        return Rejection::none;
      case RejectionMethod::weights:
      case RejectionMethod::weights_predicted:
        return Rejection::weights;
      case RejectionMethod::forces:
        return Rejection::forces;
      case RejectionMethod::forces_predicted:
        return Rejection::forces_readmitted;
      case RejectionMethod::on_doubt:
        break;
    }
    return Rejection::on_doubt;
  }

  void choose_points(Estimator& e) {
    while (uv_.size() < kSurfacePoints) {
      const Vec2 uv{dice_.uniform(0.03f, 0.97f), dice_.uniform(0.03f, 0.97f)};
      std::uint16_t id;
      if (!model_.is_on_surface(uv) || e.add_point(uv, &id) != Status::ok) continue;
      if (e.predict(id).visible) uv_.push_back(uv);
      e.remove_point(id);
    }
  }

  Situation moved_from(const Situation& from, float far) {
    float step[kPoseUnknowns];
    const float sd[kPoseUnknowns] = {0.03f, 0.03f, 0.03f, 0.015f, 4 * far, 4 * far};
    for (int k = 0; k < kPoseUnknowns; ++k) step[k] = sd[k] * dice_.normal();
    Situation out{moved(from.view, step, kPoseUnknowns), from.q};
    for (std::size_t i = 0; i < out.q.size(); ++i) {
      const Parameter& p = model_.parameters()[i];
      if (p.group == Group::expression)
        out.q[i] = clamp(out.q[i] + 0.03f * (p.maximum - p.minimum) * dice_.normal(), p.minimum, p.maximum);
    }
    return out;
  }

  /// A state at a fraction 0.8 (standard deviation 0.1) of the motion from a to b.
  Situation between(const Situation& a, const Situation& b) {
    const Vec3 turn = log_rotation(b.view.q * conjugate(a.view.q));
    const auto part = [&] { return 0.8f + 0.1f * dice_.normal(); };
    const float step[kPoseUnknowns] = {part() * turn.x,
                                       part() * turn.y,
                                       part() * turn.z,
                                       part() * (b.view.s / a.view.s - 1),
                                       part() * (b.view.tau.x - a.view.tau.x),
                                       part() * (b.view.tau.y - a.view.tau.y)};
    Situation out{moved(a.view, step, kPoseUnknowns), a.q};
    for (std::size_t i = 0; i < out.q.size(); ++i) out.q[i] += part() * (b.q[i] - a.q[i]);
    return out;
  }

  Vec2 image_of(const Situation& s, std::size_t point) {
    Vec2 x{};
    (void)Projector(s.view, true).project(truth_->surface_point(uv_[point], s.q.data()), &x);
    return x;
  }

  std::vector<Observation> observe(const Situation& after, const Situation& foreign, Disturbance disturbance,
                                   double fraction) {
    const bool is_clean = disturbance == Disturbance::none || disturbance == Disturbance::expression;
    const Vec2 middle = image_of(before_, static_cast<std::size_t>(dice_.uniform(0, kSurfacePoints - 0.5f)));
    std::vector<std::pair<float, std::size_t>> order;
    for (std::size_t i = 0; i < kSurfacePoints; ++i)
      order.push_back(
          {disturbance == Disturbance::random ? dice_.uniform(0, 1) : length(image_of(before_, i) - middle),
           i});
    std::sort(order.begin(), order.end());
    std::vector<bool> is_false(kSurfacePoints, false);
    for (std::size_t k = 0; !is_clean && k < static_cast<std::size_t>(fraction * kSurfacePoints); ++k)
      is_false[order[k].second] = true;
    std::vector<Observation> out(kSurfacePoints);
    for (std::size_t i = 0; i < kSurfacePoints; ++i) {
      Vec2 x = image_of(after, i);
      if (is_false[i] && disturbance == Disturbance::random)
        x = x + Vec2{dice_.uniform(-12, 12), dice_.uniform(-12, 12)};
      if (is_false[i] && disturbance == Disturbance::moving) x = image_of(foreign, i);
      if (is_false[i] && disturbance == Disturbance::standing) x = image_of(before_, i);
      out[i].id = static_cast<std::uint16_t>(i);
      out[i].x = x + Vec2{kNoisePx * dice_.normal(), kNoisePx * dice_.normal()};
      const float w = 1 / (kNoisePx * kNoisePx);
      out[i].information = {w, 0, w};
    }
    return out;
  }

  double solve(Estimator& e, const Situation& from, const Situation& truth, std::vector<Observation>& seen,
               double* us) {
    e.begin(0);
    std::vector<float> q = from.q;
    State state;
    state.pose = pose_of(from.view);
    state.q = q.data();
    require(e.restore(state), "occlusion");
    const double start = process_ms();
    (void)e.solve({seen.data(), seen.size()});
    *us += 1e3 * (process_ms() - start);
    double sum = 0;
    for (std::size_t i = 0; i < kSurfacePoints; ++i) {
      Vec2 x{};
      (void)e.project(uv_[i], &x);
      sum += static_cast<double>(length(x - image_of(truth, i)));
    }
    return sum / kSurfacePoints;
  }

  const Model& model_;
  Dice& dice_;
  Owned<Cascade> truth_;
  Situation before_;
  std::vector<Vec2> uv_;
  std::vector<std::unique_ptr<Owned<Estimator>>> estimators_;
};

}  // namespace

const char* name_of(RejectionMethod method) {
  constexpr const char* kNames[kMethods] = {
      "least_squares",     "weights", "forces", "weights_predicted", "forces_predicted_readmitted",
      "on_doubt_predicted"};
  return kNames[static_cast<int>(method)];
}

OcclusionResult measure_occlusion(const Model& model, Disturbance disturbance, double fraction, int scenes,
                                  int trials_a_scene) {
  Dice dice;
  OcclusionResult result;
  for (int s = 0; s < scenes; ++s) {
    CoveredPerson person(model, dice);
    for (int t = 0; t < trials_a_scene; ++t) person.run(disturbance, fraction, &result);
  }
  const double n = static_cast<double>(scenes) * trials_a_scene;
  for (int d = 0; d < kMethods; ++d) {
    result.mean_px[d] /= n;
    result.fraction_over_3px[d] /= n;
    result.us[d] /= n;
  }
  return result;
}

}  // namespace pliant::host
