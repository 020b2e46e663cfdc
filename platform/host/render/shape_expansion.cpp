#include "host/render/shape_expansion.hpp"

#include <algorithm>

#include "host/io/bounding_box.hpp"
#include "host/io/owned.hpp"
#include "pliant/cascade.hpp"

namespace pliant::host {

namespace {

/// Movement below which a term is left out, as a fraction of the model's size: 0.1 mm of a face. Not seen in a picture.
constexpr float kLeastMove = 1.0f / 2000;
/// Where terms are fitted, standard deviations: most values of a parameter are within.
constexpr float kReach = 2;

/// Whether a record adds its vector and nothing else: parameters of such records do not act on each other's movement.
bool only_adds(const CascadeRecord& record) {
  return record.operation == Operation::constant || record.operation == Operation::add_vector;
}

std::vector<bool> parameters_that_only_add(const Model& model) {
  std::vector<bool> adds(model.parameters().count, true);
  for (const CascadeRecord& record : model.cascade())
    for (const std::uint16_t k : record.parameter)
      if (k != kNone && !only_adds(record)) adds[k] = false;
  return adds;
}

/// Evaluates the model at the points, with one or two parameters that are not 0.
class Probe {
 public:
  Probe(const Model& model, const std::vector<Vec2>& uv)
      : cascade_(model), uv_(uv), q_(model.parameters().count, 0.0f) {
    neutral_ = at(q_);
  }
  const std::vector<Vec3>& neutral() const { return neutral_; }
  std::vector<Vec3> at(const std::vector<std::pair<std::size_t, float>>& values) {
    for (const auto& [k, value] : values) q_[k] = value;
    auto out = at(q_);
    for (const auto& [k, value] : values) q_[k] = 0;
    return out;
  }
  std::vector<Vec3> at(const std::vector<float>& q) {
    std::vector<Vec3> out;
    cascade_->select(q.data());
    for (const Vec2 uv : uv_) out.push_back(cascade_->selected_point(uv));
    return out;
  }
  /// Movement from the neutral shape.
  std::vector<Vec3> moves(const std::vector<std::pair<std::size_t, float>>& values) {
    auto out = at(values);
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = out[i] - neutral_[i];
    return out;
  }

 private:
  Owned<Cascade> cascade_;
  const std::vector<Vec2>& uv_;
  std::vector<float> q_;
  std::vector<Vec3> neutral_;
};

/// The value up to which a parameter's terms are fitted: to the side on which there is more room.
float reach_of(const Parameter& p) {
  const float reach = kReach * p.sd;
  return p.maximum >= -p.minimum ? std::min(reach, p.maximum) : -std::min(reach, -p.minimum);
}

float largest(const std::vector<Vec3>& moves) {
  float most = 0;
  for (const Vec3 m : moves) most = max(most, length(m));
  return most;
}

float size_of(const std::vector<Vec3>& points) {
  return length(BoundingBox<Vec3>(points).size());
}

/// Sums of `a` and `b` with these factors.
std::vector<Vec3> mixed(float fa, const std::vector<Vec3>& a, float fb, const std::vector<Vec3>& b) {
  std::vector<Vec3> out(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) out[i] = fa * a[i] + fb * b[i];
  return out;
}

}  // namespace

ShapeExpansion expand_shape(const Model& model, const std::vector<Vec2>& uv, const std::vector<float>& q) {
  Probe probe(model, uv);
  ShapeExpansion out{probe.at(q), {}};
  const std::vector<bool> adds = parameters_that_only_add(model);
  const float least = kLeastMove * size_of(probe.neutral());
  // `reached`: the largest factor of the term.
  const auto keep = [&](std::size_t a, std::size_t b, float reached, std::vector<Vec3> move) {
    if (!(magnitude(reached) * largest(move) > least)) return;
    out.terms.push_back({static_cast<std::uint16_t>(a), static_cast<std::uint16_t>(b), std::move(move)});
  };
  const std::size_t count = model.parameters().count;
  std::vector<float> reach;
  std::vector<std::vector<Vec3>> whole;  // movement at the reach of each parameter
  for (std::size_t a = 0; a < count; ++a) {
    reach.push_back(reach_of(model.parameters()[a]));
    whole.push_back(probe.moves({{a, reach[a]}}));
    const float h = reach[a];
    if (h == 0) continue;
    // p(h) = h L + h^2 Q and p(h/2) = h/2 L + h^2/4 Q.
    const auto half = adds[a] ? mixed(0.5f, whole[a], 0, whole[a]) : probe.moves({{a, 0.5f * h}});
    keep(a, kNone, h, mixed(4 / h, half, -1 / h, whole[a]));
    if (!adds[a]) keep(a, a, h * h, mixed(2 / (h * h), whole[a], -4 / (h * h), half));
    for (std::size_t b = 0; b < a; ++b) {
      const float both = h * reach[b];
      if ((adds[a] && adds[b]) || both == 0) continue;
      const auto alone = mixed(1, whole[a], 1, whole[b]);
      keep(a, b, both, mixed(1 / both, probe.moves({{a, h}, {b, reach[b]}}), -1 / both, alone));
    }
  }
  return out;
}

}  // namespace pliant::host
