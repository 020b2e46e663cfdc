#pragma once
/// \file draw.hpp
/// Anti-aliased lines, dots, boxes and small text. Pixel centres are at integers.
#include <string_view>

#include "host/io/image.hpp"
#include "pliant/geometry.hpp"

namespace pliant::host {

/// Blends a colour into a pixel; `opacity` from 0 to 1. Pixels outside the picture are ignored.
void blend(Image& image, int x, int y, Colour colour, float opacity);

/// A line with round ends, `width` pixels wide. Ends that are not finite or far outside draw nothing.
void draw_line(Image& image, Vec2 a, Vec2 b, float width, Colour colour, float opacity);
/// A filled disc.
void draw_dot(Image& image, Vec2 centre, float radius, Colour colour, float opacity);
/// A circle line, `width` pixels wide.
void draw_ring(Image& image, Vec2 centre, float radius, float width, Colour colour, float opacity);

/// A rectangle of pixels. (x, y) is its upper left pixel.
struct ImageBox {
  int x, y, width, height;
};
/// Blends a colour into all pixels of a box.
void fill_box(Image& image, const ImageBox& box, Colour colour, float opacity);
/// Draws a border along the edges of the picture.
void draw_border(Image& image, int thickness, Colour colour);

/// How text is drawn.
struct TextStyle {
  int scale = 1;  ///< pixels, width and height of one dot of the font
  Colour colour;
  float opacity = 1;  ///< 0..1
};
/// Draws text in a 5 x 7 font of capitals; (x, y) is its upper left corner.
void draw_text(Image& image, int x, int y, std::string_view text, const TextStyle& style);
/// Width in pixels of a text at that scale.
int text_width(std::string_view text, int scale);
constexpr int kTextHeight = 7;

/// Copies a colour picture to (x, y).
void paste(Image& image, const Image& part, int x, int y);

}  // namespace pliant::host
