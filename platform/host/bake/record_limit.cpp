#include "host/bake/record_limit.hpp"

#include <algorithm>
#include <utility>

#include "host/bake/at.hpp"

namespace pliant::host::bake {

namespace {

/// Sum of the squared motions of the vertices at one standard deviation of both parameters.
double size_of(const Source& source, const SourceShape& correction) {
  double sum = 0;
  for (const Vec3 d : correction.displacement) sum += static_cast<double>(dot(d, d));
  const double sd = static_cast<double>(source.parameters[correction.parameter].sd) *
                    static_cast<double>(source.parameters[at(correction.second)].sd);
  return sd * sd * sum;
}

}  // namespace

void leave_out_corrections(Source& source) {
  if (source.shapes.size() <= kMostShapes) return;
  std::vector<std::pair<double, std::size_t>> corrections;  // size, and index among the shapes
  for (std::size_t k = 0; k < source.shapes.size(); ++k)
    if (source.shapes[k].second >= 0) corrections.push_back({size_of(source, source.shapes[k]), k});
  std::sort(corrections.begin(), corrections.end());
  const std::size_t count = std::min(corrections.size(), source.shapes.size() - kMostShapes);
  if (count == 0) return;
  std::vector<char> is_left_out(source.shapes.size(), 0);
  for (std::size_t k = 0; k < count; ++k) is_left_out[corrections[k].second] = 1;
  std::vector<SourceShape> kept;
  std::vector<int> index_now;
  for (std::size_t k = 0; k < source.shapes.size(); ++k) {
    index_now.push_back(static_cast<int>(kept.size()));
    if (is_left_out[k]) continue;
    kept.push_back(std::move(source.shapes[k]));
    int& original = kept.back().mirror_of;
    if (original >= 0) original = index_now[at(original)];
  }
  source.shapes = std::move(kept);
  source.warnings.push_back(
      "left out the " + std::to_string(count) + " smallest of " + std::to_string(corrections.size()) +
      " corrective shapes of the bending modes: a table holds " + std::to_string(kMostShapes) +
      " shapes. Fewer --modes or a larger --stiffness need fewer");
}

}  // namespace pliant::host::bake
