#pragma once
// Random models: every operation, composed as a directed acyclic graph in table order, over fields of every kind.
#include <array>

#include "open_model.hpp"
#include "random.hpp"

class RandomModel {
 public:
  explicit RandomModel(Random& random) : random_(random) {}

  ModelBuilder run() {
    for (int k = 0, n = 4 + random_.below(6); k < n; ++k)
      b_.parameter("q" + std::to_string(k), k % 2 == 0 ? pliant::Group::identity : pliant::Group::expression,
                   -1, 1, 0.5f);
    b_.record(pliant::Operation::constant, {}, {}, field(3, 60));
    for (int k = 0, n = 3 + random_.below(20); k < n; ++k) add_record();
    b_.grid_mesh(2);
    return b_;
  }

 private:
  std::uint16_t field(int components, float size) {
    std::array<float, 9> a;
    for (float& x : a) x = size * random_.uniform(-1, 1);
    float u0 = 0, v0 = 0, u1 = 1, v1 = 1;
    const bool whole = random_.below(2) == 0;
    if (!whole) {
      u0 = random_.uniform(0.05f, 0.4f);
      v0 = random_.uniform(0.05f, 0.4f);
      u1 = random_.uniform(0.6f, 0.95f);
      v1 = random_.uniform(0.6f, 0.95f);
    }
    const auto value = [=](float u, float v) {
      const float s = (u - u0) / (u1 - u0), t = (v - v0) / (v1 - v0);
      const float rim = whole ? 1 : pliant::max(0.0f, 16 * s * (1 - s) * t * (1 - t));
      return rim * pliant::Vec3{a[0] + a[1] * u * v + a[2] * v * v, a[3] * u + a[4] * v + a[5] * u * u * v,
                                a[6] * (u - v) + a[7] * u * u + a[8]};
    };
    const int width = 3 + random_.below(12), height = 3 + random_.below(12);
    return b_.field(components, width, height, value, u0, v0, u1, v1, random_.below(3) == 0,
                    random_.below(3) == 0 ? 8 : 16);
  }

  std::uint16_t any_parameter() {
    return static_cast<std::uint16_t>(random_.below(static_cast<int>(b_.parameters.size())));
  }
  std::uint16_t any_source() {
    const int count = static_cast<int>(b_.cascade.size());
    return static_cast<std::uint16_t>(random_.below(3) > 0 ? count - 1 : random_.below(count));
  }

  void add_record() {
    using pliant::Operation;
    const auto operation = static_cast<Operation>(random_.below(9));
    std::vector<std::uint16_t> sources, q;
    std::uint16_t vectors = pliant::kNone, weight = pliant::kNone;
    if (operation != Operation::constant) sources.push_back(any_source());
    if (operation == Operation::lerp) {
      const std::uint16_t other = any_source();
      if (other == sources[0]) return;
      sources.push_back(other);
    }
    if (operation <= Operation::one_sided)
      vectors = field(3, operation == Operation::constant ? 60.0f : 10.0f);
    else if (random_.below(3) > 0)
      weight = field(1, 0.7f);
    const int parameters = operation == Operation::constant  ? 0
                           : operation == Operation::product ? 2
                           : operation == Operation::rigid   ? 6
                                                             : 1;
    for (int k = 0; k < parameters; ++k) q.push_back(any_parameter());
    pliant::CascadeRecord& r = b_.record(operation, sources, q, vectors, weight);
    const pliant::Vec3 axis = pliant::normalised(pliant::Vec3{random_.normal(), random_.normal(), 1});
    if (operation == Operation::rotate) r.axis[0] = axis.x, r.axis[1] = axis.y, r.axis[2] = axis.z;
    if (operation == Operation::one_sided) r.axis[0] = 0.3f;
    for (float& c : r.pivot) c = random_.uniform(-20, 20);
    if (operation == Operation::affine)
      for (int k = 0; k < 12; ++k)
        r.matrix[k] = (k < 9 && k % 4 == 0 ? 1.0f : 0.0f) + (k < 9 ? 0.2f : 5.0f) * random_.uniform(-1, 1);
  }

  Random& random_;
  ModelBuilder b_;
};

inline std::vector<float> random_q(const pliant::Model& model, Random& random) {
  std::vector<float> q;
  for (const pliant::Parameter& p : model.parameters()) q.push_back(random.uniform(p.minimum, p.maximum));
  return q;
}
