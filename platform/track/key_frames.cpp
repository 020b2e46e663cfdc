#include "track/key_frames.hpp"

#include "base/extent.hpp"
#include "base/integers.hpp"
#include "track/tracker_sizes.hpp"
#include "vision/thumbnail.hpp"

namespace pliant {

namespace {

constexpr const KeyFrameTuning& kTuning = kKeyFrameTuning;

/// Cosine of an angle from 0 to pi, by four halvings: enough for a threshold.
constexpr float cosine_of(float angle) {
  const float a = angle / 16, a2 = a * a;
  float c = 1 - 0.5f * a2 + a2 * a2 / 24;
  for (int k = 0; k < 4; ++k) c = 2 * c * c - 1;
  return c;
}

}  // namespace

Vec2 KeyDepths::of(std::size_t k) const {
  if (keys == nullptr || keys->view_of(k) == nullptr) return {};
  const Vec3 towards = Projector(*view, true).rotated(keys->direction_of(k));
  return -view->s * Vec2{towards.x, towards.y};
}

void KeyFrames::lay_out(Arena& arena, const TrackerLimits& limits) {
  key_count_ = std::size_t{limits.key_frames} + 1;
  doubtful_rms_px_ = scaled_px(limits, kTuning.doubtful_rms_px);
  has_room_ = first_slot(limits, 1) < all_slots(limits);
  factor_ = thumbnail_factor(limits.width, limits.thumbnail_width);
  width_ = limits.width / factor_;
  height_ = limits.height / factor_;
  const std::size_t pixels = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  arena.count_as(Purpose::thumbnails);
  keys_ = arena.take<KeyFrame>(key_count_);
  line_ = arena.take<std::uint16_t>(static_cast<std::size_t>(width_ * factor_));
  // Cuts are of films. A microcontroller, whose limits leave out second looks, too, has a camera of its own.
  recent_count_ = limits.second_look != nullptr ? 3 : 2;
  for (std::size_t k = 0; k < recent_count_; ++k) recent_[k] = arena.take<std::uint8_t>(pixels);
  current_ = last_ = trusted_ = recent_[0];
  of_keys_ = arena.take<std::uint8_t>(key_count_ * pixels);
}

std::uint8_t* KeyFrames::thumbnail_of(std::size_t key) const {
  return of_keys_ + key * static_cast<std::size_t>(width_ * height_);
}

void KeyFrames::turn(Quat turn) {
  for (std::size_t k = 0; k < count_; ++k) {
    keys_[k].view.q = normalised(keys_[k].view.q * turn);
    keys_[k].direction = camera_direction(keys_[k].view);
  }
}

void KeyFrames::take(const FrameView& frame) {
  last_ = recent_count_ > 2 ? current_ : trusted_;
  for (std::size_t k = 0; k < recent_count_; ++k)
    if (recent_[k] != last_ && recent_[k] != trusted_) current_ = recent_[k];
  make_thumbnail(frame, factor_, line_, current_);
  level_rows(current_, width_, height_);
}

void KeyFrames::trust(const Estimator& estimator) {
  trusted_box_ = box_of(estimator);
  trusted_ = current_;
}

/// The model's bounding box in the thumbnail.
PixelBox KeyFrames::box_of(const Estimator& estimator) const {
  const float fraction = 1.0f / static_cast<float>(factor_);
  Extent e;
  for (VertexId v : estimator.mesh().vertices()) e.include(estimator.vertex_seen(v));
  const auto pixel = [fraction](float x) { return static_cast<int>(clamp(fraction * x, -1e4f, 1e4f)); };
  return {pixel(e.low.x), pixel(e.low.y), pixel(e.high.x) + 1, pixel(e.high.y) + 1};
}

Vec2 KeyFrames::middle_of(const Estimator& estimator) const {
  const PixelBox box = box_of(estimator);
  const float half = 0.5f * static_cast<float>(factor_);
  return {half * static_cast<float>(box.x0 + box.x1), half * static_cast<float>(box.y0 + box.y1)};
}

CoarseMotion KeyFrames::find_motion(int bad_frames) {
  const int side = larger(width_, height_);
  // Turn 0 is the last good frame's, turn k + 1 that of key frame k.
  const std::size_t turn = bad_frames < kTuning.bad_frames_before_keys
                               ? 0
                               : static_cast<std::size_t>(bad_frames - 1) % (key_count_ + 1);
  const KeyFrame* const key = turn > 0 && turn <= count_ ? &keys_[turn - 1] : nullptr;
  const int divisor = bad_frames > 0 ? kTuning.range_divisor_after_bad : kTuning.range_divisor;
  const int range = key != nullptr ? side / kTuning.range_divisor_of_key : side / divisor + 1;
  const CoarseTranslation shift =
      find_coarse_translation(view_of_thumbnail(key != nullptr ? thumbnail_of(turn - 1) : trusted_),
                              key != nullptr ? key->box : trusted_box_, view_of_thumbnail(current_), range,
                              key != nullptr ? nullptr : &last_shift_);
  last_shift_ = key != nullptr ? Vec2{} : shift.by;
  if (shift.correlation < kTuning.least_correlation) return {false, {}, nullptr, shift.compared_pixels};
  return {true, static_cast<float>(factor_) * shift.by, key != nullptr ? &key->view : nullptr,
          shift.compared_pixels};
}

/// Of this frame's thumbnail and another one, as wholes and in place.
float KeyFrames::correlation_with(const std::uint8_t* pixels) const {
  return find_coarse_translation(view_of_thumbnail(pixels), {0, 0, width_, height_},
                                 view_of_thumbnail(current_), 0)
      .correlation;
}

bool KeyFrames::is_lasting_cut() const {
  return last_ != trusted_ && shows_another_picture() &&
         correlation_with(last_) >= kTuning.least_of_same_picture;
}

/// Of those at a similar scale. \param cosine  out: -2 if there is none.
std::size_t KeyFrames::nearest(const View& view, float* cosine) const {
  const Vec3 direction = camera_direction(view);
  std::size_t nearest = 0;
  *cosine = -2;
  for (std::size_t k = 0; k < count_; ++k) {
    const float at = keys_[k].view.s;
    if (view.s > kTuning.scale_ratio * at || at > kTuning.scale_ratio * view.s) continue;
    const float c = dot(direction, keys_[k].direction);
    if (!(c > *cosine)) continue;
    nearest = k;
    *cosine = c;
  }
  return nearest;
}

std::size_t KeyFrames::choose(const View& view, const FrameResult& result, std::uint32_t frame) {
  constexpr float kNear = cosine_of(kTuning.angle_rad);
  float cosine;
  const std::size_t near = nearest(view, &cosine);
  keys_[near].last_near = frame;
  if (!has_room_ || 100 * result.inliers <= kTuning.least_inlier_percent * result.tracked) return 0;
  if (cosine > kNear) return keys_[near].is_doubtful && result.rms_px < doubtful_rms_px_ ? near : 0;
  if (count_ < key_count_) return count_;
  std::size_t oldest = 1;
  for (std::size_t k = 2; k < key_count_; ++k)
    if (keys_[k].last_near < keys_[oldest].last_near) oldest = k;
  return oldest;
}

void KeyFrames::keep(std::size_t k, const View& view, float rms_px, std::uint32_t frame) {
  PLIANT_ASSERT(k < key_count_ && k <= count_);
  if (k == count_) ++count_;
  keys_[k] = {view, camera_direction(view), trusted_box_, frame, rms_px >= doubtful_rms_px_};
  std::uint8_t* const pixels = thumbnail_of(k);
  for (int i = 0; i < width_ * height_; ++i) pixels[i] = trusted_[i];
}

}  // namespace pliant
