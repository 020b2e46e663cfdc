#include "host/bench/film_faults.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "host/bench/random.hpp"
#include "host/bench/still_film.hpp"
#include "host/render/scene.hpp"

namespace pliant::host {

namespace {

bool is_during(std::size_t k) {
  return k < kFaultBegins + kFaultFrames;
}

/// 0 at the fault's beginning, 1 at its end.
float progress(std::size_t k) {
  return std::min(static_cast<float>(k - kFaultBegins) / static_cast<float>(kFaultFrames - 1), 1.0f);
}

/// The frame of the clip with each grey level changed, while the fault lasts.
template <class Change>
FaultyFrame changed(const FilmClip& clip, std::size_t k, bool is_faulty, Change&& change) {
  FaultyFrame out{clip.frames[k]};
  if (!is_faulty) return out;
  for (std::uint8_t& pixel : out.picture.pixels)
    pixel = static_cast<std::uint8_t>(std::clamp(change(static_cast<float>(pixel)), 0.0f, 255.0f) + 0.5f);
  return out;
}

/// A background without a face, and the texture of a thing; each is drawn once a size.
const Image& drawn(const Image& like, std::uint32_t seed) {
  static std::map<std::tuple<int, int, std::uint32_t>, Image> all;
  const auto [at, is_new] = all.try_emplace({like.width, like.height, seed});
  if (is_new) at->second = make_background(like.width, like.height, seed);
  return at->second;
}

const Image& empty_scene(const Image& like) {
  return drawn(like, 3);
}

// --- Light ---

FaultyFrame light_step(const FilmClip& clip, std::size_t k, float factor) {
  return changed(clip, k, is_during(k), [&](float grey) { return factor * grey; });
}

FaultyFrame light_ramp(const FilmClip& clip, std::size_t k, float factor) {
  const float now = 1 + progress(k) * (factor - 1);
  return changed(clip, k, true, [&](float grey) { return now * grey; });
}

FaultyFrame flicker(const FilmClip& clip, std::size_t k, float amount) {
  const float now = 1 + (k % 2 == 0 ? amount : -amount);
  return changed(clip, k, is_during(k), [&](float grey) { return now * grey; });
}

/// A lamp that flickers with the mains, seen by a sensor with a rolling shutter.
FaultyFrame bands(const FilmClip& clip, std::size_t k, float amount) {
  FaultyFrame out{clip.frames[k]};
  if (!is_during(k)) return out;
  for (int y = 0; y < out.picture.height; ++y) {
    const float phase =
        1.7f * static_cast<float>(y) / static_cast<float>(out.picture.height) + 0.27f * static_cast<float>(k);
    const float light = 1 + amount * std::sin(6.2832f * phase);
    for (int x = 0; x < out.picture.width; ++x) {
      std::uint8_t* const grey = out.picture.at(x, y);
      *grey = static_cast<std::uint8_t>(std::min(light * *grey + 0.5f, 255.0f));
    }
  }
  return out;
}

FaultyFrame gamma(const FilmClip& clip, std::size_t k, float exponent) {
  return changed(clip, k, is_during(k), [&](float grey) { return 255 * std::pow(grey / 255, exponent); });
}

/// A shadow with a soft edge over one side of the face.
FaultyFrame shadow(const FilmClip& clip, std::size_t k, float factor) {
  FaultyFrame out{clip.frames[k]};
  if (!is_during(k)) return out;
  for (int y = 0; y < out.picture.height; ++y)
    for (int x = 0; x < out.picture.width; ++x) {
      const float across = (static_cast<float>(x) - clip.middle[k].x) / (0.1f * clip.width[k]) + 0.5f;
      const float light = factor + (1 - factor) * std::clamp(across, 0.0f, 1.0f);
      *out.picture.at(x, y) = static_cast<std::uint8_t>(light * *out.picture.at(x, y) + 0.5f);
    }
  return out;
}

// --- Camera ---

FaultyFrame grey_frame(const FilmClip& clip, std::size_t k, float grey) {
  FaultyFrame out = changed(clip, k, is_during(k), [&](float) { return grey; });
  out.has_face = !is_during(k);
  return out;
}

/// Every tenth frame has one grey level.
FaultyFrame grey_flash(const FilmClip& clip, std::size_t k, float grey) {
  FaultyFrame out = changed(clip, k, k % 10 == 0, [&](float) { return grey; });
  out.has_face = k % 10 != 0;
  return out;
}

FaultyFrame missing(const FilmClip& clip, std::size_t k, float count) {
  FaultyFrame out{clip.frames[k]};
  out.is_missing = is_during(k) && static_cast<float>(k % static_cast<std::size_t>(count + 1)) != 0;
  return out;
}

FaultyFrame frozen(const FilmClip& clip, std::size_t k, float) {
  FaultyFrame out{clip.frames[is_during(k) ? kFaultBegins : k]};
  out.is_frozen = is_during(k);
  return out;
}

/// The lower part of the picture is some frames old.
FaultyFrame torn(const FilmClip& clip, std::size_t k, float age) {
  FaultyFrame out{clip.frames[k]};
  if (!is_during(k) || k % 3 != 0) return out;
  const Image& old = clip.frames[k - static_cast<std::size_t>(age)];
  const auto half = static_cast<std::ptrdiff_t>(old.pixels.size() / 2);
  std::copy(old.pixels.begin() + half, old.pixels.end(), out.picture.pixels.begin() + half);
  return out;
}

FaultyFrame wrong_times(const FilmClip& clip, std::size_t k, float seconds) {
  FaultyFrame out{clip.frames[k]};
  if (is_during(k)) out.time_error = static_cast<std::int64_t>((k % 2 == 0 ? seconds : -seconds) * 1e9f);
  return out;
}

FaultyFrame noise(const FilmClip& clip, std::size_t k, float sd) {
  FaultyFrame out{clip.frames[k]};
  if (is_during(k)) add_grey_noise(out.picture, sd, static_cast<std::uint32_t>(k));
  return out;
}

/// Single pixels are black or white.
FaultyFrame broken_pixels(const FilmClip& clip, std::size_t k, float fraction) {
  FaultyFrame out{clip.frames[k]};
  if (!is_during(k)) return out;
  BenchRandom random{static_cast<std::uint32_t>(2 * k + 1)};
  for (std::uint8_t& pixel : out.picture.pixels)
    if (random.unit() < fraction) pixel = random.bits() % 2 == 0 ? 0 : 255;
  return out;
}

/// Means over `side` pixels, along x or along both axes.
FaultyFrame blurred(const FilmClip& clip, std::size_t k, int wide, int high) {
  FaultyFrame out{clip.frames[k]};
  const Image& from = clip.frames[k];
  if (!is_during(k)) return out;
  for (int y = 0; y < from.height; ++y)
    for (int x = 0; x < from.width; ++x) {
      int sum = 0;
      for (int j = 0; j < high; ++j)
        for (int i = 0; i < wide; ++i)
          sum += *from.at(std::clamp(x + i - wide / 2, 0, from.width - 1),
                          std::clamp(y + j - high / 2, 0, from.height - 1));
      *out.picture.at(x, y) = static_cast<std::uint8_t>(sum / (wide * high));
    }
  return out;
}

FaultyFrame out_of_focus(const FilmClip& clip, std::size_t k, float px) {
  return blurred(clip, k, static_cast<int>(px), static_cast<int>(px));
}

FaultyFrame motion_blur(const FilmClip& clip, std::size_t k, float px) {
  return blurred(clip, k, static_cast<int>(px), 1);
}

/// Blocks of 8 x 8 pixels whose contrast is lost, as a starved encoder leaves them.
FaultyFrame blocks(const FilmClip& clip, std::size_t k, float kept) {
  FaultyFrame out{clip.frames[k]};
  if (!is_during(k)) return out;
  Image& p = out.picture;
  for (int top = 0; top + 8 <= p.height; top += 8)
    for (int left = 0; left + 8 <= p.width; left += 8) {
      float mean = 0;
      for (int i = 0; i < 64; ++i) mean += static_cast<float>(*p.at(left + i % 8, top + i / 8)) / 64;
      for (int i = 0; i < 64; ++i) {
        std::uint8_t& pixel = *p.at(left + i % 8, top + i / 8);
        pixel = static_cast<std::uint8_t>(mean + kept * (static_cast<float>(pixel) - mean) + 0.5f);
      }
    }
  return out;
}

// --- What is before the camera ---

/// A textured thing covers a part of the face, from one side, and shakes a little.
FaultyFrame covered(const FilmClip& clip, std::size_t k, float fraction) {
  FaultyFrame out{clip.frames[k]};
  if (!is_during(k)) return out;
  const Image& thing = drawn(out.picture, 9);
  const int right = static_cast<int>(clip.middle[k].x + (fraction - 0.5f) * clip.width[k]) + static_cast<int>(k % 5);
  for (int y = 0; y < out.picture.height; ++y)
    for (int x = 0; x < std::min(right, out.picture.width); ++x) *out.picture.at(x, y) = *thing.at(x, y);
  out.has_face = fraction <= 0.5f;
  return out;
}

/// The camera is pushed aside.
FaultyFrame jump(const FilmClip& clip, std::size_t k, float px) {
  FaultyFrame out{empty_scene(clip.frames[k])};
  out.shift = {px, 0.4f * px};
  lay_over(out.picture, clip.frames[k], static_cast<int>(out.shift.x), static_cast<int>(out.shift.y), 0);
  return out;
}

/// Nobody is there; afterwards the face is seen at another size.
FaultyFrame gone_and_back(const FilmClip& clip, std::size_t k, float scale) {
  const Image& from = clip.frames[k];
  FaultyFrame out{empty_scene(from)};
  out.has_face = !is_during(k);
  if (is_during(k)) return out;
  out.scale = scale;
  const Vec2 size{static_cast<float>(from.width), static_cast<float>(from.height)};
  const Vec2 corner = 0.5f * size - scale * clip.middle[k];  // the face comes to the middle
  out.shift = {std::round(corner.x), std::round(corner.y)};
  lay_over(out.picture, resized(from, scale), static_cast<int>(out.shift.x), static_cast<int>(out.shift.y), 0);
  out.shift = out.shift + Vec2{0.5f * scale - 0.5f, 0.5f * scale - 0.5f};
  return out;
}

}  // namespace

const std::vector<FilmFault>& film_faults() {
  static const std::vector<FilmFault> faults{
      {"none", light_step, 1},
      {"light at 0.3", light_step, 0.3f},
      {"light at 0.6", light_step, 0.6f},
      {"light at 1.5", light_step, 1.5f},
      {"light at 3", light_step, 3},
      {"light falls to 0.3 and stays", light_ramp, 0.3f},
      {"light flickers by 30 %", flicker, 0.3f},
      {"bands of light of 35 %", bands, 0.35f},
      {"gamma 0.5", gamma, 0.5f},
      {"gamma 2", gamma, 2},
      {"shadow over one side", shadow, 0.4f},
      {"black frames", grey_frame, 0},
      {"white frames", grey_frame, 255},
      {"every tenth frame black", grey_flash, 0},
      {"every second frame missing", missing, 1},
      {"two of three frames missing", missing, 2},
      {"picture frozen", frozen, 0},
      {"every third frame torn", torn, 3},
      {"times wrong by 5 s", wrong_times, 5},
      {"noise of 10 grey levels", noise, 10},
      {"noise of 25 grey levels", noise, 25},
      {"2 % of the pixels broken", broken_pixels, 0.02f},
      {"out of focus by 5 px", out_of_focus, 5},
      {"motion blur of 9 px", motion_blur, 9},
      {"blocks with a third of their contrast", blocks, 0.33f},
      {"blocks without contrast", blocks, 0},
      {"a third of the face covered", covered, 0.33f},
      {"half of the face covered", covered, 0.5f},
      {"all of the face covered", covered, 1.2f},
      {"jump by 15 px", jump, 15},
      {"jump by 40 px", jump, 40},
      {"gone and back at 0.4 of the size", gone_and_back, 0.4f},
      {"gone and back at 0.6 of the size", gone_and_back, 0.6f},
      {"gone and back at 0.8 of the size", gone_and_back, 0.8f},
      {"gone and back at 1.2 times the size", gone_and_back, 1.2f},
      {"gone and back at 1.6 times the size", gone_and_back, 1.6f},
      {"gone and back at 2.5 times the size", gone_and_back, 2.5f},
  };
  return faults;
}

}  // namespace pliant::host
