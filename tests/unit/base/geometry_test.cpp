#include "pliant/geometry.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <initializer_list>
#include <limits>

#include "random.hpp"

namespace geometry_test {

using namespace pliant;

TEST_CASE("the exponential of a rotation vector agrees with sine and cosine in double") {
  Random random(1);
  for (int i = 0; i < 2000; ++i) {
    const float size = i < 1000 ? 0.5f : 3.1f;
    const Vec3 w{random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
    const double angle =
        std::sqrt(double(w.x) * double(w.x) + double(w.y) * double(w.y) + double(w.z) * double(w.z));
    const double s = angle > 0 ? std::sin(angle / 2) / angle : 0.5;
    Quat q = exp_rotation(w);
    const double sign = std::cos(angle / 2) < 0 ? -1 : 1;
    CHECK(double(q.w) == doctest::Approx(sign * std::cos(angle / 2)).epsilon(2e-6));
    CHECK(double(q.x) == doctest::Approx(sign * s * double(w.x)).epsilon(2e-6));
    CHECK(double(q.y) == doctest::Approx(sign * s * double(w.y)).epsilon(2e-6));
    CHECK(double(q.z) == doctest::Approx(sign * s * double(w.z)).epsilon(2e-6));
  }
}

TEST_CASE("many turns are those of the angle") {
  for (const float angle : {100.0f, 200.0f, 1000.0f}) {
    const Quat q = exp_rotation({0, 0, angle});
    CHECK(double(1 - 2 * q.z * q.z) == doctest::Approx(std::cos(double(angle))).epsilon(2e-3).scale(1));
  }
  const Quat far = exp_rotation({3e38f, -3e38f, 3e38f});
  CHECK(far.x * far.x + far.y * far.y + far.z * far.z + far.w * far.w == doctest::Approx(1));
}

TEST_CASE("log undoes exp, and a matrix and back is the same quaternion") {
  Random random(2);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 w{random.uniform(-1.7f, 1.7f), random.uniform(-1.7f, 1.7f), random.uniform(-1.7f, 1.7f)};
    const Vec3 back = log_rotation(exp_rotation(w));
    CHECK(length(back - w) < 2e-5f);
    const Quat q = exp_rotation(w), r = quaternion(rotation_matrix(q));
    CHECK(magnitude(q.w * r.w + q.x * r.x + q.y * r.y + q.z * r.z) > 0.999999f);
  }
}

TEST_CASE("the product of quaternions is the product of their matrices") {
  const Quat a = exp_rotation({0.3f, -0.2f, 0.9f}), b = exp_rotation({-0.7f, 0.1f, 0.4f});
  const Vec3 v{1, 2, 3};
  const Vec3 once = rotation_matrix(a * b) * v, twice = rotation_matrix(a) * (rotation_matrix(b) * v);
  CHECK(length(once - twice) < 1e-5f);
}

TEST_CASE("what is not finite is told and never spreads") {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  CHECK_FALSE(is_finite(nan));
  CHECK_FALSE(is_finite(-inf));
  CHECK(is_finite(3e38f));
  CHECK(exp_rotation({nan, 0, 0}).w == 1);
  CHECK(normalised(Quat{0, 0, 0, 0}).w == 1);
  CHECK(length(normalised(Vec3{})) == 0);
  CHECK(length(normalised(Vec3{nan, 0, 1})) == 0);
  CHECK(inverse(Mat2{1, 2, 2, 4}).a == 1);
  CHECK(inverse(Mat2{nan, 0, 0, 1}).a == 1);
}

TEST_CASE("of two numbers the first one counts where one is none; vectors are compared by components") {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  CHECK(min(1, nan) == 1);
  CHECK(max(1, nan) == 1);
  CHECK(std::isnan(min(nan, 1)));
  CHECK(std::isnan(max(nan, 1)));
  CHECK(length(min(Vec2{1, 5}, Vec2{2, 3}) - Vec2{1, 3}) == 0);
  CHECK(length(max(Vec2{1, 5}, Vec2{2, 3}) - Vec2{2, 5}) == 0);
  CHECK(length(min(Vec3{1, 5, -1}, Vec3{2, 3, 4}) - Vec3{1, 3, -1}) == 0);
  CHECK(length(max(Vec3{1, 5, -1}, Vec3{2, 3, 4}) - Vec3{2, 5, 4}) == 0);
}

TEST_CASE("the area of a triangle is positive where it is clockwise on the screen, and 0 on a line") {
  CHECK(doubled_area({0, 0}, {4, 0}, {0, 3}) == 12);
  CHECK(doubled_area({0, 0}, {0, 3}, {4, 0}) == -12);
  CHECK(doubled_area({1, 1}, {2, 2}, {5, 5}) == 0);
}

TEST_CASE("the square root of a little less than nothing is nothing, of no number none") {
  CHECK(square_root(2.25f) == 1.5f);
  for (const float x : {0.0f, -0.0f, -1e-30f, -1.0f}) CHECK(square_root(x) == 0);
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  CHECK(square_root(inf) == inf);
  CHECK(std::isnan(square_root(nan)));
  CHECK(std::isnan(length(Vec2{nan, 1})));
  CHECK(std::isnan(length(Vec3{0, nan, 1})));
}

}  // namespace geometry_test
