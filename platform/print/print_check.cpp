#include "print/print_check.hpp"

#include <cmath>

#include "base/integers.hpp"
#include "print/print_tuning.hpp"
#include "vision/parabola.hpp"

namespace pliant {

namespace {

/// Tuning of the comparison. Chosen on the poster of `fixtures/sheet` with `pliant bench print`, and judged
/// on two other prints (docs/evaluation.md, Start by print). What other values give was not recorded, except where it is told.
struct PrintCheckTuning {
  /// Step of the differences that give the warp of a block, (u,v).
  float step_uv = 0.01f;
  /// Area of a unit of (u,v) in the frame, at least: as a fraction of its squared longer side (a chart may be narrow), and px^2 (so
  /// that the warp has an inverse). The second is a round value, not tuned.
  float least_slant = 0.1f, least_area_px2 = 1;
  /// Standard deviation of a block's samples, at least: of the albedo, and of the frame, grey levels. The first was chosen on the
  /// poster with an eighth of its contrast: with 8 no start is right, with 3 72 % are, with 5 and 2 49 and 65
  /// (docs/experiments.md, Pale prints).
  float least_albedo_sd = 3, least_frame_sd = 2;
  /// Correlation from which on a block agrees. Of 48 blocks at wrong places 2 % reach it.
  float least_correlation = 0.6f;
  /// Standard deviation of a block's place: a fraction of the spacing of its samples, and px.
  float sd_fraction = 0.1f, least_sd_px = 0.1f;
  /// Samples of a block to each side of its middle: 7 x 7 samples. Their number fixes the cost. Not tuned.
  int half = 3;
  /// Samples that a block is searched for to each side of its place. Not tuned.
  int shift = 2;
  /// Cosine of the angle between a surface's normal and a camera that it faces, at least: 75 degrees. Round value, not tuned.
  float least_facing = 0.26f;
  /// Displacement of a block's corner by the curvature of the surface, at most, spacings of its samples: towards a rim the second
  /// order does not tell where the block is seen. Round value, not tuned.
  float most_bend = 1.5f;
};
constexpr PrintCheckTuning kTuning;

constexpr int kHalf = kTuning.half;
constexpr int kSamples = (2 * kHalf + 1) * (2 * kHalf + 1);

/// Index of the nearest of `size` pixels.
int nearest(float x, int size) {
  return within(static_cast<int>(x + 0.5f), 0, size - 1);
}

float albedo_at(const ChartImage& albedo, Vec2 uv) {
  const int x = nearest(clamp(uv.x, 0, 1) * static_cast<float>(albedo.width - 1),
                        static_cast<int>(albedo.width)),
            y = nearest(clamp(uv.y, 0, 1) * static_cast<float>(albedo.height - 1),
                        static_cast<int>(albedo.height));
  return static_cast<float>(
      albedo.pixels[static_cast<std::size_t>(y) * albedo.width + static_cast<std::size_t>(x)]);
}

float grey_at(const FrameView& frame, Vec2 x) {
  const auto column = static_cast<std::size_t>(nearest(x.x, frame.width)),
             row = static_cast<std::size_t>(nearest(x.y, frame.height));
  return static_cast<float>(
      frame.data[row * frame.stride_bytes + column * static_cast<std::size_t>(frame.pixel_step_bytes)]);
}

/// A block: where it is seen, and how (u,v) changes there, per px. The sample that the first order puts d px from the middle is
/// seen where the second order puts it.
struct Block {
  Vec2 uv, x;
  Mat2 uv_per_px;
  Vec2 along[2], bend[3];  // px per px, off the first order; px per px^2: x^2, y^2, xy

  Vec2 place_of(Vec2 d) const {
    return x + d + d.x * (along[0] + d.x * bend[0] + d.y * bend[2]) + d.y * (along[1] + d.y * bend[1]);
  }
};

/// \return false where the surface turns away.
bool make_block(const SurfacePlace& place, Block* block) {
  const Vec2 a{place.px_per_uv.a, place.px_per_uv.c}, b{place.px_per_uv.b, place.px_per_uv.d};
  const float longer = dot(a, a) > dot(b, b) ? dot(a, a) : dot(b, b);
  if (!(determinant(place.px_per_uv) > max(kTuning.least_slant * longer, kTuning.least_area_px2)))
    return false;
  *block = {place.uv, place.x, inverse(place.px_per_uv), {}, {}};
  return true;
}

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

bool find_block(const SurfaceProjection& project, Vec2 uv, Block* block) {
  const float du = uv.x > 0.5f ? -kTuning.step_uv : kTuning.step_uv,
              dv = uv.y > 0.5f ? -kTuning.step_uv : kTuning.step_uv;
  Vec2 x, along_u, along_v;
  if (!project(uv, &x) || !project(uv + Vec2{du, 0}, &along_u) || !project(uv + Vec2{0, dv}, &along_v))
    return false;
  const Vec2 a = (1 / du) * (along_u - x), b = (1 / dv) * (along_v - x);
  return make_block({uv, x, {a.x, b.x, a.y, b.y}}, block);
}

/// The places that blocks are made around: keypoints from all over the table, each round between those of the rounds before. It
/// takes further rounds until as many places face the camera as a round has: of a closed surface less than half do.
class BlockPlaces {
 public:
  BlockPlaces(Span<const PrintKeypoint> keypoints, std::size_t blocks)
      : keypoints_(keypoints), blocks_(smaller(blocks, keypoints.count)) {
    const std::size_t most = kPrintTuning.block_rounds * blocks_;
    count_ = most < keypoints.count ? most : blocks_;
  }

