#include "print/print_motion.hpp"

#include <initializer_list>

#include "base/arrays.hpp"
#include "vision/parabola.hpp"
#include "vision/thumbnail.hpp"

namespace pliant {

namespace {

/// Tuning of motion. Each constant: unit, reason, experiment.
struct MotionTuning {
  /// Columns of a thumbnail, at most: 8 px of a frame of 640 px to a pixel. Round value, not tuned.
  int columns = 100;
  /// Distance of patches, pixels of a thumbnail. They are 7 pixels wide. Round value, not tuned.
  int spacing = 6;
  /// How far a patch is looked for, pixels to each side: of thumbnails 24 px of a frame of 640 px. Not tuned.
  int reach = 3;
  /// Sum of the weights of patches that have been followed, of those around a place, at least. Round value, not tuned.
  float least_weight = 0.5f;
  /// Standard deviation of where a place is found, pixels of the small pictures. Not tuned.
  float sd = 0.5f;
};
constexpr MotionTuning kTuning;
constexpr int kHalf = kBlockTuning.half, kReach = kTuning.reach;

/// Square windows of pixels. Places beside the picture show its rim.
void take_window(const ImageView& image, int x, int y, int half, int row, float* pixels) {
  for (int j = -half; j <= half; ++j, pixels += row) {
    const std::uint8_t* const from =
        image.data +
        static_cast<std::size_t>(within(y + j, 0, image.height - 1)) * static_cast<std::size_t>(image.stride);
    for (int i = -half; i <= half; ++i)
      pixels[i + half] = static_cast<float>(from[within(x + i, 0, image.width - 1)]) - 128;
  }
}

Vec2 whole(int x, int y) {
  return {static_cast<float>(x), static_cast<float>(y)};
}

/// Correlations of what is expected with a window that is wider by `reach` pixels to each side.
template <int kMost>
struct Scores {
  static constexpr int kWide = 2 * (kHalf + kMost) + 1, kSteps = 2 * kMost + 1;
  float window[kWide * kWide + 1];
  const ExpectedBlock& expected;

