// Boxes around points.
#include "host/io/bounding_box.hpp"

#include <doctest/doctest.h>

namespace bounding_box_test {

using namespace pliant;
using namespace pliant::host;

TEST_CASE("a box holds its points and no more, also far from the origin; one without points has no size") {
  BoundingBox<Vec2> box;
  CHECK(length(box.size()) == 0);
  box.add({5e9f, -3});
  CHECK(length(box.size()) == 0);
  box.add({4e9f, -2});
  CHECK(box.low.x == 4e9f);
  CHECK(box.low.y == -3);
  CHECK(box.high.x == 5e9f);
  CHECK(box.high.y == -2);
  const BoundingBox<Vec3> of(std::vector<Vec3>{{1, 2, 3}, {-1, 4, 3}});
  CHECK(of.size().x == 2);
  CHECK(of.size().y == 2);
  CHECK(of.size().z == 0);
}

}  // namespace bounding_box_test
