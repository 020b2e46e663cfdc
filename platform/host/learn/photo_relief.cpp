#include "host/learn/photo_relief.hpp"

#include <algorithm>
#include <cmath>

namespace pliant::host::learn {

/// Nodes of a regular grid over the photograph. The outermost ones lie far outside it, where its border is continued.
struct PhotoRelief::Grid {
  int columns, rows;
  float step_px;
  Vec2 first;
  std::size_t index(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(i);
  }
  Vec2 at(int i, int j) const {
    const auto far = [](int k, int count) { return k == 0 ? -60.0f : k == count - 1 ? 60.0f : 0.0f; };
    return first +
           step_px * Vec2{static_cast<float>(i) + far(i, columns), static_cast<float>(j) + far(j, rows)};
  }
};

namespace {

constexpr int kOverlap = 1;  // cells of the relief under the face, along its edge

constexpr const PhotoReliefTuning& kTuning = kPhotoReliefTuning;
constexpr std::uint32_t kNowhere = 0xffffffffu;

/// Fills values that are 0 from the others: each from its nearest, then smoothed. Much smoothing would bring the ears forward,
/// before the jaw.
template <class Grid>
void fill_smoothly(const Grid& grid, const std::vector<std::uint32_t>& nearest, std::vector<float>& values) {
  std::vector<std::uint8_t> is_known(values.size());
  for (std::size_t k = 0; k < values.size(); ++k) is_known[k] = values[k] != 0 ? 1 : 0;
  for (std::size_t k = 0; k < values.size(); ++k)
    if (is_known[k] == 0) values[k] = values[nearest[k]];
  for (int sweep = 0; sweep < 8; ++sweep)
    for (int j = 0; j < grid.rows; ++j)
      for (int i = 0; i < grid.columns; ++i) {
        if (is_known[grid.index(i, j)] != 0) continue;
        const float left = values[grid.index(std::max(i - 1, 0), j)],
                    right = values[grid.index(std::min(i + 1, grid.columns - 1), j)],
                    up = values[grid.index(i, std::max(j - 1, 0))],
                    down = values[grid.index(i, std::min(j + 1, grid.rows - 1))];
        values[grid.index(i, j)] = 0.25f * (left + right + up + down);
      }
}

/// The nearest node with a value for every node, by two sweeps over the neighbours' nearest.
template <class Grid>
std::vector<std::uint32_t> nearest_known(const Grid& grid, const std::vector<float>& values) {
  std::vector<std::uint32_t> nearest(values.size(), kNowhere);
  const auto position = [&](std::uint32_t k) {
    return Vec2{static_cast<float>(static_cast<int>(k) % grid.columns),
                static_cast<float>(static_cast<int>(k) / grid.columns)};
  };
  const auto consider = [&](int i, int j, int di, int dj) {
    const int a = i + di, b = j + dj;
    if (a < 0 || b < 0 || a >= grid.columns || b >= grid.rows) return;
    const std::uint32_t candidate = nearest[grid.index(a, b)];
    if (candidate == kNowhere) return;
    std::uint32_t& present = nearest[grid.index(i, j)];
    const Vec2 here{static_cast<float>(i), static_cast<float>(j)};
    if (present == kNowhere || length(position(candidate) - here) < length(position(present) - here))
      present = candidate;
  };
  for (std::size_t k = 0; k < values.size(); ++k)
    if (values[k] != 0) nearest[k] = static_cast<std::uint32_t>(k);
  for (int j = 0; j < grid.rows; ++j)
    for (int i = 0; i < grid.columns; ++i)
      consider(i, j, -1, 0), consider(i, j, 0, -1), consider(i, j, -1, -1), consider(i, j, 1, -1);
  for (int j = grid.rows - 1; j >= 0; --j)
    for (int i = grid.columns - 1; i >= 0; --i)
      consider(i, j, 1, 0), consider(i, j, 0, 1), consider(i, j, 1, 1), consider(i, j, -1, 1);
  return nearest;
}

Vec3 transposed_product(const Mat3& m, Vec3 v) {
  return {m.m[0][0] * v.x + m.m[1][0] * v.y + m.m[2][0] * v.z,
          m.m[0][1] * v.x + m.m[1][1] * v.y + m.m[2][1] * v.z,
          m.m[0][2] * v.x + m.m[1][2] * v.y + m.m[2][2] * v.z};
}

/// For each node on the face, near its edge, the vertex that is nearest in the picture.
template <class Grid>
std::vector<std::uint32_t> nearest_vertices(const Grid& grid, const std::vector<Vec2>& nodes,
                                            const std::vector<float>& depth,
                                            const std::vector<TextureVertex>& vertices) {
  std::vector<std::uint32_t> out(nodes.size(), 0);
  // Nodes inside the face do not show (see connect).
  const auto is_near_edge = [&](std::size_t k) {
    constexpr int kReach = kOverlap + 1;
    const int i = static_cast<int>(k) % grid.columns, j = static_cast<int>(k) / grid.columns;
    for (int b = std::max(j - kReach, 0); b <= std::min(j + kReach, grid.rows - 1); ++b)
      for (int a = std::max(i - kReach, 0); a <= std::min(i + kReach, grid.columns - 1); ++a)
        if (depth[grid.index(a, b)] == 0) return true;
    return false;
  };
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    if (depth[k] == 0 || !is_near_edge(k)) continue;
    float best = 1e9f;
    for (std::size_t v = 0; v < vertices.size(); ++v) {
      const Vec2 d = vertices[v].x - nodes[k];
      if (const float squared = dot(d, d); vertices[v].inverse_depth > 0 && squared < best)
        best = squared, out[k] = static_cast<std::uint32_t>(v);
    }
  }
  return out;
}

}  // namespace