  Scores(const ImageView& image, int x, int y, const ExpectedBlock& e) : expected(e) {
    window[kWide * kWide] = 0;
    take_window(image, x, y, kHalf + kMost, kWide, window);
  }
  float at(int i, int j) const { return correlate(window + j * kWide + i, kWide, expected); }
  /// Offset of the peak from (i, j), at which the correlation is `best`.
  Vec2 peak(int i, int j, float best) const {
    return {parabola_peak(at(i - 1, j), best, at(i + 1, j)), parabola_peak(at(i, j - 1), best, at(i, j + 1))};
  }
};

/// What is seen at a pixel, to be found elsewhere.
struct Look {
  ExpectedBlock block;
  Vec2 peak;  // where it is found in its own picture, from the pixel: neighbours are not equally like it
};

/// \return whether there is texture.
[[gnu::noinline]] bool take_look(const ImageView& image, int x, int y, Look* look) {
  constexpr int kRow = ExpectedBlock::kRow;
  ExpectedBlock& block = look->block;
  block = {};
  take_window(image, x, y, kHalf, kRow, block.samples);
  float sum = 0, squares = 0;
  for (const float s : block.samples) sum += s;
  for (int j = 0; j < kBlockSide; ++j)
    for (int i = 0; i < kBlockSide; ++i) {
      float& s = block.samples[j * kRow + i];
      s -= sum / kBlockSamples;
      squares += s * s;
    }
  block.variance = squares / kBlockSamples;
  if (!(block.variance >= kBlockTuning.least_sd * kBlockTuning.least_sd)) return false;
  const Scores<1> own(image, x, y, block);
  look->peak = own.peak(1, 1, own.at(1, 1));
  return true;
}

/// Where a look is seen best near (x, y). \return false where nothing looks like it, and at the rim of the search.
[[gnu::noinline]] bool find_near(const ImageView& image, int x, int y, const Look& look, Vec2* found) {
  const Scores<kReach> scores(image, x, y, look.block);
  constexpr int kSteps = Scores<kReach>::kSteps;
  float best = 0;
  int best_i = 0, best_j = 0;
  for (int j = 0; j < kSteps; ++j)
    for (int i = 0; i < kSteps; ++i) {
      const float s = scores.at(i, j);
      if (s > best) best = s, best_i = i, best_j = j;
    }
  if (best < kBlockTuning.least_correlation || best_i == 0 || best_j == 0 || best_i == kSteps - 1 ||
      best_j == kSteps - 1)
    return false;
  *found = whole(x + best_i - kReach, y + best_j - kReach) + scores.peak(best_i, best_j, best) - look.peak;
  return true;
}

}  // namespace

SceneMotion::Grid::Grid(int frame_width, int frame_height)
    : factor(smaller(thumbnail_factor(larger(frame_width, frame_height), kTuning.columns),
                     smaller(frame_width, frame_height))),
      width(frame_width / factor),
      height(frame_height / factor),
      columns((width + kTuning.spacing - 1) / kTuning.spacing),
      rows((height + kTuning.spacing - 1) / kTuning.spacing) {}

std::size_t SceneMotion::patches(int width, int height) {
  const Grid grid(width, height);
  return grid.index_of(0, grid.rows);
}

void SceneMotion::lay_out(Arena& arena, int width, int height) {
  grid_ = Grid(width, height);
  const auto pixels = static_cast<std::size_t>(grid_.width * grid_.height);
  for (Span<std::uint8_t>* p : {&first_, &pixels_[0], &pixels_[1]})
    *p = arena.take_span<std::uint8_t>(pixels);
  line_ = arena.take_span<std::uint16_t>(static_cast<std::size_t>(grid_.factor * grid_.width));
  patches_ = arena.take_span<Patch>(patches(width, height));
}

void SceneMotion::begin(const FrameView& frame) {
  make_thumbnail(frame, grid_.factor, line_.data, first_.data);
  copy(first_.data, first_.count, pixels_[now_].data);
  for (int row = 0; row < grid_.rows; ++row)
    for (int column = 0; column < grid_.columns; ++column)
      patches_[grid_.index_of(column, row)] = {
          whole(kTuning.spacing * column, kTuning.spacing * row), {}, true};
}

void SceneMotion::follow(const FrameView& frame) {
  const ImageView before = view_of(pixels_[now_]);
  now_ = 1 - now_;
  make_thumbnail(frame, grid_.factor, line_.data, pixels_[now_].data);
  const ImageView now = view_of(pixels_[now_]);
  for (Patch& patch : patches_) {
    if (!patch.is_followed) continue;
    const int x = nearest(patch.moved.x, grid_.width), y = nearest(patch.moved.y, grid_.height);
    const Vec2 expected = whole(x, y) + patch.step;
    Look look;
    Vec2 found;
    patch.is_followed =
        take_look(before, x, y, &look) &&
        find_near(now, nearest(expected.x, grid_.width), nearest(expected.y, grid_.height), look, &found);
    if (!patch.is_followed) continue;
    patch.step = found - whole(x, y);
    patch.moved = patch.moved + patch.step;
  }
}

bool SceneMotion::moved(Vec2 x, Vec2* to) const {
  const float part = 1 / static_cast<float>(grid_.factor * kTuning.spacing);
  const Vec2 at{clamp(part * x.x, 0, static_cast<float>(grid_.columns - 1)),
                clamp(part * x.y, 0, static_cast<float>(grid_.rows - 1))};
  const int column = static_cast<int>(at.x), row = static_cast<int>(at.y);
  float sum = 0;
  Vec2 by;
  for (int k = 0; k < 4; ++k) {
    const int i = smaller(column + k % 2, grid_.columns - 1), j = smaller(row + k / 2, grid_.rows - 1);
    const Patch& patch = patches_[grid_.index_of(i, j)];
    if (!patch.is_followed) continue;
    const float weight = (1 - magnitude(at.x - static_cast<float>(column + k % 2))) *
                         (1 - magnitude(at.y - static_cast<float>(row + k / 2)));
    sum += weight;
    by = by + weight * (patch.moved - static_cast<float>(kTuning.spacing) * whole(i, j));
  }
  if (sum < kTuning.least_weight) return false;
  *to = x + static_cast<float>(grid_.factor) / sum * by;
  return true;
}

float SceneMotion::sd_px() const {
  return kTuning.sd * static_cast<float>(grid_.factor);
}

SmallPictures SceneMotion::pictures() const {
  return {view_of(first_), view_of(pixels_[now_]), static_cast<float>(grid_.factor)};
}

std::size_t match_scene(const SceneMotion& motion, const PrintTable& table, const SurfaceProjection& before,
                        Span<Correspondence> points) {
  const BlockPlaces places(table.keypoints(), smaller(points.count, kPrintTuning.blocks));
  std::size_t facing = 0, count = 0;
  for (std::size_t k = 0; k < places.count() && facing < places.blocks(); ++k) {
    Block block;
    Vec2 to;
    if (!find_block(before, places[k], &block)) continue;
    ++facing;
    if (motion.moved(block.x, &to)) points[count++] = {block.uv, to, motion.sd_px(), false};
  }
  return count;
}

std::size_t match_pictures(const SmallPictures& pictures, const PrintTable& table,
                           const SurfaceProjection& before, const SurfaceProjection& expected,
                           Span<Correspondence> points) {
  const BlockPlaces places(table.keypoints(), smaller(points.count, kPrintTuning.blocks));
  const ImageView &first = pictures.before, &now = pictures.now;
  const float part = 1 / pictures.scale;
  std::size_t facing = 0, count = 0;
  for (std::size_t k = 0; k < places.count() && facing < places.blocks(); ++k) {
    Block block;
    Look look;
    Vec2 to, found;
    if (!find_block(before, places[k], &block)) continue;
    ++facing;
    const int x = nearest(part * block.x.x, first.width), y = nearest(part * block.x.y, first.height);
    if (!expected(block.uv, &to) || !take_look(first, x, y, &look) ||
        !find_near(now, nearest(part * to.x, now.width), nearest(part * to.y, now.height), look, &found))
      continue;
    points[count++] = {block.uv, block.x + pictures.scale * (found - whole(x, y)),
                       kTuning.sd * pictures.scale, false};
  }
  return count;
}

}  // namespace pliant
