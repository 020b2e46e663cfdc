#include "host/bake/paint.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

#include "host/bake/at.hpp"
#include "host/bake/chart_raster.hpp"
#include "host/bake/source_error.hpp"
#include "host/bake/text_table.hpp"
#include "host/io/bounding_box.hpp"
#include "host/io/files.hpp"
#include "host/io/numbers.hpp"

namespace pliant::host::bake {

namespace {

/// Tuning of the painter. Chosen by eye on the built-in face; no experiment.
struct PaintTuning {
  /// Pixels on a side of the result, count: about two a millimetre of a face.
  int side = 384;
  /// Painted pixels along each side of a pixel of the result, count. Averages the edges of spots and hairs.
  int oversampling = 2;
  /// Upper bound of the chart units per millimetre, and a margin in chart units: the part of the chart that a layer visits.
  float chart_per_mm = 0.009f, chart_margin = 0.004f;
  /// Width of the edge of a disc, millimetres.
  float disc_edge_mm = 0.5f;
};
constexpr PaintTuning kTuning{};
constexpr int kSide = kTuning.side, kOversampling = kTuning.oversampling;

struct Layer {
  std::string kind, region;
  std::vector<int> points;  // of the cage
  float size, tone, amount, length, lean;
  unsigned seed;
};

struct Pixel {
  Vec3 position;
  int face;  // of the cage, or -1
  float tone;
};

/// Smooth pseudo-random value in [-1, 1] at a point in space: values at the corners of unit cubes, interpolated.
class Noise {
 public:
  explicit Noise(unsigned seed) : seed_(seed) {}
  float operator()(Vec3 p) {
    const Vec3 base{std::floor(p.x), std::floor(p.y), std::floor(p.z)};
    if (!(base.x == base_.x && base.y == base_.y && base.z == base_.z)) move_to(base);
    const Vec3 f = p - base;
    const auto smooth = [](float t) { return t * t * (3 - 2 * t); };
    const float x[2] = {1 - smooth(f.x), smooth(f.x)}, y[2] = {1 - smooth(f.y), smooth(f.y)},
                z[2] = {1 - smooth(f.z), smooth(f.z)};
    float value = 0;
    for (unsigned k = 0; k < 8; ++k) value += x[k & 1] * y[k >> 1 & 1] * z[k >> 2] * corners_[k];
    return value;
  }

 private:
  /// Another cube. Neighbouring points are mostly in the same one.
  void move_to(Vec3 base) {
    base_ = base;
    for (int k = 0; k < 8; ++k)
      corners_[at(k)] = corner(static_cast<int>(base.x) + (k & 1), static_cast<int>(base.y) + (k >> 1 & 1),
                               static_cast<int>(base.z) + (k >> 2));
  }
  float corner(int x, int y, int z) const {
    unsigned h = seed_ + 0x9e3779b9u * static_cast<unsigned>(x) + 0x85ebca6bu * static_cast<unsigned>(y) +
                 0xc2b2ae35u * static_cast<unsigned>(z);
    h ^= h >> 15;
    h *= 0x2c1b3c6du;
    h ^= h >> 12;
    h *= 0x297a2d39u;
    h ^= h >> 15;
    return static_cast<float>(h & 0xffffu) / 32767.5f - 1;
  }
  unsigned seed_;
  Vec3 base_{std::numeric_limits<float>::quiet_NaN(), 0, 0};  // the last cube; none at first
  std::array<float, 8> corners_{};
};

class Painter {
 public:
  explicit Painter(const Canvas& canvas) : canvas_(canvas), side_(kSide * kOversampling) {
    const ChartRaster raster = rasterise(canvas.uv, canvas.triangles, canvas.is_hole, side_, side_);
    for (const ChartSample& s : raster.samples)
      pixels_.push_back(
          {value_at(s, canvas.position), s.triangle < 0 ? -1 : canvas.fine.cage_face[at(s.triangle / 2)], 0});
  }

