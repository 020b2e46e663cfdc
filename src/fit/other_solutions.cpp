#include "fit/other_solutions.hpp"

#include "base/arrays.hpp"
#include "fit/fit_tuning.hpp"
#include "model/parameters.hpp"

namespace pliant {

namespace {

constexpr const OtherSolutionTuning& kTuning = kOtherSolutionTuning;

/// Of the surface as a whole, model's axes.
Vec3 mean_normal(const Model& model, const Vec3* position) {
  const Span<const std::uint16_t> corners = model.base_corners();
  Vec3 sum;
  for (std::size_t c = 0; c < corners.count; c += 3) {
    const Vec3 p = position[corners[c]];
    sum = sum + cross(position[corners[c + 1]] - p, position[corners[c + 2]] - p);
  }
  return normalised(sum);
}

/// Standard deviation of the points across the plane that they are nearest to, over that along it.
float relief_of(const FitProblem& problem, const float* q) {
  const auto count = static_cast<float>(problem.points.count);
  Vec3 mean;
  for (std::size_t i = 0; i < problem.points.count; ++i) mean = mean + (1 / count) * problem.position(i, q);
  float xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;
  for (std::size_t i = 0; i < problem.points.count; ++i) {
    const Vec3 d = problem.position(i, q) - mean;
    xx += d.x * d.x, yy += d.y * d.y, zz += d.z * d.z;
    xy += d.x * d.y, xz += d.x * d.z, yz += d.y * d.z;
  }
  // The least eigenvalue, where it is small, is the product of all over the sum of the products of two.
  const float of_two = xx * yy - xy * xy + xx * zz - xz * xz + yy * zz - yz * yz;
  const float of_all = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
  return of_two > 0 ? square_root(of_all / (of_two * (xx + yy + zz))) : 0.0f;
}

/// Whether the points leave room for another solution. \param cost  robust.
bool is_doubtful(const FitProblem& problem, float cost, const float* start_q) {
  const std::size_t count = problem.points.count;
  return cost > kTuning.good_cost * static_cast<float>(count) ||
         relief_of(problem, start_q) < kTuning.most_relief ||
         (count <= kTuning.few_points && count_of(Group::identity, problem.work.cascade.model()) == 0);
}

/// The rotation, in the camera's axes, that tilts a surface of this normal as far to the other side.
Quat tilt_back(Vec3 normal) {
  const Vec3 n = normal.z > 0 ? -1 * normal : normal;  // the side that faces the camera
  const Quat half = normalised(Quat{1 - n.z, -n.y, n.x, 0});
  return half * half;
}

/// The view turned in the camera's axes. The mean of the points on the model keeps its place.
View turned(const FitProblem& problem, const View& view, Quat by) {
  Vec3 mean;
  for (std::size_t i = 0; i < problem.points.count; ++i) mean = mean + problem.position(i, problem.q);
  mean = (1.0f / static_cast<float>(problem.points.count)) * mean;
  View out = view;
  out.q = normalised(by * view.q);
  const Vec3 off = Projector(view, true).rotated(mean) - Projector(out, true).rotated(mean);
  out.tau = {view.tau.x + off.x, view.tau.y + off.y};
  return out;
}

void renew_scale(FitProblem& problem) {
  if (problem.options.robust) problem.update_scale();
}

float robust_cost(FitProblem& problem) {
  renew_scale(problem);
  return problem.cost(problem.q, problem.view);
}

}  // namespace

void OtherSolutions::lay_out(Arena& arena, const Model& model) {
  parameters_ = model.parameters().count;
  start_q_ = arena.take<float>(parameters_);
  first_q_ = arena.take<float>(parameters_);
  best_q_ = arena.take<float>(parameters_);
}

void OtherSolutions::start(const float* q) {
  copy(q, parameters_, start_q_);
}

/// The k-th other state: the other tilt, with the same shape or with the opposite one; then tilts with the shape of the start.
void OtherSolutions::set_state(FitProblem& problem, const View& first, Vec3 normal, int k) const {
  copy(k == 0 ? first_q_ : start_q_, parameters_, problem.q);
  for (std::size_t c = 0; k == 1 && c < problem.columns(); ++c) {
    const std::uint16_t p = problem.work.cascade.parameter_of(c);
    problem.q[p] =
        stepped(problem.work.cascade.model().parameters()[p], start_q_[p], start_q_[p] - first_q_[p]);
  }
  const float tilt = k % 2 == 0 ? kTuning.tilt_rad : -kTuning.tilt_rad;
  const Quat by = k < 2 ? tilt_back(Projector(first, true).rotated(normal))
                        : exp_rotation(k < 4 ? Vec3{tilt, 0, 0} : Vec3{0, tilt, 0});
  problem.view = turned(problem, first, by);
}

bool OtherSolutions::find_better(FitProblem& problem, FoldOverGuard& shapes) {
  if (problem.options.method != FitMethod::gauss_newton) return false;
  const View first = problem.view;
  const Loss loss = problem.loss;
  const float scale = problem.scale;
  problem.loss = problem.options.robust ? Loss::huber : Loss::squares;
  const float at_first = robust_cost(problem);
  View best = first;
  bool is_found = false;
  if (is_doubtful(problem, at_first, start_q_)) {
    shapes.see(problem.q);
    const Vec3 normal = mean_normal(problem.work.cascade.model(), shapes.positions());
    float least = kTuning.clearly_better * at_first;
    copy(problem.q, parameters_, first_q_);
    copy(problem.q, parameters_, best_q_);
    for (int k = 0; k < kTuning.states; ++k) {
      set_state(problem, first, normal, k);
      renew_scale(problem);  // wide at first
      problem.minimise(kTuning.iterations);
      const float cost = robust_cost(problem);
      if (!(cost < least)) continue;
      is_found = true;
      least = cost;
      best = problem.view;
      copy(problem.q, parameters_, best_q_);
    }
    copy(best_q_, parameters_, problem.q);
  }
  problem.view = best;
  problem.loss = loss;
  problem.scale = scale;
  return is_found;
}

}  // namespace pliant
