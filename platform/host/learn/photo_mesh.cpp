#include "host/learn/photo_mesh.hpp"

namespace pliant::host::learn {

namespace {

struct PhotoMeshTuning {
  /// Chart of a face, mm across.
  float chart_mm = 200;
  /// Distance from a landmark within which the photograph is drawn to the model's landmark fully, and in which that ends, mm.
  float full_mm = 1, fade_mm = 30;
  /// Larger differences than this, mm, are errors of the annotation.
  float most_mm = 10;
  /// Brightness of the inside of an opened mouth over that of the face. Chosen by eye.
  float dark = 0.22f;
  /// Radius of an iris, and of what its motion moves in the photograph: beyond, the white of the eye is compressed, mm.
  float iris_mm = 6.2f, moved_mm = 15;
  /// Radius of an eyeball, mm.
  float ball_mm = 12;
  /// Distance from the edge of the face in which a second person's skin fades in, mm.
  float mixed_mm = 25;
};
constexpr PhotoMeshTuning kTuning{};

}  // namespace

PhotoMesh::PhotoMesh(const Photograph& photograph, const FaceSheet& sheet, Cascade& cascade)
    : sheet_(sheet), fit_(view_of(photograph.pose, photograph.camera)), pupils_(photograph.pupils) {
  fitted_ = sheet.positions(cascade, photograph.q.data());
  bend(photograph, cascade);
  mark_openings(photograph);
  relief_ = PhotoRelief(photograph.picture, fit_, sheet, fitted_);
}

void PhotoMesh::bend(const Photograph& photograph, Cascade& cascade) {
  const auto landmarks = cascade.model().landmarks();
  const Projector projector(fit_, true);
  struct Residual {
    Vec2 uv, d;
  };
  std::vector<Residual> residuals;
  const float limit = kTuning.most_mm * fit_.s;
  for (std::size_t k = 0; k < photograph.landmarks.size(); ++k) {
    const Vec2 uv = landmarks[k].uv();
    Vec2 x;
    if (photograph.trust[k] == kTrustNone ||
        !projector.project(cascade.surface_point(uv, photograph.q.data()), &x))
      continue;
    const Vec2 d = photograph.landmarks[k] - x;
    const float size = length(d);
    residuals.push_back({uv, size > limit ? limit / size * d : d});
  }
  const float floor = kTuning.full_mm / kTuning.chart_mm, fade = kTuning.fade_mm / kTuning.chart_mm;
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
  texture_.resize(fitted_.size());
  for (std::size_t k = 0; k < fitted_.size(); ++k)
    if (projector.project(fitted_[k], &texture_[k])) texture_[k] = texture_[k] + bend_[k];
}

void PhotoMesh::mark_openings(const Photograph& photograph) {
  openings_ = Image(photograph.picture.width, photograph.picture.height, 1);
  const Projector projector(fit_, true);
  std::vector<TextureVertex> vertices(fitted_.size());
  for (std::size_t k = 0; k < fitted_.size(); ++k) {
    vertices[k].x = texture_[k];
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
  mean_ = count > 0 ? max(sum / count, 8) : 128;
}

std::vector<TextureVertex> PhotoMesh::face_vertices(const PhotoTurn& turn,
                                                    const std::vector<Vec3>& positions) const {
  const Projector projector(view_of(turn.pose, turn.camera), true), source(fit_, true);
  const std::vector<Vec3> normals = sheet_.normals(positions);
  std::vector<TextureVertex> out(positions.size());
  for (std::size_t k = 0; k < positions.size(); ++k) {
    TextureVertex& v = out[k];
    if (!projector.project(positions[k], &v.x) || !source.project(positions[k], &v.fixed)) continue;
    v.inverse_depth = 1 / projector.to_camera(positions[k]).z;
    v.texture = texture_[k];
    v.fixed = v.fixed + bend_[k];
    v.light = relit(projector.rotated(normals[k]), turn.light);
    if (turn.second == nullptr) continue;
    v.second = turn.second->texture_[k];
    v.second_weight = turn.second_weight * smooth_step(0, kTuning.mixed_mm, sheet_.edge_mm[k]);
  }
  return out;
}

void PhotoMesh::draw(const PhotoTurn& turn, Cascade& cascade, TextureRaster& raster) const {
  const std::vector<Vec3> positions = sheet_.positions(cascade, turn.q.data());
  const std::vector<TextureVertex> face = face_vertices(turn, positions);
  std::vector<Vec3> moved;
  for (std::size_t k = 0; k < positions.size(); ++k) moved.push_back(positions[k] - fitted_[k]);
  raster.clear();
  raster.draw(face, sheet_.triangles);
  raster.draw(relief_.vertices(turn, moved, face), relief_.triangles());
}

/// Where the photograph shows what is at x when the irises are moved by `gaze`, px.
Vec2 PhotoMesh::iris_source(Vec2 x, Vec2 gaze) const {
  const float iris = kTuning.iris_mm * fit_.s, reach = kTuning.moved_mm * fit_.s;
  for (const int side : {0, 1}) {
    const float distance = length(x - pupils_.x[side] - gaze);
    if (pupils_.trust[side] == kTrustNone || distance >= reach) continue;
    return x - clamp((reach - distance) / (reach - iris), 0, 1) * gaze;
  }
  return x;
}

float PhotoMesh::eye_or_mouth(const TextureFragment& fragment, const Mipmap& photograph,
                              const Mipmap::Detail& detail, Vec2 gaze) const {
  // Eyeballs and upper teeth stay where they are while lids and lips move.
  const auto is_open = [&](Vec2 at) {
    const int x = static_cast<int>(at.x + 0.5f), y = static_cast<int>(at.y + 0.5f);
    return openings_.contains(x, y) && *openings_.at(x, y) != 0;
  };
  if (fragment.part == FacePart::eye && dot(gaze, gaze) > 0) {
    const Vec2 from = iris_source(fragment.fixed, gaze);
    if (is_open(from)) return photograph.at(from, detail);
    // What a lid covers of an iris is what is opposite.
    for (const Vec2 pupil : pupils_.x)
      if (length(from - pupil) < kTuning.iris_mm * fit_.s && is_open(2 * pupil - from))
        return photograph.at(2 * pupil - from, detail);
  }
  if (is_open(fragment.fixed)) return photograph.at(fragment.fixed, detail);
  return fragment.part == FacePart::eye ? photograph.at(fragment.texture, detail) : kTuning.dark * mean_;
}

Image PhotoMesh::picture(const PhotoTurn& turn, const TextureRaster& raster,
                         const std::array<const Mipmap*, 2>& pictures, const Image& background) const {
  const int samples = raster.samples();
  const float scale = view_of(turn.pose, turn.camera).s * static_cast<float>(samples);
  const Mipmap::Detail detail = pictures[0]->detail_for(fit_.s / scale);
  const bool has_second = turn.second != nullptr && pictures[1] != nullptr;
  const Mipmap::Detail second_detail =
      has_second ? pictures[1]->detail_for(turn.second->fit_.s / scale) : detail;
  const float gain = has_second ? mean_ / turn.second->mean_ : 1;
  const auto grey = [&](const TextureFragment& f) {
    if (f.part == FacePart::eye || f.part == FacePart::mouth)
      return eye_or_mouth(f, *pictures[0], detail, fit_.s * turn.gaze_mm);
    const float own = pictures[0]->at(f.texture, detail);
    if (!has_second || f.second_weight <= 0) return own;
    return own + f.second_weight * (gain * pictures[1]->at(f.second, second_detail) - own);
  };
  Image out = background;
  TextureFragment fragment{};
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) {
      const float behind = static_cast<float>(*background.at(x, y));
      float sum = 0;
      for (int j = y * samples; j < (y + 1) * samples; ++j)
        for (int i = x * samples; i < (x + 1) * samples; ++i) {
          const bool is_drawn = raster.fragment(i, j, &fragment) && fragment.cover > 0;
          sum += is_drawn ? behind + fragment.cover * (fragment.light * grey(fragment) - behind) : behind;
        }
      *out.at(x, y) =
          static_cast<std::uint8_t>(clamp(sum / static_cast<float>(samples * samples) + 0.5f, 0, 255));
    }
  return out;
}

Pupils PhotoMesh::pupils(const PhotoTurn& turn, Cascade& cascade, const TextureRaster& raster) const {
  Pupils out;
  const Model& model = cascade.model();
  const Projector source(fit_, true), projector(view_of(turn.pose, turn.camera), true);
  for (const int side : {0, 1}) {
    const std::uint16_t eye = model.find_landmark(side == 0 ? "eye_right" : "eye_left");
    Vec2 rest;
    if (pupils_.trust[side] == kTrustNone || eye == kNone) continue;
    const Vec2 uv = model.landmarks()[eye].uv();
    const Vec3 middle = cascade.surface_point(uv, turn.q.data());
    if (!source.project(middle, &rest)) continue;
    std::size_t nearest = 0;
    for (std::size_t k = 0; k < sheet_.uv.size(); ++k)
      if (length(sheet_.uv[k] - uv) < length(sheet_.uv[nearest] - uv)) nearest = k;
    // Beside the middle of the eyeball in the plane of the photograph, then back to the ball.
    const Vec2 seen = pupils_.x[side] + fit_.s * turn.gaze_mm - bend_[nearest] - rest;
    const auto& axes = model_to_camera(fit_.q).m;
    const Vec2 mm = 1 / fit_.s * seen;
    const auto along = [&](int axis) { return axes[0][axis] * mm.x + axes[1][axis] * mm.y; };
    const Vec3 aside{along(0), along(1), along(2)}, forward{0, 0, kTuning.ball_mm};
    const Vec3 pupil = middle - forward + kTuning.ball_mm * normalised(aside + forward);
    if (!projector.project(pupil, &out.x[side])) continue;
    TextureFragment fragment{};
    const int samples = raster.samples();
    const auto at = [&](float x) { return static_cast<int>((x + 0.5f) * static_cast<float>(samples)); };
    const Vec2 x = out.x[side];
    const bool is_inside = x.x >= 0 && x.y >= 0 && at(x.x) < raster.columns() && at(x.y) < raster.rows();
    if (is_inside && raster.fragment(at(x.x), at(x.y), &fragment) && fragment.part == FacePart::eye)
      out.trust[side] = pupils_.trust[side];
  }
  return out;
}

}  // namespace pliant::host::learn