  std::size_t blocks() const { return blocks_; }  ///< Places of a round.
  std::size_t count() const { return count_; }    ///< Places of all rounds.
  Vec2 operator[](std::size_t k) const {
    const std::size_t round = k / blocks_, rounds = count_ / blocks_;
    return keypoints_[(k % blocks_ * rounds + round) * keypoints_.count / count_].uv();
  }

 private:
  Span<const PrintKeypoint> keypoints_;
  std::size_t blocks_, count_;
};

/// Means of 3 x 3 samples of the frame on a grid around the block. \param half  of the grid's side, samples.
void sample_frame(const FrameView& frame, const Block& block, float spacing, int half, float* grey) {
  const float third = spacing / 3;
  for (int j = -half; j <= half; ++j)
    for (int i = -half; i <= half; ++i) {
      const Vec2 x = block.place_of({spacing * static_cast<float>(i), spacing * static_cast<float>(j)});
      float sum = 0;
      for (int k = 0; k < 9; ++k)
        sum += grey_at(frame, x + third * Vec2{static_cast<float>(k % 3 - 1), static_cast<float>(k / 3 - 1)});
      *grey++ = sum * (1.0f / 9) - 128;
    }
}

/// The albedo where the samples of the block are. \return whether there is texture.
bool sample_albedo(const ChartImage& albedo, const Block& block, float spacing, float* expected) {
  const float third = spacing / 3;
  float sum = 0, squares = 0;
  for (int j = -kHalf; j <= kHalf; ++j)
    for (int i = -kHalf; i <= kHalf; ++i) {
      float e = 0;
      for (int k = 0; k < 9; ++k)
        e += albedo_at(albedo, block.uv + block.uv_per_px * Vec2{spacing * static_cast<float>(i) +
                                                                     third * static_cast<float>(k % 3 - 1),
                                                                 spacing * static_cast<float>(j) +
                                                                     third * static_cast<float>(k / 3 - 1)});
      e = e * (1.0f / 9) - 128;
      sum += e;
      squares += e * e;
      *expected++ = e;
    }
  const float variance = (squares - sum * sum / kSamples) / kSamples;
  return variance >= kTuning.least_albedo_sd * kTuning.least_albedo_sd;
}

/// Normalised cross-correlation; 0 where the frame is flat. \param stride  of the frame's grid.
float correlate(const float* grey, int stride, const float* expected) {
  float x = 0, y = 0, xx = 0, xy = 0, yy = 0;
  for (int j = 0; j <= 2 * kHalf; ++j)
    for (int i = 0; i <= 2 * kHalf; ++i) {
      const float a = grey[j * stride + i], b = *expected++;
      x += a, y += b, xx += a * a, xy += a * b, yy += b * b;
    }
  constexpr float kPart = 1.0f / kSamples;
  const float frame_variance = kPart * (xx - kPart * x * x), albedo_variance = kPart * (yy - kPart * y * y);
  if (!(frame_variance >= kTuning.least_frame_sd * kTuning.least_frame_sd)) return 0;
  return kPart * (xy - kPart * x * y) / std::sqrt(frame_variance * albedo_variance);
}

bool agrees(const FrameView& frame, const Block& block, float spacing, const float* expected) {
  float grey[kSamples];
  sample_frame(frame, block, spacing, kHalf, grey);
  return correlate(grey, 2 * kHalf + 1, expected) >= kTuning.least_correlation;
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
    float expected[kSamples];
    if (!find_block(projection, places[k], &block)) continue;
    ++facing;
    if (!is_inside(frame, block.x, reach)) {
      agreement.outside += k < places.blocks();
      continue;
    }
    if (!sample_albedo(albedo, block, block_px, expected)) continue;
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
  float expected[kSamples];
  if (!make_block(place, &block) || !is_inside(frame, block.x, block_px * (kHalf + 0.5f))) return true;
  if (!sample_albedo(model.albedo(), block, block_px, expected)) return false;
  return agrees(frame, block, block_px, expected);
}

namespace {

constexpr int kShift = kTuning.shift, kShifts = 2 * kShift + 1;
constexpr int kWide = 2 * (kHalf + kShift) + 1;  // samples

/// Finds a block near its place. \return false where it does not look like the albedo. Not inlined, for the sake of the
/// caller's stack.
[[gnu::noinline]] bool find_shift(const FrameView& frame, const Block& block, float spacing,
                                  const float* expected, Vec2* shift) {
  float grey[kWide * kWide], score[kShifts * kShifts];
  sample_frame(frame, block, spacing, kHalf + kShift, grey);
  int best = 0;
  for (int k = 0; k < kShifts * kShifts; ++k) {
    score[k] = correlate(grey + k / kShifts * kWide + k % kShifts, kWide, expected);
    if (score[k] > score[best]) best = k;
  }
  const int i = best % kShifts, j = best / kShifts;
  if (score[best] < kTuning.least_correlation || i == 0 || j == 0 || i == 2 * kShift || j == 2 * kShift)
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
    float expected[kSamples];
    Vec2 shift;
    const Vec2 uv = places[k];
    if (!find_block(projection, uv, &block)) continue;
    ++facing;
    if (is_inside(frame, block.x, reach) && sample_albedo(model.albedo(), block, block_px, expected) &&
        bend_block(projection, kHalf * block_px, kTuning.most_bend * block_px, &block) &&
        find_shift(frame, block, block_px, expected, &shift))
      points[count++] = {uv, block.x + block_px * shift, kTuning.sd_fraction * block_px + kTuning.least_sd_px,
                         false};
  }
  return count;
}

}  // namespace pliant