PhotoRelief::Grid PhotoRelief::grid_over(const Image& picture, float step_px) {
  const auto nodes = [&](int length) { return static_cast<int>(static_cast<float>(length) / step_px) + 4; };
  return {nodes(picture.width), nodes(picture.height), step_px, {-1.5f * step_px, -1.5f * step_px}};
}

PhotoRelief::PhotoRelief(const Image& photograph, const View& view, const FaceSheet& sheet,
                         const std::vector<Vec3>& fitted) {
  const Grid grid = grid_over(photograph, kTuning.step * view.s);
  const Projector projector(view, true);
  // The face in units of the grid.
  std::vector<TextureVertex> vertices(fitted.size());
  for (std::size_t k = 0; k < fitted.size(); ++k)
    if (projector.project(fitted[k], &vertices[k].x)) {
      vertices[k].inverse_depth = 1 / projector.to_camera(fitted[k]).z;
      vertices[k].x = 1 / grid.step_px * (vertices[k].x - grid.first);
    }
  TextureRaster raster(grid.columns, grid.rows, 1);
  raster.clear();
  raster.draw(vertices, sheet.triangles);
  std::vector<Vec2> nodes;
  std::vector<float> depth;
  for (int j = 0; j < grid.rows; ++j)
    for (int i = 0; i < grid.columns; ++i) {
      nodes.push_back({static_cast<float>(i), static_cast<float>(j)});
      depth.push_back(raster.depth(nodes.back()));
    }
  const std::vector<std::uint32_t> nearest = nearest_known(grid, depth);
  if (nearest[0] == kNowhere) return;  // the face is smaller than a cell
  const std::vector<std::uint32_t> vertex = nearest_vertices(grid, nodes, depth, vertices);
  fill_smoothly(grid, nearest, depth);

  const Mat3 rotation = model_to_camera(view.q);
  const Pose pose = pose_of(view);
  const float focal = camera_of(view).f;
  for (int j = 0; j < grid.rows; ++j)
    for (int i = 0; i < grid.columns; ++i) {
      const std::size_t k = grid.index(i, j);
      const float distance = kTuning.step * length(nodes[k] - nodes[nearest[k]]);
      const float t = min(distance / kTuning.head_radius, 1);
      const float z = depth[k] + kTuning.behind + kTuning.head_depth * (1 - std::sqrt(max(1 - t * t, 0)));
      const Vec2 x = grid.at(i, j);
      const Vec3 in_camera{(x.x - view.c.x) * z / focal, (x.y - view.c.y) * z / focal, z};
      nodes_.push_back({x, transposed_product(rotation, in_camera - pose.t), distance, vertex[nearest[k]]});
    }
  connect(grid);
}

