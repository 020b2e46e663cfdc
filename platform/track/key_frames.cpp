// Key frames (ALGORITHMS, section 7.7): views of the head from which it looks different, each with patches of its own
// and a small picture to find a lost head by.
#include "track/tracker_sizes.hpp"

namespace pliant {

namespace {

/// Towards the camera, in the model's axes. A turn about the optical axis does not change it.
Vec3 camera_direction(const View& view) {
  const Vec3 towards = rotation_matrix(conjugate(view.q)) * Vec3{0, 0, -1};
  return {towards.x, -towards.y, -towards.z};
}

/// Cosine of an angle from 0 to pi, by four halvings: enough for a threshold.
float cosine_of(float angle) {
  const float a = angle / 16, a2 = a * a;
  float c = 1 - 0.5f * a2 + a2 * a2 / 24;
  for (int k = 0; k < 4; ++k) c = 2 * c * c - 1;
  return c;
}

}  // namespace

std::uint8_t* Tracker::thumbnail_of(std::size_t key) const {
  return key_thumbnails_ + key * static_cast<std::size_t>(thumbnail_width_ * thumbnail_height_);
}

std::size_t Tracker::key_frame_count() const {
  std::size_t n = 0;
  for (const KeyFrame& key : keys_) n += key.is_used;
  return n;
}

/// The model's bounding box in the small picture.
PixelBox Tracker::model_box() const {
  const float share = 1.0f / static_cast<float>(thumbnail_factor_);
  Vec2 low{1e9f, 1e9f}, high{-1e9f, -1e9f};
  for (VertexId v : estimator_.mesh().vertices()) {
    const Vec2 x = estimator_.vertex_seen(v);
    low = {min(low.x, x.x), min(low.y, x.y)};
    high = {max(high.x, x.x), max(high.y, x.y)};
  }
  const auto pixel = [share](float x) { return static_cast<int>(clamp(share * x, -1e4f, 1e4f)); };
  return {pixel(low.x), pixel(low.y), pixel(high.x) + 1, pixel(high.y) + 1};
}

/// Moves the prediction by what the small pictures show: from the last trusted frame, or, after a while without one,
/// from the key frames as well, in turn and over the whole picture.
void Tracker::expect_motion() {
  const ImageView now{thumbnail_, thumbnail_width_, thumbnail_height_, thumbnail_width_};
  const int side = thumbnail_width_ > thumbnail_height_ ? thumbnail_width_ : thumbnail_height_;
  const std::size_t turns = std::size_t{limits_.key_frames} + 2;
  const std::size_t turn = bad_frames_ < 2 ? 0 : static_cast<std::size_t>(bad_frames_ - 1) % turns;
  const bool from_key = turn > 0 && keys_[turn - 1].is_used;
  const int range = from_key ? side / 2 : (bad_frames_ > 0 ? side / 8 : side / 16) + 1;
  const ImageView before{from_key ? thumbnail_of(turn - 1) : trusted_thumbnail_, thumbnail_width_, thumbnail_height_,
                         thumbnail_width_};
  const CoarseTranslation shift = find_coarse_translation(before, from_key ? keys_[turn - 1].box : last_box_, now, range);
  shift_px_ = 1e9f;
  expected_shift_ = {};
  if (shift.correlation < 0.5f) return;
  if (from_key) estimator_.propose(keys_[turn - 1].view);
  expected_shift_ = static_cast<float>(thumbnail_factor_) * shift.by;
  estimator_.translate(expected_shift_);
  if (bad_frames_ == 0) shift_px_ = length(expected_shift_);
}

std::size_t Tracker::nearest_key(Vec3 direction, float* cosine) const {
  std::size_t nearest = 0;
  *cosine = -2;
  for (std::size_t k = 0; k <= limits_.key_frames; ++k) {
    if (!keys_[k].is_used) continue;
    const float c = dot(direction, keys_[k].direction);
    if (c > *cosine) nearest = k;
    *cosine = max(*cosine, c);
  }
  return nearest;
}

bool Tracker::is_worth_keeping() const {
  return result_.rms_px < scaled_px(limits_, 1) && 10 * result_.inliers > 7 * result_.tracked &&
         first_slot(limits_, 1) < slot_count_;
}

/// The one kept for a new view: an unused one, else the one that was the nearest longest ago. Never frame 0.
std::size_t Tracker::free_key() {
  std::size_t oldest = 1;
  for (std::size_t k = 1; k <= limits_.key_frames; ++k) {
    if (!keys_[k].is_used) return k;
    if (keys_[k].last_near < keys_[oldest].last_near) oldest = k;
  }
  return oldest;
}

void Tracker::keep_key_frame() {
  float cosine;
  keys_[nearest_key(camera_direction(estimator_.view()), &cosine)].last_near = frame_;
  if (cosine > cosine_of(options_.key_angle_rad) || !is_worth_keeping()) return;
  capture_key(free_key());
}

void Tracker::describe_key(std::size_t k) {
  keys_[k] = {estimator_.view(), camera_direction(estimator_.view()), model_box(), frame_, true};
  std::uint8_t* const pixels = thumbnail_of(k);
  for (int i = 0; i < thumbnail_width_ * thumbnail_height_; ++i) pixels[i] = thumbnail_[i];
}

void Tracker::capture_key(std::size_t k) {
  const std::size_t end = first_slot(limits_, k + 1);
  std::size_t first = first_slot(limits_, k);
  for (std::size_t s = first; s < end; ++s) release_slot(s);
  describe_key(k);
  first = refresh_templates(first, first + (end - first) / 2);
  seed_patches(first, end);
}

/// Second templates for points that their first template has just found, though it looks different by now: what the
/// point looks like from here, at the place that the first template says.
/// \return the first slot that is still free.
std::size_t Tracker::refresh_templates(std::size_t first, std::size_t end) {
  constexpr float kLooksDifferent = 0.9f;
  for (std::size_t k = 0; k < limits_.patches && first < end; ++k) {
    Slot& slot = slots_[k];
    if (!slot.is_used || !slot.was_seen || slot.second != kNoSlot || slot.frames_apart > 0) continue;
    if (observations_[slot.observation].score > kLooksDifferent) continue;
    const Prediction p = estimator_.predict(slot.id);
    if (!p.visible ||
        patches_.capture(static_cast<int>(first), current_, slot.seen - origin_) != PatchStatus::ok)
      continue;
    Slot fresh;
    fresh.id = slot.id;
    fresh.owner = static_cast<std::uint16_t>(k);
    fresh.reference = p.jacobian;
    fresh.is_used = true;
    slots_[first] = fresh;
    slot.second = static_cast<std::uint16_t>(first++);
  }
  return first;
}

}  // namespace pliant
