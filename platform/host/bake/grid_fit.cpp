// Minimises |A (T + d) - V|^2 + mu |L d|^2 over the correction d by conjugate gradients. T are the samples, A takes bilinear
// values at the places, V are the mesh's values there, L is the Laplacian of the grid.
#include "host/bake/grid_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "host/bake/at.hpp"

namespace pliant::host::bake {

namespace {

/// Tuning of the least-squares fit of a grid. Each constant: unit, reason, experiment.
struct GridFitTuning {
  /// Conjugate-gradient iterations, count. Bounds the time. Round value, not tuned.
  int iterations = 24;
  /// The iteration stops at this fraction of the first squared residual, i.e. at a hundredth of the residual: below the
  /// quantisation of a sample.
  float residual_fraction = 1e-4f;
  /// Weight mu of the squared Laplacian, no unit. Determines the samples that no data point depends on. Small compared with the
  /// data term, whose weights add up to 1 a data point. Not tuned further.
  float smoothness = 0.02f;
};
constexpr GridFitTuning kTuning{};

class GridFit {
 public:
  GridFit(int width, int height, const std::vector<FitPlace>& places) : width_(width), height_(height) {
    for (const FitPlace& p : places) {
      const float x = p.uv.x * static_cast<float>(width - 1), y = p.uv.y * static_cast<float>(height - 1);
      const int i = std::min(static_cast<int>(x), width - 2), j = std::min(static_cast<int>(y), height - 2);
      const float a = x - static_cast<float>(i), b = y - static_cast<float>(j);
      cells_.push_back({at(j * width + i), a, b, {(1 - a) * (1 - b), a * (1 - b), (1 - a) * b, a * b}});
    }
  }

  /// The correction of the grid for these differences at the places (mesh minus grid).
  std::vector<float> solve(const std::vector<float>& differences) const {
    std::vector<float> d(at(width_ * height_), 0.0f), residual = gather(differences), step = residual;
    float norm = dot_product(residual, residual);
    const float enough = kTuning.residual_fraction * norm;
    for (int round = 0; round < kTuning.iterations && norm > enough; ++round) {
      const std::vector<float> image = normal_matrix_times(step);
      const float length = norm / std::max(1e-30f, dot_product(step, image));
      for (std::size_t k = 0; k < d.size(); ++k) {
        d[k] += length * step[k];
        residual[k] -= length * image[k];
      }
      const float next = dot_product(residual, residual);
      for (std::size_t k = 0; k < d.size(); ++k) step[k] = residual[k] + next / norm * step[k];
      norm = next;
    }
    return d;
  }

  std::vector<float> values_of(const std::vector<float>& grid) const {
    std::vector<float> values;
    values.reserve(cells_.size());
    for (const Cell& c : cells_) values.push_back(value(c, grid));
    return values;
  }

 private:
  struct Cell {
    std::size_t first;  // its sample with the lowest indices
    float a, b;
    std::array<float, 4> weights;  // of its samples, row by row
  };
  static float dot_product(const std::vector<float>& x, const std::vector<float>& y) {
    double sum = 0;
    for (std::size_t k = 0; k < x.size(); ++k) sum += static_cast<double>(x[k] * y[k]);
    return static_cast<float>(sum);
  }

  float value(const Cell& c, const std::vector<float>& grid) const {
    const float *upper = &grid[c.first], *lower = upper + width_;
    const float top = upper[0] + c.a * (upper[1] - upper[0]);
    return top + c.b * (lower[0] + c.a * (lower[1] - lower[0]) - top);
  }
  void add_to(std::vector<float>& grid, const Cell& c, float value) const {
    float *upper = &grid[c.first], *lower = upper + width_;
    upper[0] += c.weights[0] * value;
    upper[1] += c.weights[1] * value;
    lower[0] += c.weights[2] * value;
    lower[1] += c.weights[3] * value;
  }

  /// The transpose of values_of.
  std::vector<float> gather(const std::vector<float>& values) const {
    std::vector<float> grid(at(width_ * height_), 0.0f);
    for (std::size_t k = 0; k < cells_.size(); ++k) add_to(grid, cells_[k], values[k]);
    return grid;
  }