  void add(const Layer& layer) {
    random_.seed(layer.seed);
    mark_region(layer.region);
    if (layer.kind == "fill")
      each(0, side_ - 1, 0, side_ - 1, [&](Pixel& p) { blend(p, layer.tone, layer.amount); });
    if (layer.kind == "noise") add_noise(layer);
    if (layer.kind == "shade" || layer.kind == "disc") add_shade(layer);
    if (layer.kind == "spots") add_spots(layer);
    if (layer.kind == "hairs") add_hairs(layer);
  }

  /// True for a patch of the cage, "surface", "hole" and "all".
  bool knows_region(const std::string& name) const {
    if (name == "all" || name == "surface" || name == "hole") return true;
    const auto& faces = canvas_.cage.faces;
    return std::any_of(faces.begin(), faces.end(), [&](const CageFace& f) { return f.patch == name; });
  }

  GreyImage finish() const {
    GreyImage image{kSide, kSide, {}};
    for (int j = 0; j < kSide; ++j)
      for (int i = 0; i < kSide; ++i) {
        float sum = 0;
        for (int dj = 0; dj < kOversampling; ++dj)
          for (int di = 0; di < kOversampling; ++di)
            sum += pixels_[at((kOversampling * j + dj) * side_ + kOversampling * i + di)].tone;
        image.pixels.push_back(static_cast<std::uint8_t>(
            std::lround(std::clamp(sum / (kOversampling * kOversampling), 0.0f, 255.0f))));
      }
    return image;
  }

 private:
  static void blend(Pixel& p, float tone, float opacity) { p.tone += opacity * (tone - p.tone); }

  void mark_region(const std::string& name) {
    in_region_.clear();
    for (const CageFace& f : canvas_.cage.faces)
      in_region_.push_back(name == "all" || (name == "surface" && !f.is_hole) ||
                           (name == "hole" && f.is_hole) || f.patch == name);
    takes_outside_ = name == "all" || name == "surface";
  }

  template <class F>
  void each(int left, int right, int top, int bottom, F f) {
    for (int j = std::max(top, 0); j <= std::min(bottom, side_ - 1); ++j)
      for (int i = std::max(left, 0); i <= std::min(right, side_ - 1); ++i) {
        Pixel& p = pixels_[at(j * side_ + i)];
        if (p.face < 0 ? takes_outside_ : static_cast<bool>(in_region_[at(p.face)])) f(p);
      }
  }

  void add_noise(const Layer& layer) {
    Noise noise(layer.seed);
    each(0, side_ - 1, 0, side_ - 1,
         [&](Pixel& p) { p.tone += layer.amount * noise((1 / layer.size) * p.position); });
  }

  /// Blends towards a tone near a line: with a soft edge ("shade") or a sharp one ("disc").
  void add_shade(const Layer& layer) {
    const auto path = path_through(canvas_.fine, layer.points);
    for (const float side : {1.0f, -1.0f}) {
      std::vector<Vec3> line;
      BoundingBox<Vec2> chart;
      for (int v : path) {
        const Vec3 p = canvas_.position[at(v)];
        line.push_back({side * p.x, p.y, p.z});
        chart.add({side > 0 ? canvas_.uv[at(v)].x : 1 - canvas_.uv[at(v)].x, canvas_.uv[at(v)].y});
      }
      const Vec2 least = chart.low, most = chart.high;
      if (side < 0 && least.x <= 0.5f && most.x >= 0.5f && symmetric(line)) break;
      BoundingBox<Vec3> reached(line);  // the places that the line may reach, mm
      const float beside = 1.01f * layer.size + kTuning.disc_edge_mm;
      reached.low = reached.low - Vec3{beside, beside, beside};
      reached.high = reached.high + Vec3{beside, beside, beside};
      const float reach = layer.size * kTuning.chart_per_mm + kTuning.chart_margin,
                  n = static_cast<float>(side_ - 1);
      each(static_cast<int>((least.x - reach) * n), static_cast<int>((most.x + reach) * n),
           static_cast<int>((least.y - reach) * n), static_cast<int>((most.y + reach) * n), [&](Pixel& p) {
             if (beyond(reached, p.position)) return;
             blend(p, layer.tone, layer.amount * nearness(layer, line, p.position));
           });
    }
  }

