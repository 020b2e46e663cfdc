// Contour error (the paper, 5.2.3, Eq. 5-7; docs/algorithms.md, section 2.3). In the mean of samples with equal weights the
// triangle's area cancels. Samples are barycentric, so a triangle's error does not depend on its place in the chart.
#include "mesh/triangle_samples.hpp"
#include "pliant/criteria.hpp"

namespace pliant {
namespace {

struct Corners {
  Vec2 uv[3];
  Vec3 p[3];
};

Corners corners_of(const Shape& s, const Triangle& t) {
  Corners c;
  for (int k = 0; k < 3; ++k) {
    c.uv[k] = s.mesh.uv(t.corner[k]);
    c.p[k] = s.position[t.corner[k]];
  }
  return c;
}

// Eq. 5 at barycentric coordinates (a, b, c).
float error_at(const Surface& surface, const Corners& t, float a, float b, float c) {
  const Vec3 flat = a * t.p[0] + b * t.p[1] + c * t.p[2];
  return length(surface(a * t.uv[0] + b * t.uv[1] + c * t.uv[2]) - flat);
}

float area_of(const Corners& t) {
  return 0.5f * length(cross(t.p[1] - t.p[0], t.p[2] - t.p[0]));
}

}  // namespace

ContourError measure_contour(const Shape& shape, const Triangle& triangle) {
  const Corners t = corners_of(shape, triangle);
  ContourError e;
  float sum = 0;
  for (int i = 0; i < kSamples; ++i) {
    const float* w = kTriangleSamples[i];
    const float error = error_at(shape.surface, t, w[0], w[1], w[2]);
    if (i < kInnerSamples) sum += error;
    e.max_mm = max(e.max_mm, error);
  }
  e.mean_mm = sum / kInnerSamples;
  e.area_mm2 = area_of(t);
  return e;
}

ContourError measure_contour(const Shape& shape, const Triangle& triangle, int cells) {
  const int n = cells < 1 ? 1 : cells > 64 ? 64 : cells;
  const Corners t = corners_of(shape, triangle);
  const float step = 1.0f / static_cast<float>(3 * n);
  ContourError e;
  float sum = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n - i; ++j)
      for (int down = 0; down < (i + j < n - 1 ? 2 : 1);
           ++down) {  // the upright cell, and the inverted one next to it
        const float b = static_cast<float>(3 * i + 1 + down) * step,
                    c = static_cast<float>(3 * j + 1 + down) * step;
        const float error = error_at(shape.surface, t, 1 - b - c, b, c);
        sum += error;
        e.max_mm = max(e.max_mm, error);
      }
  e.mean_mm = sum / static_cast<float>(n * n);
  e.area_mm2 = area_of(t);
  return e;
}

ContourError compute_contour_error(const Shape& shape, int cells) {
  ContourError whole;
  float volume = 0;
  for (const FaceId f : shape.mesh.faces()) {
    const ContourError e = measure_contour(shape, shape.mesh.triangle(f), cells);
    volume += e.mean_mm * e.area_mm2;
    whole.area_mm2 += e.area_mm2;
    whole.max_mm = max(whole.max_mm, e.max_mm);
  }
  whole.mean_mm = whole.area_mm2 > 0 ? volume / whole.area_mm2 : 0;
  return whole;
}

float compute_rank(const ContourOptions& options, const Shape& shape, const Triangle& triangle) {
  const ContourError e = measure_contour(shape, triangle);
  float rank = 0;
  if (options.mean_mm > 0) rank = max(rank, e.mean_mm / options.mean_mm);
  if (options.max_mm > 0) rank = max(rank, e.max_mm / options.max_mm);
  if (options.volume_mm3 > 0) rank = max(rank, e.mean_mm * e.area_mm2 / options.volume_mm3);
  return rank;
}

Criterion criterion_of(const ContourOptions& options) {
  return criterion_of<ContourOptions, compute_rank>(options);
}

}  // namespace pliant
