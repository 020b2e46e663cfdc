#pragma once
/// \file film_faults.hpp
/// What goes wrong with films: light, cameras, occluders, and faces that leave. Each fault changes the frames of a good film
/// for a while, so that the same frames without it are the truth.
#include <cstdint>
#include <vector>

#include "host/io/image.hpp"
#include "pliant/geometry.hpp"

namespace pliant::host {

/// A part of a film and where the face is in it.
struct FilmClip {
  std::vector<Image> frames;  ///< grey, of one size
  std::vector<Vec2> middle;   ///< of the face in each frame, px
  std::vector<float> width;   ///< of the face in each frame, px
};

/// A fault begins in this frame of a clip and ends after `kFaultFrames` more; the frames up to `kClipFrames` show what comes
/// after it.
constexpr std::size_t kFaultBegins = 20, kFaultFrames = 60, kClipFrames = 120;

/// What the camera gives instead of frame k of a clip.
struct FaultyFrame {
  Image picture;
  bool is_missing = false;      ///< the camera gives nothing
  bool has_face = true;         ///< most of the face is to be seen, so that the track may be right
  float scale = 1;              ///< a pixel x of the clip's frame is seen at scale * x + shift
  Vec2 shift{};                 ///< px
  std::int64_t time_error = 0;  ///< ns
  bool is_frozen = false;       ///< it shows the clip's frame kFaultBegins
};

/// A fault by name, and the frames that it makes. Equal calls give equal frames on every machine.
struct FilmFault {
  const char* name;
  /// \param k     number of the frame in the clip, from kFaultBegins.
  /// \param value as below.
  FaultyFrame (*make)(const FilmClip& clip, std::size_t k, float value);
  float value;  ///< strength: a factor of light or size, grey levels, pixels, ...
};

/// All of them.
const std::vector<FilmFault>& film_faults();

}  // namespace pliant::host
