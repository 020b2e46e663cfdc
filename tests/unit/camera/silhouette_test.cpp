#include "pliant/silhouette.hpp"

#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <cmath>

#include "model_builder.hpp"
#include "random.hpp"

namespace silhouette_test {

using namespace pliant;

namespace {

/// An ellipsoid of half axes (70, 90, 60) mm over a chart of longitudes and latitudes, as a camera sees it.
struct Ellipsoid {
  ModelBuilder builder;
  InArena<Mesh> mesh;
  InArena<SilhouetteFinder> finder;
  InArena<DepthBuffer> buffer;
  View view;
  std::vector<Vec3> position;
  std::vector<Vec2> image;
  std::vector<float> depth;
  double width;
  static constexpr double kAxis[3] = {70, 90, 60};

  /// \param width_  radians of longitude that the chart covers, around the front.
  explicit Ellipsoid(int cells, double width_ = 6.0)
      : mesh(MeshLimits{4096, 8192, 2}), finder(std::size_t{4096}), buffer(48, 48), width(width_) {
    builder.grid_mesh(cells);
    REQUIRE(mesh->set_base({builder.vertices.data(), builder.vertices.size()},
                           {builder.corners.data(), builder.corners.size()}) == Status::ok);
    for (Vec2 uv : builder.vertices) position.push_back(at(uv));
  }
  Vec3 at(Vec2 uv) const {
    const double a = width * (double(uv.x) - 0.5), b = 3.0 * (0.5 - double(uv.y));
    return {float(kAxis[0] * std::sin(a) * std::cos(b)), float(kAxis[1] * std::sin(b)),
            float(kAxis[2] * std::cos(a) * std::cos(b))};
  }
  void pose(const Pose& pose) {
    view = view_of(pose, centred_camera(640, 480, 700));
    const Projector projector(view, true);
    image.assign(position.size(), {});
    depth.clear();
    for (std::size_t v = 0; v < position.size(); ++v)
      depth.push_back(projector.project(position[v], &image[v]) ? projector.to_camera(position[v]).z : -1);
    buffer->draw(mesh.object, image.data(), depth.data());
  }
  std::vector<SilhouettePoint> find(bool with_buffer = true) {
    std::vector<SilhouettePoint> points(3000);
    const std::size_t n =
        finder->find({mesh.object, position.data(), image.data(), depth.data()}, Projector(view, true),
                     with_buffer ? &buffer.object : nullptr, 6, {points.data(), points.size()});
    REQUIRE(n <= points.size());
    points.resize(n);
    return points;
  }
  /// The contour's conic: l is tangent to it where l^T C* l = 0, C* = P diag(a^2, b^2, c^2, -1) P^T.
  Eigen::Matrix3d conic() const {
    const Camera camera = camera_of(view);
    const Pose pose = pose_of(view);
    Eigen::Matrix3d k = Eigen::Matrix3d::Identity();
    k << double(camera.f), 0, double(camera.cx), 0, double(camera.f), double(camera.cy), 0, 0, 1;
    Eigen::Quaterniond turn(double(pose.q.w), double(pose.q.x), double(pose.q.y), double(pose.q.z));
    Eigen::Matrix<double, 3, 4> p;
    p.leftCols<3>() = turn.toRotationMatrix() * Eigen::Vector3d(1, -1, -1).asDiagonal();
    p.col(3) << double(pose.t.x), double(pose.t.y), double(pose.t.z);
    const Eigen::Vector4d q(kAxis[0] * kAxis[0], kAxis[1] * kAxis[1], kAxis[2] * kAxis[2], -1);
    return (k * p * q.asDiagonal() * p.transpose() * k.transpose()).inverse();
  }
};

}  // namespace

TEST_CASE("the contour of an ellipsoid lies on the conic of its tangent rays, and the normals across it") {
  Random random(4);
  for (int trial = 0; trial < 12; ++trial) {
    Ellipsoid egg(48);
    egg.pose({exp_rotation(
                  {random.uniform(-0.4f, 0.4f), random.uniform(-0.8f, 0.8f), random.uniform(-0.5f, 0.5f)}),
              {random.uniform(-60, 60), random.uniform(-40, 40), random.uniform(400, 900)}});
    const auto points = egg.find();
    const Eigen::Matrix3d c = egg.conic();
    int contour = 0;
    double worst_px = 0, worst_turn = 1, covered = 0, last = 0;
    std::vector<double> around;
    for (const SilhouettePoint& p : points) {
      if (p.is_border) continue;
      ++contour;
      const Eigen::Vector3d x(double(p.x.x), double(p.x.y), 1), g = c * x;
      const double size = std::hypot(g.x(), g.y());
      worst_px = std::max(worst_px, std::abs(x.dot(g)) / (2 * size));
      const double along = (g.x() * double(p.normal.x) + g.y() * double(p.normal.y)) / size;
      worst_turn = std::min(worst_turn, std::abs(along));
      const Vec2 out = p.x - egg.image[egg.image.size() / 2];
      CHECK(length(p.normal) == doctest::Approx(1));
      around.push_back(std::atan2(double(out.y), double(out.x)));
    }
    CHECK(contour > 60);
    CHECK(worst_px < 0.6);  // chords of a mesh of 48 cells a side
    CHECK(worst_turn > 0.999);
    std::sort(around.begin(), around.end());
    for (double a : around) {
      covered = std::max(covered, a - last);
      last = a;
    }
    CHECK(covered < 3.2);
  }
}

TEST_CASE("outward normals leave the surface, and finer meshes are nearer to the truth") {
  double error[2] = {};
  for (int fine = 0; fine < 2; ++fine) {
    Ellipsoid egg(fine == 0 ? 16 : 48);
    egg.pose({exp_rotation({0.1f, 0.3f, 0}), {0, 0, 600}});
    const Eigen::Matrix3d c = egg.conic();
    const auto value = [&](Vec2 at) {
      const Eigen::Vector3d x(double(at.x), double(at.y), 1);
      return x.dot(c * x);
    };
    Vec2 centre;
    Projector(egg.view, true).project({0, 0, 0}, &centre);
    const double inside = value(centre);
    for (const SilhouettePoint& p : egg.find()) {
      if (p.is_border) continue;
      CHECK(value(p.x + 5.0f * p.normal) * inside < 0);
      CHECK(value(p.x - 5.0f * p.normal) * inside > 0);
      error[fine] = std::max(error[fine], std::abs(value(p.x) / inside));
    }
  }
  CHECK(error[1] < 0.25 * error[0]);
}

TEST_CASE("place, image position and depth of a point are those of one point of the surface") {
  for (const double width : {6.0, 2.4}) {
    Ellipsoid egg(48, width);
    egg.pose({exp_rotation({0.1f, 0.3f, 0.2f}), {20, -10, 600}});
    const Projector projector(egg.view, true);
    int borders = 0, contour = 0;
    for (const SilhouettePoint& p : egg.find()) {
      ++(p.is_border ? borders : contour);
      Vec2 x;
      REQUIRE(projector.project(egg.at(p.uv), &x));
      CHECK(length(x - p.x) < 0.6f);  // chords of a mesh of 48 cells a side
      CHECK(magnitude(projector.to_camera(egg.at(p.uv)).z - p.depth) < 0.6f);
    }
    CHECK((width < 3 ? borders : contour) > 60);
  }
}

TEST_CASE("the visible boundary of an open surface is reported and flagged") {
  Ellipsoid half(32, 2.4);  // ends before it turns away
  half.pose({{}, {0, 0, 700}});
  std::size_t borders = 0, contours = 0;
  for (const SilhouettePoint& p : half.find()) {
    if (!p.is_border) {
      contours += p.uv.y > 0.1f && p.uv.y < 0.9f;  // it does turn away at the poles
      continue;
    }
    ++borders;
    if (p.uv.y > 0.2f && p.uv.y < 0.8f) {
      CHECK((p.uv.x == 0 || p.uv.x == 1));
      CHECK(p.normal.x * (p.uv.x - 0.5f) > 0);  // u runs to the right of the image
    }
  }
  CHECK(borders >= 64);
  CHECK(contours == 0);
  half.pose({exp_rotation({0, 0.9f, 0}), {0, 0, 700}});
  std::size_t low = 0, high = 0;
  for (const SilhouettePoint& p : half.find())
    if (p.is_border && p.uv.y > 0.3f && p.uv.y < 0.7f) (p.uv.x == 0 ? low : high) += 1;
  CHECK(low + high > 0);
  CHECK((low == 0 || high == 0));  // the border that turned away is hidden by its own face
}

TEST_CASE("points hidden by a nearer part of the mesh are left out") {
  Ellipsoid ridges(48);  // two ridges along v, the second half as high
  const auto ridge = [](float u, float at) {
    const float t = max(0.0f, 1 - 60 * (u - at) * (u - at));
    return t * t;
  };
  for (std::size_t v = 0; v < ridges.position.size(); ++v) {
    const Vec2 uv = ridges.builder.vertices[v];
    ridges.position[v] = {200 * (uv.x - 0.5f), 120 * (0.5f - uv.y),
                          120 * ridge(uv.x, 0.3f) + 60 * ridge(uv.x, 0.65f)};
  }
  const auto of_second = [&](float yaw, bool with_buffer) {
    ridges.pose({exp_rotation({0, yaw, 0}), {0, 0, 700}});
    std::size_t n = 0;
    for (const SilhouettePoint& p : ridges.find(with_buffer))
      n += !p.is_border && p.uv.x > 0.55f && p.uv.x < 0.75f && p.uv.y > 0.1f && p.uv.y < 0.9f;
    return n;
  };
  // From either side the second ridge has a contour; from one side the first ridge hides it.
  CHECK(of_second(1.1f, false) > 30);
  CHECK(of_second(-1.1f, false) > 30);
  const std::size_t from_left = of_second(1.1f, true), from_right = of_second(-1.1f, true);
  CHECK(min(static_cast<float>(from_left), static_cast<float>(from_right)) == 0);
  CHECK(from_left + from_right > 30);
}

TEST_CASE("more points than there is room for are counted, not written") {
  Ellipsoid egg(24);
  egg.pose({{}, {0, 0, 600}});
  const auto all = egg.find();
  std::vector<SilhouettePoint> few(5);
  const PosedMesh posed{egg.mesh.object, egg.position.data(), egg.image.data(), egg.depth.data()};
  CHECK(egg.finder->find(posed, Projector(egg.view, true), &egg.buffer.object, 6, {few.data(), 4}) ==
        all.size());
  CHECK(length(few[4].normal) == 0);
  for (std::size_t i = 0; i < 4; ++i) CHECK(few[i].x.x == all[i].x.x);
  for (float& d : egg.depth) d = -1;  // behind the camera
  CHECK(egg.find().empty());
}

}  // namespace silhouette_test
