#include "host/bake/print_keypoints.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "host/bake/print_views.hpp"
#include "host/io/bounding_box.hpp"
#include "host/io/table_checksum.hpp"
#include "print/descriptor.hpp"
#include "print/print_tuning.hpp"

namespace pliant::host::bake {

namespace {

/// Tuning of the keypoints. Each constant: unit, reason, experiment.
struct PrintKeypointTuning {
  int cells = 96;               ///< of the surface that is drawn, a side: flat enough for a picture
  /// Diagonal of the surface at the finest level, px: a round value. With 644, 656 and 672 as many starts of small sheets are
  /// right, within what chance does (docs/experiments.md, Start by print).
  float most_side_px = 640;
  int least_side_px = 60;       ///< and at the coarsest
  float level_ratio = 1.4142f;  ///< of scales: a descriptor stands 20 % of change
  /// Diagonals of the surface, px, at which corners are also described with half a patch: in a small print a whole one reaches
  /// beyond the surface. Without, the poster is found in 1 of 8 at a height of 66 px, with in 6. 226 instead of 160 finds less on
  /// another print: the table has too many.
  float least_half_side_px = 40, most_half_side_px = 160;
  /// Keypoints of a picture of the first view, at least as many as there is room for. Those of other views share the table.
  std::size_t frontal = 180;
  std::size_t most = 3000;  ///< of the table: 120 kB
  std::size_t least = 16;   ///< of a table that is of use
  /// Fraction of the corners that look like no other place, at least: of checkerboards, bricks and waves 0.08 to 0.15, of blotches
  /// and of a label with little on it 0.28 to 0.35, of posters and photographs 0.7 and more.
  float least_own = 0.2f;
  float most_beyond = 0.25f;  ///< fraction of a patch that may lie beyond the surface
  /// From every keypoint elsewhere on the surface: of noise, some 30 bits differ. Where less than this fraction is left, it is the
  /// second: else of blotches 0.08 are left, as of a checkerboard, and a photograph 53 px high is found in 6 of 8 instead of all.
  /// For all prints the second loses bent ones (poster: 14 of 20 instead of 18).
  int least_difference_bits = 48, least_difference_bits_of_plain = 32;
  float plain = 0.5f;
};
constexpr PrintKeypointTuning kTuning;

struct SurfaceSize {
  float extent_mm, albedo_px_per_mm;
};

SurfaceSize size_of(const SurfaceSheet& sheet, const ChartImage& albedo) {
  BoundingBox<Vec3> box;
  float area = 0, chart = 0;
  sheet.for_each_triangle([&](std::size_t a, std::size_t b, std::size_t c) {
    if (!sheet.is_used(a) || !sheet.is_used(b) || !sheet.is_used(c)) return;
    const Vec3 p = sheet.position(a);
    for (const std::size_t k : {a, b, c}) box.add(sheet.position(k));  // none has its first point in the last row
    area += 0.5f * length(cross(sheet.position(b) - p, sheet.position(c) - p));
    chart += 0.5f / static_cast<float>(sheet.cells() * sheet.cells());
  });
  const float pixels = chart * static_cast<float>(albedo.width) * static_cast<float>(albedo.height);
  return {length(box.size()), std::sqrt(pixels / std::max(area, 1e-12f))};
}

std::vector<float> levels_of(const SurfaceSize& size) {
  std::vector<float> levels;
  float side = std::min(kTuning.most_side_px, size.albedo_px_per_mm * size.extent_mm);
  for (; side >= static_cast<float>(kTuning.least_side_px) && levels.size() < kMostPrintLevels;
       side /= kTuning.level_ratio)
    levels.push_back(side / size.extent_mm);
  return levels;
}

/// Fraction of the patch around a pixel that shows no surface.
float beyond_surface(const PrintPicture& picture, int x, int y, int reach) {
  int beyond = 0, count = 0;
  for (int dy = -reach; dy <= reach; ++dy)
    for (int dx = -reach; dx <= reach; ++dx, ++count) {
      const int i = x + dx, j = y + dy;
      const bool is_inside = i >= 0 && j >= 0 && i < picture.grey.width && j < picture.grey.height;
      if (!is_inside || picture.uv[static_cast<std::size_t>(j * picture.grey.width + i)].x < 0) ++beyond;
    }
  return static_cast<float>(beyond) / static_cast<float>(count);
}

void add_keypoints(const PrintPicture& picture, PatchScale patch, std::size_t view, std::size_t level,
                   std::size_t most, std::vector<PrintKeypoint>& keypoints) {
  const ImageView image{picture.grey.pixels.data(), picture.grey.width, picture.grey.height,
                        picture.grey.width};
  const CornerOptions options = print_corner_options();
  std::vector<ArenaLine> room(corner_scratch_bytes(image.width, image.height, options) / sizeof(ArenaLine) +
                              1);
  Arena scratch(room.data(), room.size() * sizeof(ArenaLine));
  std::vector<Corner> corners(4 * most);
  int found = 0;
  if (find_corners(image, options, {}, scratch, {corners.data(), corners.size()}, found) != Status::ok)
    return;
  corners.resize(static_cast<std::size_t>(found));
  std::size_t count = 0;
  for (const Corner& c : corners) {
    const int x = static_cast<int>(c.x.x), y = static_cast<int>(c.x.y);
    const Vec2 uv = picture.uv[static_cast<std::size_t>(y * image.width + x)];
    Descriptor d;
    if (uv.x < 0 || beyond_surface(picture, x, y, descriptor_reach(patch)) > kTuning.most_beyond ||
        !describe(image, x, y, patch, &d))
      continue;
    PrintKeypoint k{};
    k.u = static_cast<std::uint16_t>(std::lround(65535 * clamp(uv.x, 0, 1)));
    k.v = static_cast<std::uint16_t>(std::lround(65535 * clamp(uv.y, 0, 1)));
    k.cosine = static_cast<std::int8_t>(std::lround(127 * d.direction.x));
    k.sine = static_cast<std::int8_t>(std::lround(127 * d.direction.y));
    k.view = static_cast<std::uint8_t>(view);
    k.level = static_cast<std::uint8_t>(level);
    std::copy(std::begin(d.bits), std::end(d.bits), std::begin(k.bits));
    keypoints.push_back(k);
    if (++count == most) break;
  }
}

/// Without keypoints that look like another place of the surface, whatever its level.
std::vector<PrintKeypoint> without_repeated(const std::vector<PrintKeypoint>& keypoints, int least_bits) {
  std::vector<PrintKeypoint> kept;
  for (const PrintKeypoint& k : keypoints) {
    const bool is_repeated = std::any_of(keypoints.begin(), keypoints.end(), [&](const PrintKeypoint& other) {
      return length(other.uv() - k.uv()) > kPrintTuning.same_place &&
             distance_of(k.bits, other.bits) < least_bits;
    });
    if (!is_repeated) kept.push_back(k);
  }
  return kept;
}

/// What tells the surface's places apart; nothing if that is too little.
std::vector<PrintKeypoint> own_of(const std::vector<PrintKeypoint>& all) {
  const auto count = static_cast<float>(all.size());
  auto own = without_repeated(all, kTuning.least_difference_bits);
  if (static_cast<float>(own.size()) < kTuning.plain * count)
    own = without_repeated(all, kTuning.least_difference_bits_of_plain);
  if (static_cast<float>(own.size()) < kTuning.least_own * count) own.clear();
  return own;
}

/// As many as a table holds, evenly from all of them. They are in the order of the views: without its end, views would be missing.
std::vector<PrintKeypoint> thinned(const std::vector<PrintKeypoint>& all) {
  if (all.size() <= kTuning.most) return all;
  std::vector<PrintKeypoint> kept;
  for (std::size_t k = 0; k < kTuning.most; ++k) kept.push_back(all[k * all.size() / kTuning.most]);
  return kept;
}

template <class T>
void append(std::vector<std::uint8_t>& bytes, const std::vector<T>& records) {
  const auto* const first = reinterpret_cast<const std::uint8_t*>(records.data());
  bytes.insert(bytes.end(), first, first + records.size() * sizeof(T));
}

std::vector<std::uint8_t> written(const std::vector<Quat>& views, const std::vector<float>& levels,
                                  const std::vector<PrintKeypoint>& keypoints, float extent_mm) {
  std::vector<std::uint8_t> bytes(sizeof(PrintHeader));
  append(bytes, views);
  append(bytes, levels);
  append(bytes, keypoints);
  const PrintHeader h{kPrintMagic,
                      static_cast<std::uint32_t>(bytes.size()),
                      0,
                      static_cast<std::uint16_t>(keypoints.size()),
                      static_cast<std::uint16_t>(views.size()),
                      static_cast<std::uint16_t>(levels.size()),
                      0,
                      extent_mm};
  std::memcpy(bytes.data(), &h, sizeof h);
  set_checksum<PrintHeader>(bytes);
  return bytes;
}

}  // namespace

std::vector<std::uint8_t> make_print_table(const Model& model) {
  const ChartTexture texture(model);
  SurfaceSheet sheet(model, texture, kTuning.cells);
  const std::vector<float> q(model.parameters().count + 1, 0.0f);
  sheet.set(q.data());
  const SurfaceSize size = size_of(sheet, model.albedo());
  const std::vector<Quat> views = choose_print_views(sheet);
  const std::vector<float> levels = levels_of(size);
  std::vector<PrintKeypoint> keypoints;
  const std::size_t each = kTuning.most / std::max<std::size_t>(1, views.size() * levels.size());
  for (std::size_t view = 0; view < views.size(); ++view)
    for (std::size_t level = 0; level < levels.size(); ++level) {
      const std::size_t most = view == 0 ? std::max(each, kTuning.frontal) : each;
      const auto add = [&](PatchScale patch, float scale) {
        add_keypoints(draw_print(sheet, texture, views[view], scale, size.albedo_px_per_mm), patch, view,
                      level, most, keypoints);
      };
      add(PatchScale::whole, levels[level]);
      const float half_side = 0.5f * levels[level] * size.extent_mm;
      if (half_side <= kTuning.most_half_side_px && half_side >= kTuning.least_half_side_px)
        add(PatchScale::half, 0.5f * levels[level]);
    }
  keypoints = thinned(own_of(keypoints));
  if (keypoints.size() < kTuning.least || views.empty() || levels.empty()) return {};
  return written(views, levels, keypoints, size.extent_mm);
}

}  // namespace pliant::host::bake