  static bool beyond(const BoundingBox<Vec3>& box, Vec3 p) {
    const Vec3 low = box.low, high = box.high;
    return p.x < low.x || p.x > high.x || p.y < low.y || p.y > high.y || p.z < low.z || p.z > high.z;
  }

  static bool symmetric(const std::vector<Vec3>& line) {
    return std::all_of(line.begin(), line.end(), [](Vec3 p) { return p.x == 0; });
  }

  static float nearness(const Layer& layer, const std::vector<Vec3>& line, Vec3 p) {
    float nearest_squared = 1e18f;
    for (std::size_t k = 0; k < line.size(); ++k) {
      const Vec3 a = line[k], b = line[std::min(k + 1, line.size() - 1)];
      const float l2 = dot(b - a, b - a), t = l2 > 0 ? std::clamp(dot(p - a, b - a) / l2, 0.0f, 1.0f) : 0;
      const Vec3 d = p - (a + t * (b - a));
      nearest_squared = std::min(nearest_squared, dot(d, d));
    }
    const float nearest = square_root(nearest_squared);
    if (layer.kind == "disc")
      return std::clamp((layer.size - nearest) / kTuning.disc_edge_mm + 0.5f, 0.0f, 1.0f);
    const float f = std::max(0.0f, 1 - (nearest * nearest) / (layer.size * layer.size));
    return f * f;
  }

  /// Uniform in [0, 1). The distributions of standard libraries differ; this one is the same with all of them.
  float uniform() { return static_cast<float>(random_() >> 8) * 0x1p-24f; }

  /// Draws `amount` spots of up to `size` millimetres at random places of the region.
  void add_spots(const Layer& layer) {
    for (int k = 0; k < static_cast<int>(layer.amount); ++k) {
      const int i = static_cast<int>(uniform() * static_cast<float>(side_)),
                j = static_cast<int>(uniform() * static_cast<float>(side_));
      const float size = layer.size * (0.35f + 0.65f * uniform()),
                  strength = layer.lean * (0.4f + 0.6f * uniform());
      const Pixel& centre = pixels_[at(std::min(j, side_ - 1) * side_ + std::min(i, side_ - 1))];
      if (centre.face < 0 || !in_region_[at(centre.face)]) continue;
      const Vec3 c = centre.position;
      const int reach = static_cast<int>(size * kTuning.chart_per_mm * static_cast<float>(side_)) + 1;
      each(i - reach, i + reach, j - reach, j + reach, [&](Pixel& p) {
        const float d = length(p.position - c) / size;
        if (d < 1) blend(p, layer.tone, strength * (1 - d * d));
      });
    }
  }

  /// Draws `amount` hairs, `length` millimetres long, that start within `size` millimetres of a line. `lean` turns them from
  /// the line's direction (0) to its left (1), which is upwards for a line that runs outwards on the subject's left.
  void add_hairs(const Layer& layer) {
    const auto path = path_through(canvas_.fine, layer.points);
    for (const bool mirrored : {false, true})
      for (int k = 0; k < static_cast<int>(layer.amount); ++k) {
        const float along = uniform() * static_cast<float>(path.size() - 1);
        const std::size_t s = std::min(static_cast<std::size_t>(along), path.size() - 2);
        const Vec2 a = canvas_.uv[at(path[s])], b = canvas_.uv[at(path[s + 1])];
        const float per_mm =
            length(b - a) /
            std::max(0.05f, length(canvas_.position[at(path[s + 1])] - canvas_.position[at(path[s])]));
        const Vec2 forth = (1 / std::max(1e-6f, length(b - a))) * (b - a), left{forth.y, -forth.x};
        // Thick in the middle of the line, thin and short towards its ends.
        const float part = along / static_cast<float>(path.size() - 1),
                    full = std::min(1.0f, 6 * part + 0.55f) * std::min(1.0f, 3 * (1 - part) + 0.25f);
        const float across = layer.size * full * (uniform() + uniform() - 1);
        const float lean = layer.lean * (1 - 0.75f * part) + 0.25f * (uniform() - 0.5f) -
                           0.25f * across / std::max(0.5f, layer.size);
        const Vec2 start = a + (along - static_cast<float>(s)) * (b - a) + (across * per_mm) * left;
        const Vec2 hair = (layer.length * (0.6f + 0.5f * uniform()) * full * per_mm) *
                          ((1 - magnitude(lean)) * forth + lean * left);
        draw_hair(layer, start, start + hair, mirrored);
      }
  }

