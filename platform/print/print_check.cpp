#include "print/print_check.hpp"

#include "print/print_tuning.hpp"
#include "vision/parabola.hpp"

namespace pliant {

namespace {

/// Tuning of the comparison. Chosen on the poster of `fixtures/sheet` with `pliant bench print`, and judged
/// on two other prints (docs/evaluation.md, Start by print). What other values give was not recorded, except where it is told.
struct PrintCheckTuning {
  /// Standard deviation of a block's samples of the albedo, at least, grey levels. It was chosen on the poster with an eighth of
  /// its contrast: with 8 no start is right, with 3 72 % are, with 5 and 2 49 and 65 (docs/experiments.md, Pale prints).
  float least_albedo_sd = 3;
  /// Standard deviation of a block's place: a fraction of the spacing of its samples, and px.
  float sd_fraction = 0.1f, least_sd_px = 0.1f;
  /// Samples that a block is searched for to each side of its place. Not tuned.
  int shift = 2;
  /// Cosine of the angle between a surface's normal and a camera that it faces, at least: 75 degrees. Round value, not tuned.
  float least_facing = 0.26f;
  /// Displacement of a block's corner by the curvature of the surface, at most, spacings of its samples: towards a rim the second
  /// order does not tell where the block is seen. Round value, not tuned.
  float most_bend = 1.5f;
};
constexpr PrintCheckTuning kTuning;

constexpr int kHalf = kBlockTuning.half, kSide = kBlockSide, kSamples = kBlockSamples;

/// The same of x - by, x and x + by.
struct NearestThree {
  std::size_t at[3];
  NearestThree(float x, float by, int size) {
    for (int k = 0; k < 3; ++k)
      at[k] = static_cast<std::size_t>(nearest(x + static_cast<float>(k - 1) * by, size));
  }
};

/// Fits the second order to where the surface is seen at the block's sides and one corner. \param reach  from the middle to a side,
/// px. \return false where a side is not seen, or too far from where a plane would have it.
bool bend_block(const SurfaceProjection& project, float reach, float most_px, Block* block) {
  constexpr Vec2 kSides[] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}};
  Vec2 off[5];  // from the first order
  for (int k = 0; k < 5; ++k) {
    const Vec2 d = reach * kSides[k];
    if (!project(block->uv + block->uv_per_px * d, &off[k])) return false;
    off[k] = off[k] - block->x - d;
  }
  const Vec2 x = 0.5f * (off[0] - off[1]), xx = 0.5f * (off[0] + off[1]), y = 0.5f * (off[2] - off[3]),
             yy = 0.5f * (off[2] + off[3]), xy = off[4] - x - xx - y - yy;
  const float side = 1 / reach, square = side * side;
  block->along[0] = side * x, block->along[1] = side * y;
  block->bend[0] = square * xx, block->bend[1] = square * yy, block->bend[2] = square * xy;
  const float farthest = length(x) + length(xx) + length(y) + length(yy) + length(xy);
  return farthest <= most_px;
}

/// Means of 3 x 3 samples of the frame on a grid around the block. \param half  of the grid's side, samples.
void sample_frame(const FrameView& frame, const Block& block, float spacing, int half, float* grey) {
  const float third = spacing / 3;
  for (int j = -half; j <= half; ++j)
    for (int i = -half; i <= half; ++i) {
      const Vec2 x = block.place_of({spacing * static_cast<float>(i), spacing * static_cast<float>(j)});
      const NearestThree columns(x.x, third, frame.width), rows(x.y, third, frame.height);
      int sum = 0;
      for (const std::size_t row : rows.at)
        for (const std::size_t column : columns.at)
          sum +=
              frame
                  .data[row * frame.stride_bytes + column * static_cast<std::size_t>(frame.pixel_step_bytes)];
      *grey++ = static_cast<float>(sum) * (1.0f / 9) - 128;
    }
}

