#pragma once
/// \file key_frames.hpp
/// Key frames and thumbnails: which views of the head are kept, and where a fast or lost head is now
/// (docs/algorithms.md, sections 7.7 and 7.9).
#include <cstddef>
#include <cstdint>

#include "pliant/coarse_translation.hpp"
#include "pliant/estimator.hpp"
#include "pliant/tracker_limits.hpp"

namespace pliant {

/// Tuning of key frames and of the coarse search. Each constant: unit, reason, experiment.
struct KeyFrameTuning {
  /// A key frame is kept when the head has turned so far away from all key frames, rad. Templates hold for about 20
  /// degrees on either side. Round value, not tuned.
  float angle_rad = 0.35f;
  /// The same when it is so many times as large as in all key frames from its side, or as small: its templates are warped by as
  /// much. With none for scale, films of portraits that shrink by 20 % a second or grow from 25 to 110 px were lost at 2.2 to 3
  /// times the size (docs/experiments.md, Films of portraits with faults). Round value, not tuned.
  float scale_ratio = 1.5f;
  /// Residual above which a key frame is doubtful, px at 320 px of image width. The residual of an unknown
  /// person is above it while the head turns: without key frames from then, 40 of 1,920 frames of turned
  /// heads were lost. Round value, not tuned.
  float doubtful_rms_px = 1;
  /// Inliers of such a frame must be more than this, percent of its observations. Round value, not tuned.
  int least_inlier_percent = 70;
  /// Normalised cross-correlation of thumbnails, at least, for a coarse translation. Round value, not tuned.
  float least_correlation = 0.5f;
  /// Range of the coarse search each way, as divisors of the thumbnail's longer side: after a good frame; after a bad one; from
  /// a key frame, the whole image. With 16 instead of 10, films of faces that jump by an eighth of the width are tracked in
  /// 91 % of their frames instead of all (docs/experiments.md, Films of portraits with faults). The others are round, not tuned.
  int range_divisor = 10, range_divisor_after_bad = 8, range_divisor_of_key = 2;
  /// Bad frames in a row before key frames take part in the search: one bad frame is usually a blur.
  int bad_frames_before_keys = 2;
  /// Normalised cross-correlation of whole thumbnails, in place: after a cut, with the last good frame's at most, and with the
  /// last frame's, whatever that was, at least (docs/experiments.md, Cuts).
  float most_of_another_picture = 0.4f, least_of_same_picture = 0.8f;
};
inline constexpr KeyFrameTuning kKeyFrameTuning{};

/// The head's motion between frames, measured with thumbnails.
struct CoarseMotion {
  bool is_found = false;
  Vec2 by_px;                  ///< translation of the model in the image
  const View* from = nullptr;  ///< the key frame's view that it starts from; null: the last good frame's
  std::uint32_t compared_pixels = 0;  ///< of the thumbnails, in all
};

/// Key frames, frame 0 among them, and thumbnails: this frame's, the last one's, the last good one's, and one a key frame.
class KeyFrames {
 public:
  void lay_out(Arena& arena, const TrackerLimits& limits);
  /// Forgets all key frames.
  void clear() {
    count_ = 0;
    last_shift_ = {};
  }

  /// Reduces a frame to this frame's thumbnail.
  void take(const FrameView& frame);
  /// Compares this frame's thumbnail with the last good one or, after some bad frames, in turn with those of the key
  /// frames. The next call expects the shift that this one has found. \param bad_frames  in a row before this frame.
  CoarseMotion find_motion(int bad_frames);
  /// Whether this frame shows another picture than the last good one did.
  bool shows_another_picture() const {
    return correlation_with(trusted_) <= kKeyFrameTuning.most_of_another_picture;
  }
  /// Whether the last frame showed that other picture, too: the cut is no flash. False without second looks.
  bool is_lasting_cut() const;
  /// Makes this frame the last good one.
  void trust(const Estimator& estimator);
  /// Middle of the model in the image, px, at the estimator's vertices.
  Vec2 middle_of(const Estimator& estimator) const;

  /// Chooses the key frame that this frame replaces: an unused one, or the one that has not been the nearest
  /// for the longest time; from the side of a doubtful one, that one, if this frame is better. Key frame 0,
  /// which is frame 0, is never replaced.
  /// \return its index; 0 if this frame is not to be kept.
  std::size_t choose(const View& view, const FrameResult& result, std::uint32_t frame);
  /// Keeps this frame, which must be tracked well, as key frame k. \param rms_px  its residual.
  void keep(std::size_t k, const View& view, float rms_px, std::uint32_t frame);
  /// Key frames in use.
  std::size_t count() const { return count_; }
  /// The view of key frame k; null if it is not in use.
  const View* view_of(std::size_t k) const { return k < count_ ? &keys_[k].view : nullptr; }
  /// Towards the camera of key frame k, which is in use, in the model's axes; unit.
  Vec3 direction_of(std::size_t k) const { return keys_[k].direction; }
  /// Turns the model in all key frames: q becomes q * turn.
  void turn(Quat turn);

 private:
  struct KeyFrame {
    View view;
    Vec3 direction;           // to the camera, in the model's axes; unit
    PixelBox box;             // of the model in the thumbnail
    std::uint32_t last_near;  // the frame in which it was last the nearest
    bool is_doubtful;
  };

  std::size_t nearest(const View& view, float* cosine) const;
  std::uint8_t* thumbnail_of(std::size_t key) const;
  ImageView view_of_thumbnail(const std::uint8_t* pixels) const { return {pixels, width_, height_, width_}; }
  PixelBox box_of(const Estimator& estimator) const;
  float correlation_with(const std::uint8_t* pixels) const;

  KeyFrame* keys_ = nullptr;
  std::size_t key_count_ = 0, count_ = 0;    // there is room for; in use, the first ones. Frame 0 included
  int factor_ = 1, width_ = 0, height_ = 0;  // of thumbnails
  float doubtful_rms_px_ = 0;
  bool has_room_ = false;  // for templates of later key frames
  std::uint16_t* line_ = nullptr;
  std::uint8_t* recent_[3] = {};  // room for the next three, of which some may be the same
  std::size_t recent_count_ = 0;  // 2: nothing is known of the last frame
  std::uint8_t *current_ = nullptr, *last_ = nullptr, *trusted_ = nullptr;
  std::uint8_t* of_keys_ = nullptr;
  PixelBox trusted_box_;
  Vec2 last_shift_;  // px of the thumbnail: from the last good frame to the last one, as it was found
};

/// How a view shows depth in a key frame.
struct KeyDepths {
  const KeyFrames* keys = nullptr;  ///< null: as nothing
  const View* view = nullptr;
  /// Image of one mm away from the camera of key frame k, px, without perspective.
  Vec2 of(std::size_t k) const;
};

}  // namespace pliant
