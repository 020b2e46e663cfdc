#include "host/render/morph.hpp"

#include <algorithm>

#include "host/render/shown_mesh.hpp"

namespace pliant::host {

namespace {

/// An expression whose weight stays below this in every frame counts as still. Below the resolution of 8-bit weights.
constexpr float kLeastWeight = 1e-4f;
/// Number of frames, evenly spread, at which the error is measured. Bounds the time.
constexpr std::size_t kMostMeasured = 200;

/// Value at the end of an expression's range: its maximum, or its minimum if the maximum is zero.
float range_of(const Parameter& p) {
  return p.maximum > 0 ? p.maximum : p.minimum;
}

float weight_of(const Model& model, const Morphs& morphs, const MorphTarget& target,
                const std::vector<float>& q) {
  const auto fraction = [&](std::size_t i) {
    const std::uint16_t k = morphs.parameters[i];
    const float range = range_of(model.parameters()[k]);
    return range != 0 ? q[k] / range : 0;
  };
  const float w = fraction(target.first);
  if (!target.is_corrective) return w;
  return target.first == target.second ? w * (1 - w) : w * fraction(target.second);
}

/// Displacements of positions and normals from rest.
class Poser {
 public:
  Poser(MorphSurface& surface, const Faces& faces, std::vector<float> rest)
      : surface_(surface), faces_(faces), rest_(std::move(rest)) {
    position_ = surface_.positions(rest_);
    normal_ = compute_normals(position_, faces_);
  }
  const std::vector<Vec3>& position() const { return position_; }
  const std::vector<Vec3>& normal() const { return normal_; }

  /// The displacement with these parameters at these fractions of their ranges.
  MorphTarget at(const std::vector<std::pair<std::uint16_t, float>>& fractions) {
    std::vector<float> q = rest_;
    for (const auto& [k, fraction] : fractions) q[k] = fraction * range_of(surface_.model().parameters()[k]);
    MorphTarget target;
    target.position = surface_.positions(q);
    target.normal = compute_normals(target.position, faces_);
    for (std::size_t v = 0; v < target.position.size(); ++v) {
      target.position[v] = target.position[v] - position_[v];
      target.normal[v] = target.normal[v] - normal_[v];
    }
    return target;
  }

 private:
  MorphSurface& surface_;
  const Faces& faces_;
  std::vector<float> rest_;
  std::vector<Vec3> position_, normal_;
};

void add(MorphTarget& to, float fraction, const MorphTarget& from) {
  for (std::size_t v = 0; v < to.position.size(); ++v) {
    to.position[v] = to.position[v] + fraction * from.position[v];
    to.normal[v] = to.normal[v] + fraction * from.normal[v];
  }
}

float reach(const MorphTarget& target) {
  float farthest = 0;
  for (const Vec3 d : target.position) farthest = max(farthest, dot(d, d));
  return square_root(farthest);
}

/// The second-order term of one or two expressions: what their own targets leave; without a name.
MorphTarget corrective(Poser& poser, const Morphs& morphs, std::size_t i, std::size_t j) {
  const std::uint16_t a = morphs.parameters[i], b = morphs.parameters[j];
  MorphTarget out = i == j ? poser.at({{a, 0.5f}}) : poser.at({{a, 1.0f}, {b, 1.0f}});
  add(out, i == j ? -0.5f : -1, morphs.targets[i]);
  if (i != j) add(out, -1, morphs.targets[j]);
  if (i == j) add(out, 3, MorphTarget(out));  // w (1 - w) is 1/4 at w = 1/2
  out.first = i;
  out.second = j;
  out.is_corrective = true;
  return out;
}

void add_correctives(Poser& poser, const Model& model, const std::vector<std::vector<float>>& frames,
                     float tolerance_mm, Morphs* morphs) {
  const std::size_t count = morphs->parameters.size();
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = i; j < count; ++j) {
      MorphTarget probe;
      probe.first = i;
      probe.second = j;
      probe.is_corrective = true;
      float largest = 0;
      for (const auto& q : frames) largest = max(largest, magnitude(weight_of(model, *morphs, probe, q)));
      if (largest < kLeastWeight) continue;
      MorphTarget target = corrective(poser, *morphs, i, j);
      if (!(largest * reach(target) > tolerance_mm)) continue;
      const std::string first = morphs->targets[i].name, second = morphs->targets[j].name;
      target.name = i == j ? first + "*(1-" + first + ")" : first + "*" + second;
      morphs->targets.push_back(std::move(target));
    }
}

MorphError measure(MorphSurface& surface, const Morphs& morphs, const std::vector<std::vector<float>>& frames,
                   std::size_t targets) {
  MorphError error;
  const std::size_t step = (frames.size() + kMostMeasured - 1) / kMostMeasured;
  std::size_t measured = 0;
  for (std::size_t f = 0; f < frames.size(); f += step) {
    const auto exact = surface.positions(frames[f]);
    const auto weights = morph_weights(surface.model(), morphs, frames[f]);
    for (std::size_t v = 0; v < exact.size(); ++v) {
      Vec3 p = morphs.position[v];
      for (std::size_t t = 0; t < targets; ++t) p = p + weights[t] * morphs.targets[t].position[v];
      const auto distance = static_cast<double>(length(p - exact[v]));
      error.mean_mm += distance;
      error.max_mm = std::max(error.max_mm, distance);
    }
    measured += exact.size();
  }
  error.mean_mm /= static_cast<double>(std::max<std::size_t>(measured, 1));
  return error;
}

}  // namespace