/// Means of 3 x 3 nearest pixels. \return whether there is texture.
bool sample_albedo(const ChartImage& albedo, const Block& block, float spacing, ExpectedBlock* expected) {
  constexpr int kReach = 3 * kHalf + 1;  // to each side, thirds of a sample
  const float right = static_cast<float>(static_cast<int>(albedo.width) - 1),
              bottom = static_cast<float>(static_cast<int>(albedo.height) - 1), third = spacing / 3;
  const Mat2& m = block.uv_per_px;
  const Vec2 along_row{third * right * m.a, third * bottom * m.c},
      along_column{third * right * m.b, third * bottom * m.d};
  const Vec2 middle{right * block.uv.x + 0.5f, bottom * block.uv.y + 0.5f};
  const auto pixel = [&](Vec2 x) -> int {
    const int column = static_cast<int>(clamp(x.x, 0, right)), row = static_cast<int>(clamp(x.y, 0, bottom));
    return albedo.pixels[static_cast<std::size_t>(row) * albedo.width + static_cast<std::size_t>(column)];
  };
  int sums[kSamples] = {};
  for (int j = 0; j < 3 * kSide; ++j) {
    const Vec2 first = middle + static_cast<float>(j - kReach) * along_column;
    for (int i = 0; i < kSide; ++i)
      for (int k = 0; k < 3; ++k)
        sums[j / 3 * kSide + i] += pixel(first + static_cast<float>(3 * i + k - kReach) * along_row);
  }
  int sum = 0;
  for (const int s : sums) sum += s;
  const float mean = static_cast<float>(sum) / kSamples;
  float squares = 0;
  for (int j = 0; j < kSide; ++j)
    for (int i = 0; i < ExpectedBlock::kRow; ++i) {
      const float e = i < kSide ? (static_cast<float>(sums[j * kSide + i]) - mean) * (1.0f / 9) : 0;
      squares += e * e;
      expected->samples[j * ExpectedBlock::kRow + i] = e;
    }
  expected->variance = squares / kSamples;
  return expected->variance >= kTuning.least_albedo_sd * kTuning.least_albedo_sd;
}

bool agrees(const FrameView& frame, const Block& block, float spacing, const ExpectedBlock& expected) {
  float grey[kSamples + 1];
  grey[kSamples] = 0;
  sample_frame(frame, block, spacing, kHalf, grey);
  return correlate(grey, kSide, expected) >= kBlockTuning.least_correlation;
}

/// Whether another part of the surface is in front of the middle or of a corner of the block.
bool is_hidden(const SurfaceProjection& projection, const Block& block, float reach) {
  constexpr Vec2 kPlaces[] = {{0, 0}, {-1, -1}, {1, -1}, {-1, 1}, {1, 1}};
  if (projection.shows == nullptr) return false;
  for (const Vec2 place : kPlaces) {
    const Vec2 d = reach * place;
    if (!projection.shows(projection.state, block.uv + block.uv_per_px * d, block.place_of(d))) return true;
  }
  return false;
}

bool is_inside(const FrameView& frame, Vec2 x, float reach) {
  return x.x >= reach && x.y >= reach && x.x < static_cast<float>(frame.width) - reach &&
         x.y < static_cast<float>(frame.height) - reach;
}

}  // namespace

PrintAgreement compare_print(const FrameView& frame, const Model& model, const PrintTable& table,
                             const SurfaceProjection& projection, float block_px, PrintHistory* history) {
  PrintAgreement agreement;
  const ChartImage albedo = model.albedo();
  const BlockPlaces places(table.keypoints(), kPrintTuning.blocks);
  const float reach = block_px * (kHalf + 0.5f);
  std::size_t facing = 0;
  for (std::size_t k = 0; k < places.count() && facing < places.blocks(); ++k) {
    Block block;
    ExpectedBlock expected;
    if (!find_block(projection, places[k], &block)) continue;
    ++facing;
    if (!is_inside(frame, block.x, reach)) {
      agreement.outside += k < places.blocks();
      continue;
    }
    if (!sample_albedo(albedo, block, block_px, &expected)) continue;
    // Most surfaces are flat enough for the first order, which costs less.
    bool is_agreed = agrees(frame, block, block_px, expected);
    if (!is_agreed) {
      if (!bend_block(projection, kHalf * block_px, kTuning.most_bend * block_px, &block)) continue;
      is_agreed = agrees(frame, block, block_px, expected);
      if (!is_agreed && is_hidden(projection, block, kHalf * block_px)) continue;
    }
    ++agreement.visible;
    agreement.agreed += is_agreed;
    if (history == nullptr) continue;
    if (is_agreed) history->add(k);
    agreement.agreed_once += history->has(k);
  }
  return agreement;
}

