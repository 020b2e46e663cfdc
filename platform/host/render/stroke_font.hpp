#pragma once
/// \file stroke_font.hpp
/// A font of strokes: letters, digits and some signs as lines, which can be drawn at any size.
#include <vector>

#include "pliant/geometry.hpp"

namespace pliant::host {

/// A character. Unit: one seventh of the height of a capital; x to the right, y down, 0 at the top of capitals, 7 at the baseline,
/// 5 the height of small letters, 9 the lowest descender.
struct StrokeGlyph {
  float advance = 0;                       ///< to the next character's origin
  std::vector<std::vector<Vec2>> strokes;  ///< polylines; one of two equal points is a dot
};

/// The glyph of a character; one without strokes and as wide as a blank if the font does not have it. Text is in UTF-8: bytes that
/// continue a character have no width.
const StrokeGlyph& glyph_of(char c);

}  // namespace pliant::host
