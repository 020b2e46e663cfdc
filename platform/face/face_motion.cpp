#include "face/face_motion.hpp"

#include "pliant/coarse_translation.hpp"
#include "pliant/pyramid.hpp"
#include "vision/thumbnail.hpp"

namespace pliant {

namespace {

constexpr const FaceMotionTuning& kTuning = kFaceMotionTuning;

}  // namespace

/// Bands of light that run over the picture are no motion.
void FaceMotion::reduce(const FacePicture& picture, std::uint8_t* out) {
  const ImageView all{picture.pixels(), picture.side(), picture.side(), picture.side()};
  make_thumbnail(frame_of(all), kTuning.factor, line, out);
  level_rows(out, kSide, kSide);
}

Vec2 FaceMotion::since_kept(const FacePicture& picture) {
  constexpr int kEnd = kSide - kTuning.border;
  reduce(picture, now);
  const CoarseTranslation t = find_coarse_translation({kept, kSide, kSide, kSide},
                                                      {kTuning.border, kTuning.border, kEnd, kEnd},
                                                      {now, kSide, kSide, kSide}, kTuning.range);
  if (!(t.correlation > kTuning.least_correlation)) return {};
  return (static_cast<float>(kTuning.factor) * picture.ratio()) * t.by;
}

}  // namespace pliant