int PrintHistory::first_round_count() const {
  int count = 0;
  for (std::size_t k = 0; k < kPrintTuning.blocks; ++k) count += has(k);
  return count;
}

FacingAtRest facing_at_rest(const PrintTable& table, Cascade& cascade, const float* q, const Pose& pose) {
  const BlockPlaces places(table.keypoints(), kPrintTuning.blocks);
  // Of the model's origin before the camera, in axes that are the model's but for the signs of y and z.
  const Vec3 t = rotation_matrix(conjugate(pose.q)) * pose.t;
  const Vec3 camera{-t.x, t.y, t.z};
  Vec3 normal[kPrintTuning.blocks];
  FacingAtRest facing;
  facing.places = static_cast<int>(places.blocks());
  for (std::size_t k = 0; k < places.blocks(); ++k) {
    const SurfaceFrame frame = cascade.surface_frame(places[k], q);
    normal[k] = normalised(cross(frame.pv, frame.pu));
    facing.in_view += dot(normal[k], normalised(camera - frame.p)) >= kTuning.least_facing;
  }
  for (std::size_t i = 0; i < places.blocks(); ++i) {
    int count = 0;
    for (std::size_t k = 0; k < places.blocks(); ++k)
      count += dot(normal[i], normal[k]) >= kTuning.least_facing;
    facing.most = count > facing.most ? count : facing.most;
  }
  return facing;
}

bool shows_print(const FrameView& frame, const Model& model, const SurfacePlace& place, float block_px) {
  Block block;
  ExpectedBlock expected;
  if (!make_block(place, &block) || !is_inside(frame, block.x, block_px * (kHalf + 0.5f))) return true;
  if (!sample_albedo(model.albedo(), block, block_px, &expected)) return false;
  return agrees(frame, block, block_px, expected);
}

namespace {

constexpr int kShift = kTuning.shift, kShifts = 2 * kShift + 1;
constexpr int kWide = 2 * (kHalf + kShift) + 1;  // samples

/// Finds a block near its place. \return false where it does not look like the albedo. Not inlined, for the sake of the
/// caller's stack.
[[gnu::noinline]] bool find_shift(const FrameView& frame, const Block& block, float spacing,
                                  const ExpectedBlock& expected, Vec2* shift) {
  float grey[kWide * kWide + 1], score[kShifts * kShifts];
  grey[kWide * kWide] = 0;
  sample_frame(frame, block, spacing, kHalf + kShift, grey);
  int best = 0;
  for (int k = 0; k < kShifts * kShifts; ++k) {
    score[k] = correlate(grey + k / kShifts * kWide + k % kShifts, kWide, expected);
    if (score[k] > score[best]) best = k;
  }
  const int i = best % kShifts, j = best / kShifts;
  if (score[best] < kBlockTuning.least_correlation || i == 0 || j == 0 || i == 2 * kShift || j == 2 * kShift)
    return false;
  *shift = {static_cast<float>(i - kShift) + parabola_peak(score[best - 1], score[best], score[best + 1]),
            static_cast<float>(j - kShift) +
                parabola_peak(score[best - kShifts], score[best], score[best + kShifts])};
  return true;
}

}  // namespace

std::size_t match_blocks(const FrameView& frame, const Model& model, const PrintTable& table,
                         const SurfaceProjection& projection, float block_px, Span<Correspondence> points) {
  const BlockPlaces places(table.keypoints(), points.count);
  const float reach = block_px * (kHalf + kShift + 0.5f);
  std::size_t facing = 0, count = 0;
  for (std::size_t k = 0; k < places.count() && facing < places.blocks(); ++k) {
    Block block;
    ExpectedBlock expected;
    Vec2 shift;
    const Vec2 uv = places[k];
    if (!find_block(projection, uv, &block)) continue;
    ++facing;
    if (is_inside(frame, block.x, reach) && sample_albedo(model.albedo(), block, block_px, &expected) &&
        bend_block(projection, kHalf * block_px, kTuning.most_bend * block_px, &block) &&
        find_shift(frame, block, block_px, expected, &shift))
      points[count++] = {uv, block.x + block_px * shift, kTuning.sd_fraction * block_px + kTuning.least_sd_px,
                         false};
  }
  return count;
}

}  // namespace pliant
