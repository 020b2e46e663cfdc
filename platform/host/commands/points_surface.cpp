#include "host/commands/points_surface.hpp"

#include <algorithm>
#include <cmath>

#include "host/io/page.hpp"
#include "host/render/shape_expansion.hpp"
#include "pliant/visibility.hpp"

namespace pliant::host {

namespace {

/// Numbers of the wire's movements, at most: 2 MB of the page.
constexpr std::size_t kMostWireNumbers = 1'500'000;

/// Integers of some bytes each, as little-endian base64.
class Packed {
 public:
  explicit Packed(int bytes) : bytes_(bytes) {}
  void add(long value) {
    for (int k = 0; k < bytes_; ++k) text_ += static_cast<char>(value >> (8 * k) & 255);
  }
  /// Adds vectors as integers, first all x, then all y and all z. \return what one integer stands for.
  float add(const Vec3* begin, std::size_t count) {
    float most = 1e-6f;
    for (std::size_t i = 0; i < count; ++i)
      most = max(most, max(magnitude(begin[i].x), max(magnitude(begin[i].y), magnitude(begin[i].z))));
    const float scale = most / (bytes_ == 1 ? 127.0f : 32767.0f);
    for (float Vec3::*const axis : {&Vec3::x, &Vec3::y, &Vec3::z})
      for (std::size_t i = 0; i < count; ++i) add(std::lround(begin[i].*axis / scale));
    return scale;
  }
  std::string base64() const { return host::base64(text_); }
  /// With every run of zeros as a zero and its length, at most 255: most parameters move a part of the surface only.
  std::string base64_of_runs() const {
    std::string out;
    for (std::size_t i = 0; i < text_.size();) {
      std::size_t length = 0;
      while (length < 255 && i + length < text_.size() && text_[i + length] == 0) ++length;
      out += text_[i];
      if (length > 0) out += static_cast<char>(length);
      i += std::max<std::size_t>(length, 1);
    }
    return host::base64(out);
  }

 private:
  int bytes_;
  std::string text_;
};

/// The points from `first` on. \param bytes  of each number of a movement.
Json packed_points(const ShapeExpansion& shape, std::size_t first, std::size_t count, int bytes) {
  Packed start(2), moves(bytes);
  const float start_scale = start.add(shape.start.data() + first, count);
  Json scales = Json::array();
  for (const ShapeTerm& term : shape.terms) scales.push_back(moves.add(term.move.data() + first, count));
  return Json::object({{"points", count},
                       {"start", start.base64()},
                       {"startScale", start_scale},
                       {"moves", moves.base64_of_runs()},
                       {"moveScales", scales}});
}

std::string packed_corners(const Model& model) {
  Packed corners(2);
  const auto list = model.base_corners();
  for (std::size_t i = 0; i + 2 < list.count; i += 3) {
    const std::uint16_t a = list[i], b = list[i + 1], c = list[i + 2];
    const auto uv = model.base_uv();
    const bool is_turned = doubled_area(uv[a], uv[b], uv[c]) < 0;
    for (const std::uint16_t k : {a, is_turned ? c : b, is_turned ? b : c}) corners.add(k);
  }
  return corners.base64();
}

Json parameters_of(const Model& model, const std::vector<float>& q) {
  Json out = Json::array();
  for (std::size_t k = 0; k < q.size(); ++k) {
    const Parameter& p = model.parameters()[k];
    out.push_back(Json::object(
        {{"name", p.name}, {"value", q[k]}, {"minimum", p.minimum}, {"maximum", p.maximum}, {"sd", p.sd}}));
  }
  return out;
}

/// Moves the origin into the middle of the points. \return where that was.
Vec3 centre(ShapeExpansion* shape) {
  Vec3 sum;
  for (const Vec3 p : shape->start) sum = sum + p;
  const Vec3 middle = (1.0f / static_cast<float>(shape->start.size())) * sum;
  for (Vec3& p : shape->start) p = p - middle;
  return middle;
}

/// The mean normal of the base mesh at the points from `first` on.
Vec3 mean_normal(const Model& model, const std::vector<Vec3>& points, std::size_t first) {
  Vec3 sum;
  const auto list = model.base_corners();
  const auto uv = model.base_uv();
  for (std::size_t i = 0; i + 2 < list.count; i += 3) {
    const Vec3 a = points[first + list[i]], b = points[first + list[i + 1]], c = points[first + list[i + 2]];
    const float side = doubled_area(uv[list[i]], uv[list[i + 1]], uv[list[i + 2]]) < 0 ? 1.0f : -1.0f;
    sum = sum + side * cross(b - a, c - a);
  }
  return normalised(sum);
}

}  // namespace

Json page_surface(const Model& model, const FitFile& start, const std::vector<float>& q,
                  const std::vector<Vec2>& handles) {
  std::vector<Vec2> uv = handles;
  uv.insert(uv.end(), model.base_uv().begin(), model.base_uv().end());
  ShapeExpansion shape = expand_shape(model, uv, q);
  const Vec3 middle = centre(&shape);
  const Vec3 facing = mean_normal(model, shape.start, handles.size());
  const Quat& turn = start.pose.q;
  const Vec3 t = Projector(view_of(start.pose, start.camera), true).to_camera(middle);
  const Camera& c = start.camera;
  Json terms = Json::array();
  for (const ShapeTerm& term : shape.terms)
    terms.push_back({static_cast<int>(term.a), term.b == kNone ? -1 : static_cast<int>(term.b)});
  const std::size_t wire_points = uv.size() - handles.size();
  const bool has_wire = 3 * wire_points * shape.terms.size() <= kMostWireNumbers;
  return Json::object(
      {{"camera",
        Json::object(
            {{"f", c.f}, {"cx", c.cx}, {"cy", c.cy}, {"k1", c.k1}, {"k2", c.k2}, {"aspect", c.aspect}})},
       {"centre", {middle.x, middle.y, middle.z}},
       {"facing", {facing.x, facing.y, facing.z}},
       {"q", {turn.w, turn.x, turn.y, turn.z}},
       {"t", {t.x, t.y, t.z}},
       {"parameters", parameters_of(model, q)},
       {"terms", terms},
       {"handles", packed_points(shape, 0, handles.size(), 2)},
       {"wire", packed_points(shape, handles.size(), has_wire ? wire_points : 0, 1)},
       {"corners", has_wire ? packed_corners(model) : ""}});
}

}  // namespace pliant::host