MorphSurface::MorphSurface(const Model& model, const std::vector<Vec2>& uv, const std::vector<float>& q)
    : cascade_(model), count_(uv.size()) {
  cascade_->set_free(Group::expression);
  const std::size_t stride = cascade_->samples_per_point();
  baked_.resize(count_ * stride);
  for (std::size_t v = 0; v < count_; ++v)
    cascade_->sample_point(uv[v], q.data(), baked_.data() + v * stride);
}

std::vector<Vec3> MorphSurface::positions(const std::vector<float>& q) {
  std::vector<Vec3> out;
  for (std::size_t v = 0; v < count_; ++v)
    out.push_back(cascade_->evaluate(baked_.data() + v * cascade_->samples_per_point(), q.data()));
  return out;
}

Morphs make_morphs(MorphSurface& surface, const Faces& faces, const std::vector<std::vector<float>>& frames,
                   const std::vector<std::uint16_t>& driven, float tolerance_mm) {
  const Model& model = surface.model();
  std::vector<float> rest = frames.front();
  for (std::size_t k = 0; k < rest.size(); ++k)
    if (model.parameters()[k].group == Group::expression) rest[k] = 0;
  Poser poser(surface, faces, rest);
  Morphs morphs;
  morphs.position = poser.position();
  morphs.normal = poser.normal();
  for (const std::uint16_t k : driven) {
    const Parameter& p = model.parameters()[k];
    const float least = kLeastWeight * magnitude(range_of(p));
    if (std::none_of(frames.begin(), frames.end(), [&](const auto& q) { return magnitude(q[k]) > least; }))
      continue;
    MorphTarget target = poser.at({{k, 1.0f}});
    target.name = p.name;
    target.first = target.second = morphs.parameters.size();
    morphs.parameters.push_back(k);
    morphs.targets.push_back(std::move(target));
  }
  morphs.linear = measure(surface, morphs, frames, morphs.targets.size());
  add_correctives(poser, model, frames, tolerance_mm, &morphs);
  morphs.all = measure(surface, morphs, frames, morphs.targets.size());
  return morphs;
}

std::vector<float> morph_weights(const Model& model, const Morphs& morphs, const std::vector<float>& q) {
  std::vector<float> weights;
  for (const MorphTarget& target : morphs.targets) weights.push_back(weight_of(model, morphs, target, q));
  return weights;
}

}  // namespace pliant::host
