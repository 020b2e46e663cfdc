#include "host/bake/reconstruction.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "host/bake/at.hpp"
#include "host/io/owned.hpp"
#include "pliant/cascade.hpp"

namespace pliant::host::bake {

std::vector<std::size_t> surface_vertices(const Source& source) {
  std::vector<char> is_used(source.uv.size(), 0);
  for (std::size_t f = 0; f < source.triangles.size(); ++f)
    if (!source.is_hole[f])
      for (const int v : source.triangles[f]) is_used[at(v)] = 1;
  std::vector<std::size_t> result;
  for (std::size_t v = 0; v < is_used.size(); ++v)
    if (is_used[v]) result.push_back(v);
  return result;
}

namespace {

/// The shapes that a parameter moves when the others are at zero.
std::vector<const SourceShape*> shapes_of(const Source& source, std::size_t parameter) {
  std::vector<const SourceShape*> result;
  for (const SourceShape& shape : source.shapes)
    if (shape.parameter == parameter && (shape.second < 0 || at(shape.second) == parameter))
      result.push_back(&shape);
  return result;
}

/// A vertex of the source with one parameter at x, the others at zero.
/// \param shapes  shapes_of this parameter.
Vec3 moved(const Source& source, std::size_t vertex, const std::vector<const SourceShape*>& shapes, float x) {
  Vec3 p = source.neutral[vertex];
  for (const SourceShape* shape : shapes) {
    if (shape->weight.empty()) {
      p = p + (shape->second >= 0 ? x * x : x) * shape->displacement[vertex];
      continue;
    }
    const float angle = x * shape->weight[vertex], cosine = std::cos(angle), sine = std::sin(angle);
    const Vec3 arm = p - shape->pivot;  // Rodrigues
    p = shape->pivot + cosine * arm + sine * cross(shape->axis, arm) +
        ((1 - cosine) * dot(shape->axis, arm)) * shape->axis;
  }
  return p;
}

Distances distances(std::vector<float> off) {
  if (off.empty()) return {};
  const double sum = std::accumulate(off.begin(), off.end(), 0.0);
  Distances d;
  d.mean_mm = static_cast<float>(sum / static_cast<double>(off.size()));
  d.max_mm = *std::max_element(off.begin(), off.end());
  const auto p95 = off.begin() + static_cast<std::ptrdiff_t>(off.size() * 95 / 100);
  std::nth_element(off.begin(), p95, off.end());
  d.p95_mm = *p95;
  return d;
}

/// Parameters whose shapes have samples of their own.
std::vector<std::size_t> measured_parameters(const Source& source) {
  std::vector<std::size_t> result;
  for (std::size_t k = 0; k < source.parameters.size(); ++k)
    if (std::none_of(source.shapes.begin(), source.shapes.end(),
                     [k](const SourceShape& s) { return s.parameter == k && s.mirror_of >= 0; }))
      result.push_back(k);
  return result;
}

}  // namespace

Reconstruction reconstruct(const Model& model, const Source& source) {
  Owned<Cascade> cascade(model);
  Reconstruction result;
  const std::vector<std::size_t> measured = measured_parameters(source);
  std::vector<std::vector<const SourceShape*>> shapes;
  for (const std::size_t k : measured) shapes.push_back(shapes_of(source, k));
  std::vector<std::vector<float>> off(measured.size());
  std::vector<float> rest, q(source.parameters.size(), 0.0f);
  std::vector<Vec3> baked(cascade->samples_per_point());
  for (const std::size_t v : surface_vertices(source)) {
    cascade->sample_point(source.uv[v], q.data(), baked.data());
    rest.push_back(length(cascade->evaluate(baked.data(), q.data()) - source.neutral[v]));
    for (std::size_t m = 0; m < measured.size(); ++m) {
      const std::size_t k = measured[m];
      const SourceParameter& p = source.parameters[k];
      const float farthest = p.farthest();
      q[k] = p.group == Group::identity ? std::clamp(farthest, -p.sd, p.sd) : farthest;
      off[m].push_back(length(cascade->evaluate(baked.data(), q.data()) - moved(source, v, shapes[m], q[k])));
      q[k] = 0;
    }
  }
  result.rest = distances(std::move(rest));
  std::vector<float> all[2];
  for (std::size_t m = 0; m < measured.size(); ++m) {
    const SourceParameter& p = source.parameters[measured[m]];
    std::vector<float>& of_group = all[p.group == Group::identity ? 0 : 1];
    of_group.insert(of_group.end(), off[m].begin(), off[m].end());
    result.parameters.push_back({p.name, p.group, distances(std::move(off[m]))});
  }
  result.identity = distances(std::move(all[0]));
  result.expression = distances(std::move(all[1]));
  return result;
}

}  // namespace pliant::host::bake