void PhotoRelief::connect(const Grid& grid) {
  // The face covers its inside, where the relief would show through an opened mouth.
  const auto is_covered = [&](int i, int j) {
    for (int b = std::max(j - kOverlap, 0); b <= std::min(j + 1 + kOverlap, grid.rows - 1); ++b)
      for (int a = std::max(i - kOverlap, 0); a <= std::min(i + 1 + kOverlap, grid.columns - 1); ++a)
        if (nodes_[grid.index(a, b)].distance > 0) return false;
    return true;
  };
  const auto number = [&](int i, int j) { return static_cast<std::uint32_t>(grid.index(i, j)); };
  for (int j = 0; j + 1 < grid.rows; ++j)
    for (int i = 0; i + 1 < grid.columns; ++i) {
      if (is_covered(i, j)) continue;
      triangles_.push_back({{number(i, j), number(i + 1, j), number(i, j + 1)}, FacePart::around});
      triangles_.push_back({{number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)}, FacePart::around});
    }
}

std::vector<TextureVertex> PhotoRelief::vertices(const PhotoTurn& turn, const std::vector<Vec3>& moved,
                                                 const std::vector<TextureVertex>& face) const {
  constexpr std::size_t kTurns = 17;  // from body to head
  const Quat relative = turn.pose.q * conjugate(turn.body);
  const Vec3 way = log_rotation(relative);
  Mat3 rotation[kTurns];
  for (std::size_t k = 0; k < kTurns; ++k)
    rotation[k] =
        model_to_camera(normalised(exp_rotation(static_cast<float>(k) / (kTurns - 1) * way) * turn.body));
  const Vec3 pivot = model_to_camera(turn.pose.q) * kTuning.pivot + turn.pose.t;
  const float light = length(turn.light) > 0 ? 0.8f * relit({0, 0, -1}, turn.light) : 1;
  std::vector<TextureVertex> out(nodes_.size());
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    const Node& node = nodes_[k];
    const float w = 1 - smooth_step(kTuning.turns_fully, kTuning.stays, node.distance);
    const float follows = std::exp(-node.distance / kTuning.follows);
    const Vec3 p = node.p + follows * moved[node.nearest];
    const float exact = w * (kTurns - 1) * 0.9999f;
    const auto lower = static_cast<std::size_t>(exact);
    const float upper = exact - static_cast<float>(lower);
    const Vec3 arm = p - kTuning.pivot;
    const Vec3 c = (1 - upper) * (rotation[lower] * arm) + upper * (rotation[lower + 1] * arm) + pivot;
    if (!(c.z > 50)) continue;
    TextureVertex& v = out[k];
    v.x = {turn.camera.cx + turn.camera.f * c.x / c.z, turn.camera.cy + turn.camera.f * c.y / c.z};
    v.inverse_depth = 1 / c.z;
    v.texture = v.fixed = node.texture;
    const float far = smooth_step(0, kTuning.turns_fully, node.distance);
    v.light = face[node.nearest].light + far * (light - face[node.nearest].light);
    v.cover = 1 - smooth_step(turn.cover_mm, 1.5f * turn.cover_mm, node.distance);
  }
  return out;
}

}  // namespace pliant::host::learn
