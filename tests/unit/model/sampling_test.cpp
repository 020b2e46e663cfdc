// Sampling of a field between its samples: what each interpolation reproduces, its gradient, where it is smooth, and the
// rims of the support.
#include <doctest/doctest.h>

#include <vector>

#include "field_reference.hpp"
#include "model/field_sampling.hpp"
#include "random_model.hpp"

namespace sampling_test {

using namespace pliant;

namespace {

constexpr Interpolation kBoth[] = {Interpolation::bilinear, Interpolation::bicubic};

/// A model whose field 1 is `f` on a grid of w x h over a rectangle.
OpenModel with_field(const ModelBuilder::Function& f, int w, int h, float u0 = 0, float v0 = 0, float u1 = 1,
                     float v1 = 1, bool mirror = false, int bits = 16) {
  ModelBuilder b;
  b.record(Operation::constant, {}, {}, b.field(3, 3, 3, [](float u, float v) { return Vec3{u, v, 0}; }));
  b.parameter("q", Group::expression, -1, 1, 1);
  b.record(Operation::add_vector, {0}, {0}, b.field(3, w, h, f, u0, v0, u1, v1, mirror, bits));
  b.grid_mesh(2);
  return OpenModel(b);
}

/// Its samples, not the function that they came from: what quantisation left.
Vec3 at_sample(const OpenModel& m, int i, int j) {
  const Field& f = m.model.fields()[1];
  return sample(m.model, f,
                {static_cast<float>(i) / static_cast<float>(f.width - 1),
                 static_cast<float>(j) / static_cast<float>(f.height - 1)});
}

}  // namespace

TEST_CASE("bilinear sampling reproduces a bilinear field and its gradient, and is zero outside its support") {
  ModelBuilder b = egg_model(1);
  const auto f = b.field(
      3, 9, 7,
      [](float u, float v) {
        return Vec3{3 * u - v, 2 + u * v, v};
      },
      0.25f, 0.5f, 0.75f, 1);
  const OpenModel r(b);
  const Field& field = r.model.fields()[f];
  Random random(1);
  for (int i = 0; i < 500; ++i) {
    const Vec2 uv{random.uniform(0, 1), random.uniform(0, 1)};
    Vec3 du, dv;
    const Vec3 p = sample_with_gradient(r.model, field, uv, &du, &dv);
    if (uv.x < 0.25f || uv.x > 0.75f || uv.y < 0.5f) {
      CHECK(length(p) == 0);
      CHECK(length(du) == 0);
      continue;
    }
    CHECK(length(p - Vec3{3 * uv.x - uv.y, 2 + uv.x * uv.y, uv.y}) < 2e-3f);
    CHECK(length(du - Vec3{3, uv.y, 0}) < 0.05f);
    CHECK(length(dv - Vec3{-1, uv.x, 1}) < 0.05f);
  }
}

TEST_CASE(
    "a value alone has the bits of the value with its gradient, and nothing beyond the last sample is read") {
  Random random(7);
  for (const bool mirror : {false, true}) {
    const auto f = [&](float, float) {
      return Vec3{random.uniform(-9, 9), random.uniform(-9, 9), random.uniform(-9, 9)};
    };
    const OpenModel m = with_field(f, 5, 4, 0.25f, 0.125f, 1, 1, mirror);
    const Field& field = m.model.fields()[1];
    // In a block of exactly their size: the sanitizers know its end.
    const std::size_t bytes = std::size_t{6} * field.width * field.height;
    const std::uint8_t* const in_table = m.model.samples() + field.first_byte;
    const std::vector<std::uint8_t> alone(in_table, in_table + bytes);
    Field moved = field;
    moved.first_byte = 0;
    for (int k = 0; k < 200; ++k) {
      const Vec2 uv = k == 0   ? Vec2{1, 1}
                      : k == 1 ? Vec2{0, 1}
                               : Vec2{random.uniform(0, 1), random.uniform(0, 1)};
      Vec3 du, dv;
      const Vec3 value = sample_field(alone.data(), moved, uv, Interpolation::bilinear, nullptr, nullptr);
      const Vec3 same = sample_with_gradient(m.model, field, uv, &du, &dv);
      CHECK((value.x == same.x && value.y == same.y && value.z == same.z));
    }
  }
}

TEST_CASE("a mirrored field is the reflection of the stored one") {
  const OpenModel r(egg_model(1));
  std::size_t mirrored = 0;
  while (!r.model.fields()[mirrored].mirror) ++mirrored;
  Random random(2);
  for (int i = 0; i < 300; ++i) {
    const Vec2 uv{random.uniform(0, 1), random.uniform(0, 1)};
    const Vec3 right = sample(r.model, r.model.fields()[mirrored], uv);
    const Vec3 left = sample(r.model, r.model.fields()[mirrored - 1], {1 - uv.x, uv.y});
    CHECK(right.x == -left.x);
    CHECK(right.y == left.y);
  }
}

TEST_CASE("both interpolations agree with the definition in double, in int8 and int16, mirrored or not") {
  Random random(3);
  for (int trial = 0; trial < 60; ++trial) {
    const OpenModel m(RandomModel(random).run());
    for (const Field& f : m.model.fields())
      for (const Interpolation how : kBoth)
        for (int k = 0; k < 6; ++k) {
          // Borders of the chart and points beyond them count as well.
          const Vec2 uv{clamp(random.uniform(-0.3f, 1.3f), 0, 1), clamp(random.uniform(-0.3f, 1.3f), 0, 1)};
          const auto wanted =
              reference::Field(m.model, f, how).at(static_cast<double>(uv.x), static_cast<double>(uv.y));
          CHECK((reference::of(sample(m.model, f, uv, how)) - wanted).norm() < 1e-4);
        }
  }
}

TEST_CASE("bicubic sampling reproduces quadratics and their gradient, up to the border of the chart") {
  const auto f = [](float u, float v) {
    return Vec3{3 * u * u - 2 * u * v + v, 1 + u - 4 * v * v, 2 * u * v - u * u};
  };
  for (const int side : {3, 4, 9}) {
    const OpenModel m = with_field(f, side, side + 1);
    Random random(4);
    for (int k = 0; k < 300; ++k) {
      const Vec2 uv{random.uniform(0, 1), random.uniform(0, 1)};
      Vec3 du, dv;
      const Vec3 p = sample_with_gradient(m.model, m.model.fields()[1], uv, &du, &dv, Interpolation::bicubic);
      CHECK(length(p - f(uv.x, uv.y)) < 1e-3f);
      CHECK(length(du - Vec3{6 * uv.x - 2 * uv.y, 1, 2 * uv.y - 2 * uv.x}) < 2e-2f);
      CHECK(length(dv - Vec3{1 - 2 * uv.x, -8 * uv.y, 2 * uv.x}) < 2e-2f);
    }
  }
}

TEST_CASE("bicubic sampling misses a cubic by what theory says: a (2a - 1) (a - 1) of a cell's side cubed") {
  const int side = 9;
  const float h = 1.0f / (side - 1);
  const OpenModel m = with_field([](float u, float) { return Vec3{100 * u * u * u, 0, 0}; }, side, side);
  for (int k = 0; k <= 100; ++k) {
    const float a = static_cast<float>(k) / 100, u = (3 + a) * h;  // a cell away from the border
    const float p = sample(m.model, m.model.fields()[1], {u, 0.4f}, Interpolation::bicubic).x;
    CHECK(magnitude(p - 100 * u * u * u - 100 * h * h * h * a * (2 * a - 1) * (a - 1)) < 4e-3f);
  }
}

TEST_CASE("two samples a side are joined by a line in either interpolation") {
  const OpenModel m = with_field([](float u, float v) { return Vec3{u, v - u, u * v}; }, 2, 2);
  Random random(5);
  for (int k = 0; k < 100; ++k) {
    const Vec2 uv{random.uniform(0, 1), random.uniform(0, 1)};
    for (const Interpolation how : kBoth)
      CHECK(length(sample(m.model, m.model.fields()[1], uv, how) - Vec3{uv.x, uv.y - uv.x, uv.x * uv.y}) <
            1e-4f);
  }
}

TEST_CASE("both pass through the samples") {
  Random random(6);
  const OpenModel m = with_field(
      [&random](float, float) {
        return Vec3{random.normal(), random.normal(), random.normal()};
      },
      7, 6);
  for (int j = 0; j < 6; ++j)
    for (int i = 0; i < 7; ++i) {
      const Vec2 uv{static_cast<float>(i) / 6, static_cast<float>(j) / 5};
      CHECK(length(sample(m.model, m.model.fields()[1], uv, Interpolation::bicubic) - at_sample(m, i, j)) <
            1e-5f);
    }
}

TEST_CASE("the gradient is that of the interpolated field, by central differences in double") {
  Random random(7);
  const double h = 1e-6;
  for (int trial = 0; trial < 40; ++trial) {
    const OpenModel m(RandomModel(random).run());
    for (const Field& f : m.model.fields())
      for (const Interpolation how : kBoth) {
        const Vec2 uv{random.uniform(0, 1), random.uniform(0, 1)};
        const double u = static_cast<double>(uv.x), v = static_cast<double>(uv.y);
        const reference::Field exact(m.model, f, how);
        Vec3 du, dv;
        const Vec3 p = sample_with_gradient(m.model, f, uv, &du, &dv, how);
        CHECK(length(p - sample(m.model, f, uv, how)) == 0);
        CHECK((reference::of(du) - (exact.at(u + h, v) - exact.at(u - h, v)) / (2 * h)).norm() < 2e-3);
        CHECK((reference::of(dv) - (exact.at(u, v + h) - exact.at(u, v - h)) / (2 * h)).norm() < 2e-3);
      }
  }
}

TEST_CASE(
    "a bicubic field has one gradient on both sides of a sample line and of its rim; a bilinear one has "
    "two") {
  Random random(8);
  const auto rough = [&random](float u0, float u1) {
    return [&random, u0, u1](float u, float v) {
      const bool rim = u <= u0 || u >= u1 || v <= u0 || v >= u1;
      return rim ? Vec3{} : Vec3{random.normal(), random.normal(), random.normal()};
    };
  };
  const float e = 1e-5f;
  const auto jump = [&](const OpenModel& m, Vec2 at, Vec2 across, Interpolation how) {
    Vec3 u0, v0, u1, v1;
    const Field& f = m.model.fields()[1];
    (void)sample_with_gradient(m.model, f, at - across, &u0, &v0, how);
    (void)sample_with_gradient(m.model, f, at + across, &u1, &v1, how);
    return length(u1 - u0) + length(v1 - v0);
  };
  float smallest_bilinear = 1e9f;
  for (const bool mirror : {false, true}) {
    const OpenModel whole = with_field(rough(-1, 2), 9, 9, 0, 0, 1, 1, mirror),
                    part = with_field(rough(0.26f, 0.74f), 9, 9, 0.25f, 0.25f, 0.75f, 0.75f, mirror);
    for (const OpenModel* m : {&whole, &part})
      for (int i = 0; i <= 8; ++i)
        for (int k = 0; k < 20; ++k) {
          const Field& f = m->model.fields()[1];
          const float line = f.u0 + (f.u1 - f.u0) * static_cast<float>(i) / 8;
          if (line <= 0 || line >= 1) continue;
          const float other = random.uniform(0.3f, 0.7f);
          CHECK(jump(*m, {line, other}, {e, 0}, Interpolation::bicubic) < 0.15f);
          CHECK(jump(*m, {other, line}, {0, e}, Interpolation::bicubic) < 0.15f);
          if (i > 0 && i < 8)
            smallest_bilinear =
                min(smallest_bilinear, jump(*m, {line, other}, {e, 0}, Interpolation::bilinear));
        }
  }
  CHECK(smallest_bilinear > 0.5f);
}

TEST_CASE("outside its support a field is zero in either interpolation, and so is its gradient") {
  const OpenModel m = with_field(
      [](float u, float v) {
        const bool rim = u < 0.31f || u > 0.69f || v < 0.41f || v > 0.59f;
        return rim ? Vec3{} : Vec3{1, 2, 3};
      },
      5, 6, 0.3f, 0.4f, 0.7f, 0.6f);
  for (const Vec2 uv :
       {Vec2{0.29f, 0.5f}, {0.71f, 0.5f}, {0.5f, 0.39f}, {0.5f, 0.61f}, {0, 0}, {1, 1}, {-3, 9}})
    for (const Interpolation how : kBoth) {
      Vec3 du{1, 1, 1}, dv{1, 1, 1};
      CHECK(length(sample_with_gradient(m.model, m.model.fields()[1], uv, &du, &dv, how)) == 0);
      CHECK(length(du) + length(dv) == 0);
    }
}

TEST_CASE("a smooth surface has truer tangents by bicubic sampling than by bilinear of the same table") {
  const auto dome = [](float u, float v) {
    return Vec3{150 * u, 200 * v, 400 * u * (1 - u) * v * (1 - v) * (1 + u - v * v)};
  };
  const OpenModel m = with_field(dome, 33, 33);
  Random random(9);
  double off[2] = {0, 0};
  for (int k = 0; k < 2000; ++k) {
    const Vec2 uv{random.uniform(0, 1), random.uniform(0, 1)};
    const float e = 1e-2f;
    const Vec3 du = (0.5f / e) * (dome(uv.x + e, uv.y) - dome(uv.x - e, uv.y));
    for (int how = 0; how < 2; ++how) {
      Vec3 au, av;
      (void)sample_with_gradient(m.model, m.model.fields()[1], uv, &au, &av, kBoth[how]);
      off[how] += static_cast<double>(length(au - du));
    }
  }
  CHECK(off[1] < 0.2 * off[0]);
}

}  // namespace sampling_test
