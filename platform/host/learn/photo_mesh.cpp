#include "host/learn/photo_mesh.hpp"

#include <algorithm>
#include <cmath>

namespace pliant::host::learn {

namespace {

constexpr int kOverlap = 1;  // cells of the relief under the face, along its edge

constexpr const PhotoReliefTuning& kTuning = kPhotoReliefTuning;

float smooth_step(float low, float high, float x) {
  const float t = clamp((x - low) / (high - low), 0, 1);
  return t * t * (3 - 2 * t);
}

/// Nodes of a regular grid over the photograph. The outermost ones lie far outside it, where its border is continued.
struct Grid {
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

Grid grid_over(const Image& picture, float step_px) {
  const auto nodes = [&](int length) { return static_cast<int>(static_cast<float>(length) / step_px) + 4; };
  return {nodes(picture.width), nodes(picture.height), step_px, {-1.5f * step_px, -1.5f * step_px}};
}

/// Fills values that are 0 from the others: each from its nearest, then smoothed. Much smoothing would bring the ears forward,
/// before the jaw.
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
std::vector<std::uint32_t> nearest_known(const Grid& grid, const std::vector<float>& values) {
  std::vector<std::uint32_t> nearest(values.size(), 0xffffffffu);
  const auto position = [&](std::uint32_t k) {
    return Vec2{static_cast<float>(static_cast<int>(k) % grid.columns),
                static_cast<float>(static_cast<int>(k) / grid.columns)};
  };
  const auto consider = [&](int i, int j, int di, int dj) {
    const int a = i + di, b = j + dj;
    if (a < 0 || b < 0 || a >= grid.columns || b >= grid.rows) return;
    const std::uint32_t candidate = nearest[grid.index(a, b)];
    if (candidate == 0xffffffffu) return;
    std::uint32_t& present = nearest[grid.index(i, j)];
    const Vec2 here{static_cast<float>(i), static_cast<float>(j)};
    if (present == 0xffffffffu || length(position(candidate) - here) < length(position(present) - here))
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

Mat3 model_to_camera(Quat q) {
  Mat3 m = rotation_matrix(q);
  for (auto& row : m.m) row[1] = -row[1], row[2] = -row[2];
  return m;
}

Vec3 transposed_product(const Mat3& m, Vec3 v) {
  return {m.m[0][0] * v.x + m.m[1][0] * v.y + m.m[2][0] * v.z,
          m.m[0][1] * v.x + m.m[1][1] * v.y + m.m[2][1] * v.z,
          m.m[0][2] * v.x + m.m[1][2] * v.y + m.m[2][2] * v.z};
}

/// Factor on the brightness of a surface with unit normal n (camera axes): 1 on average.
float relit(Vec3 n, Vec3 light) {
  const float strength = length(light);
  if (!(strength > 0)) return 1;
  const float lambert = max(0, (dot(n, light) / strength + 0.25f) / 1.25f);
  return 1 - strength + strength * 1.6f * lambert;
}

}  // namespace

PhotoMesh::PhotoMesh(const Photograph& photograph, const FaceSheet& sheet, Cascade& cascade)
    : sheet_(sheet), fit_(view_of(photograph.pose, photograph.camera)) {
  fitted_ = sheet.positions(cascade, photograph.q.data());
  bend(photograph, cascade);
  mark_openings(photograph);
  make_relief(photograph);
}

void PhotoMesh::bend(const Photograph& photograph, Cascade& cascade) {
  const auto landmarks = cascade.model().landmarks();
  const Projector projector(fit_, true);
  struct Residual {
    Vec2 uv, d;
  };
  std::vector<Residual> residuals;
  const float limit = 10 * fit_.s;  // a larger one is an error of the annotation
  for (std::size_t k = 0; k < photograph.landmarks.size(); ++k) {
    const Vec2 uv{landmarks[k].u, landmarks[k].v};
    Vec2 x;
    if (photograph.trust[k] == kTrustNone ||
        !projector.project(cascade.surface_point(uv, photograph.q.data()), &x))
      continue;
    const Vec2 d = photograph.landmarks[k] - x;
    const float size = length(d);
    residuals.push_back({uv, size > limit ? limit / size * d : d});
  }
  // 200 mm are about the whole chart.
  const float floor = kTuning.apart / 200, fade = 30.0f / 200;
  for (const Vec2 uv : sheet_.uv) {
    Vec2 sum;
    float weights = 1 / (fade * fade * fade * fade);
    for (const Residual& r : residuals) {
      const float d = dot(uv - r.uv, uv - r.uv) + floor * floor;
      sum = sum + 1 / (d * d) * r.d;
      weights += 1 / (d * d);
    }
    bend_.push_back(1 / weights * sum);
  }
}

void PhotoMesh::mark_openings(const Photograph& photograph) {
  openings_ = Image(photograph.picture.width, photograph.picture.height, 1);
  const Projector projector(fit_, true);
  std::vector<TextureVertex> vertices(fitted_.size());
  for (std::size_t k = 0; k < fitted_.size(); ++k)
    if (projector.project(fitted_[k], &vertices[k].x)) {
      vertices[k].x = vertices[k].x + bend_[k];
      vertices[k].inverse_depth = 1 / projector.to_camera(fitted_[k]).z;
    }
  TextureRaster raster(openings_.width, openings_.height, 1);
  raster.clear();
  raster.draw(vertices, sheet_.triangles);
  TextureFragment fragment{};
  float sum = 0, count = 0;
  for (int y = 0; y < openings_.height; ++y)
    for (int x = 0; x < openings_.width; ++x) {
      if (!raster.fragment(x, y, &fragment)) continue;
      if (fragment.part != FacePart::skin) *openings_.at(x, y) = 255;
      sum += static_cast<float>(*photograph.picture.at(x, y)), count += 1;
    }
  dark_ = count > 0 ? 0.22f * sum / count : 20;
}

void PhotoMesh::make_relief(const Photograph& photograph) {
  const Grid grid = grid_over(photograph.picture, kTuning.step * fit_.s);
  const Projector projector(fit_, true);
  // Depth of the face at the nodes, and the vertex of the face that is nearest to each.
  std::vector<TextureVertex> vertices(fitted_.size());
  for (std::size_t k = 0; k < fitted_.size(); ++k)
    if (projector.project(fitted_[k], &vertices[k].x)) {
      vertices[k].inverse_depth = 1 / projector.to_camera(fitted_[k]).z;
      vertices[k].x = 1 / grid.step_px * (vertices[k].x - grid.first);
      vertices[k].texture = {static_cast<float>(k), 0};
    }
  TextureRaster raster(grid.columns, grid.rows, 1);
  raster.clear();
  raster.draw(vertices, sheet_.triangles);
  std::vector<float> depth(grid.index(0, grid.rows));
  for (int j = 0; j < grid.rows; ++j)
    for (int i = 0; i < grid.columns; ++i)
      depth[grid.index(i, j)] = raster.depth({static_cast<float>(i), static_cast<float>(j)});
  const std::vector<std::uint32_t> nearest = nearest_known(grid, depth);
  if (nearest[0] == 0xffffffffu) return;  // the face is smaller than a cell
  std::vector<std::uint32_t> vertex_near(depth.size(), 0);
  for (std::size_t k = 0; k < depth.size(); ++k) {
    if (depth[k] == 0) continue;
    const Vec2 here{static_cast<float>(static_cast<int>(k) % grid.columns),
                    static_cast<float>(static_cast<int>(k) / grid.columns)};
    float best = 1e9f;
    for (std::size_t v = 0; v < vertices.size(); ++v) {
      const Vec2 d = vertices[v].x - here;
      if (const float squared = dot(d, d); vertices[v].inverse_depth > 0 && squared < best)
        best = squared, vertex_near[k] = static_cast<std::uint32_t>(v);
    }
  }
  fill_smoothly(grid, nearest, depth);

  const Mat3 rotation = model_to_camera(fit_.q);
  const Pose pose = pose_of(fit_);
  const float focal = camera_of(fit_).f;
  for (int j = 0; j < grid.rows; ++j)
    for (int i = 0; i < grid.columns; ++i) {
      const std::size_t k = grid.index(i, j);
      const auto near = static_cast<int>(nearest[k]);
      const float distance = kTuning.step * length(Vec2{static_cast<float>(i - near % grid.columns),
                                                        static_cast<float>(j - near / grid.columns)});
      const float t = min(distance / kTuning.head_radius, 1);
      const float z = depth[k] + kTuning.behind + kTuning.head_depth * (1 - std::sqrt(max(1 - t * t, 0)));
      const Vec2 x = grid.at(i, j);
      const Vec3 in_camera{(x.x - fit_.c.x) * z / focal, (x.y - fit_.c.y) * z / focal, z};
      nodes_.push_back(
          {x, transposed_product(rotation, in_camera - pose.t), distance, vertex_near[nearest[k]]});
    }
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
      around_.push_back({{number(i, j), number(i + 1, j), number(i, j + 1)}, FacePart::around});
      around_.push_back({{number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)}, FacePart::around});
    }
}

std::vector<TextureVertex> PhotoMesh::face_vertices(const PhotoTurn& turn,
                                                    const std::vector<Vec3>& positions) const {
  const Projector projector(view_of(turn.pose, turn.camera), true), source(fit_, true);
  const std::vector<Vec3> normals = sheet_.normals(positions);
  std::vector<TextureVertex> out(positions.size());
  for (std::size_t k = 0; k < positions.size(); ++k) {
    TextureVertex& v = out[k];
    if (!projector.project(positions[k], &v.x) || !source.project(fitted_[k], &v.texture) ||
        !source.project(positions[k], &v.fixed))
      continue;
    v.inverse_depth = 1 / projector.to_camera(positions[k]).z;
    v.texture = v.texture + bend_[k];
    v.fixed = v.fixed + bend_[k];
    v.light = relit(projector.rotated(normals[k]), turn.light);
  }
  return out;
}

std::vector<TextureVertex> PhotoMesh::surroundings(const PhotoTurn& turn, const std::vector<Vec3>& positions,
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
    const Vec3 p = node.p + follows * (positions[node.nearest] - fitted_[node.nearest]);
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

void PhotoMesh::draw(const PhotoTurn& turn, Cascade& cascade, TextureRaster& raster) const {
  const std::vector<Vec3> positions = sheet_.positions(cascade, turn.q.data());
  raster.clear();
  const std::vector<TextureVertex> face = face_vertices(turn, positions);
  raster.draw(face, sheet_.triangles);
  raster.draw(surroundings(turn, positions, face), around_);
}

float PhotoMesh::grey(const TextureFragment& fragment, const Mipmap& photograph,
                      const Mipmap::Detail& detail) const {
  if (fragment.part == FacePart::skin || fragment.part == FacePart::around)
    return photograph.at(fragment.texture, detail);
  const int x = static_cast<int>(fragment.fixed.x + 0.5f), y = static_cast<int>(fragment.fixed.y + 0.5f);
  const bool is_open = openings_.contains(x, y) && *openings_.at(x, y) != 0;
  if (is_open) return photograph.at(fragment.fixed, detail);
  return fragment.part == FacePart::eye ? photograph.at(fragment.texture, detail) : dark_;
}

Image PhotoMesh::picture(const TextureRaster& raster, const Mipmap& photograph, float scale,
                         const Image& background) const {
  const int samples = raster.samples();
  const Mipmap::Detail detail = photograph.detail_for(1 / (scale * static_cast<float>(samples)));
  Image out = background;
  TextureFragment fragment{};
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) {
      const float behind = static_cast<float>(*background.at(x, y));
      float sum = 0;
      for (int j = y * samples; j < (y + 1) * samples; ++j)
        for (int i = x * samples; i < (x + 1) * samples; ++i) {
          const bool is_drawn = raster.fragment(i, j, &fragment) && fragment.cover > 0;
          sum += is_drawn ? behind + fragment.cover *
                                         (fragment.light * grey(fragment, photograph, detail) - behind)
                          : behind;
        }
      *out.at(x, y) =
          static_cast<std::uint8_t>(clamp(sum / static_cast<float>(samples * samples) + 0.5f, 0, 255));
    }
  return out;
}

}  // namespace pliant::host::learn