  /// Sum of the differences to the four neighbours; neighbours outside the grid are left out, which keeps the matrix symmetric.
  std::vector<float> laplacian(const std::vector<float>& grid) const {
    std::vector<float> result(grid.size());
    for (int j = 0; j < height_; ++j) {
      const float* row = &grid[at(j * width_)];
      const float *above = j > 0 ? row - width_ : row, *below = j + 1 < height_ ? row + width_ : row;
      float* sums = &result[at(j * width_)];
      const auto sum = [&](int i, int left, int right) {
        sums[i] = (above[i] - row[i]) + (row[left] - row[i]) + (row[right] - row[i]) + (below[i] - row[i]);
      };
      sum(0, 0, 1);
      for (int i = 1; i + 1 < width_; ++i) sum(i, i - 1, i + 1);
      sum(width_ - 1, width_ - 2, width_ - 1);
    }
    return result;
  }

  std::vector<float> normal_matrix_times(const std::vector<float>& x) const {
    std::vector<float> result(x.size(), 0.0f);
    for (const Cell& c : cells_) add_to(result, c, value(c, x));
    const std::vector<float> smooth = laplacian(laplacian(x));
    for (std::size_t k = 0; k < result.size(); ++k) result[k] += kTuning.smoothness * smooth[k];
    return result;
  }

  const int width_, height_;
  std::vector<Cell> cells_;
};

void fit_component(FieldGrid& grid, int component, const GridFit& fit, const std::vector<float>& wanted,
                   float threshold) {
  const std::size_t n = at(grid.components);
  std::vector<float> samples;
  samples.reserve(grid.samples.size() / n);
  for (std::size_t k = at(component); k < grid.samples.size(); k += n) samples.push_back(grid.samples[k]);
  std::vector<float> differences = fit.values_of(samples);
  for (std::size_t k = 0; k < differences.size(); ++k) differences[k] = wanted[k] - differences[k];
  const std::vector<float> correction = fit.solve(differences);
  for (std::size_t k = 0; k < samples.size(); ++k)
    if (samples[k] != 0 || std::fabs(correction[k]) > threshold)
      grid.samples[k * n + at(component)] += correction[k];
}

}  // namespace

std::vector<FitPlace> fit_places(const std::vector<Vec2>& uv,
                                 const std::vector<std::array<int, 3>>& triangles,
                                 const std::vector<char>& is_hole, int side) {
  std::vector<FitPlace> places;
  std::vector<char> seen(uv.size(), 0);
  const std::vector<float> areas = chart_areas(uv, triangles);
  const float cell = 1 / static_cast<float>(side * side);
  for (std::size_t f = 0; f < triangles.size(); ++f) {
    if (is_hole[f]) continue;
    const auto& t = triangles[f];
    constexpr float kThird = 1.0f / 3;
    if (magnitude(areas[f]) > cell)
      places.push_back({kThird * (uv[at(t[0])] + uv[at(t[1])] + uv[at(t[2])]),
                        {t, {kThird, kThird, kThird}, static_cast<int>(f)}});
    for (int v : t)
      if (!seen[at(v)]) {
        seen[at(v)] = 1;
        places.push_back({uv[at(v)], {{v, v, v}, {1, 0, 0}, static_cast<int>(f)}});
      }
  }
  return places;
}

void fit_grid(FieldGrid& grid, const std::vector<FitPlace>& places, const std::vector<Vec3>& values,
              float threshold) {
  const GridFit fit(grid.width, grid.height, places);
  for (int c = 0; c < 3; ++c) {
    std::vector<float> wanted;
    for (const FitPlace& p : places) {
      const Vec3 v = value_at(p.source, values);
      wanted.push_back(c == 0 ? v.x : c == 1 ? v.y : v.z);
    }
    fit_component(grid, c, fit, wanted, threshold);
  }
}

void fit_grid(FieldGrid& grid, const std::vector<FitPlace>& places, const std::vector<float>& values,
              float threshold) {
  const GridFit fit(grid.width, grid.height, places);
  std::vector<float> wanted;
  for (const FitPlace& p : places) wanted.push_back(value_at(p.source, values));
  fit_component(grid, 0, fit, wanted, threshold);
}

}  // namespace pliant::host::bake