  void draw_hair(const Layer& layer, Vec2 from, Vec2 to, bool mirrored) {
    const float n = static_cast<float>(side_ - 1);
    const int steps = static_cast<int>(length(to - from) * n) + 1;
    const float strength = 0.35f + 0.4f * uniform();
    for (int s = 0; s <= steps; ++s) {
      const float t = static_cast<float>(s) / static_cast<float>(steps);
      Vec2 p = from + t * (to - from);
      if (mirrored) p.x = 1 - p.x;
      const int i = static_cast<int>(std::lround(p.x * n)), j = static_cast<int>(std::lround(p.y * n));
      each(i, i, j, j, [&](Pixel& q) { blend(q, layer.tone, strength * (1 - 0.6f * t)); });
    }
  }

  const Canvas& canvas_;
  const int side_;
  std::vector<Pixel> pixels_;
  std::vector<char> in_region_;
  bool takes_outside_ = false;
  std::mt19937 random_;
};

Layer layer_of(const TextTable& table, const TextRow& row, const Painter& painter, const Cage& cage) {
  Layer layer{row.cells[0],         row.cells[1],         {},
              table.number(row, 3), table.number(row, 4), table.number(row, 5),
              table.number(row, 6), table.number(row, 7), static_cast<unsigned>(row.line)};
  const auto& kinds = {"fill", "noise", "shade", "disc", "spots", "hairs"};
  if (std::find(kinds.begin(), kinds.end(), layer.kind) == kinds.end())
    table.fail(row, "unknown layer '" + layer.kind + "'");
  if (!painter.knows_region(layer.region)) table.fail(row, "unknown region '" + layer.region + "'");
  const auto check_range = [&](const char* what, float value, float low, float high) {
    if (!(value >= low && value <= high))
      table.fail(row,
                 std::string("the ") + what + " is not from " + short_text(low) + " to " + short_text(high));
  };
  // With these no position, reach or count below leaves the range of an int, and no tone that of a float.
  check_range("tone", layer.tone, 0, 255);
  if (layer.kind == "noise")
    check_range("amount", layer.amount, -255, 255);
  else if (layer.kind != "spots" && layer.kind != "hairs")
    check_range("amount", layer.amount, 0, 1);
  if (layer.kind != "fill") check_range("size", layer.size, 0.01f, 1000);
  if (layer.kind == "spots" || layer.kind == "hairs") check_range("amount", layer.amount, 0, 100000);
  check_range("length", layer.length, 0, 1000);
  check_range("lean", layer.lean, -10, 10);
  if (row.cells[2] == "-") {
    if (layer.kind == "shade" || layer.kind == "disc" || layer.kind == "hairs")
      table.fail(row, "needs points");
    return layer;
  }
  try {
    layer.points = points_of(cage, row.cells[2]);
  } catch (const std::invalid_argument& error) {
    table.fail(row, error.what());
  }
  if (layer.kind == "hairs" && layer.points.size() < 2)
    table.fail(row, "hairs need a line of two points or more");
  return layer;
}

}  // namespace

GreyImage paint(const std::string& folder, const Canvas& canvas) {
  const TextTable table(folder + "/paint.txt",
                        {"layer", "region", "where", "size", "tone", "amount", "length", "lean"});
  Painter painter(canvas);
  for (const TextRow& row : table.rows()) painter.add(layer_of(table, row, painter, canvas.cage));
  return painter.finish();
}

}  // namespace pliant::host::bake
