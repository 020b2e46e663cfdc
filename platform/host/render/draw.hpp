#pragma once
/// \file draw.hpp
/// Anti-aliased lines, dots, boxes and text. Pixel centres are at integers.
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
  float scale = 1;  ///< px, one seventh of the height of a capital; from 1.3 on letters are easy to read
  Colour colour;
  float opacity = 1;  ///< 0..1
};
/// Draws text (render/stroke_font.hpp); (x, y) is the upper left corner of its first capital.
void draw_text(Image& image, int x, int y, std::string_view text, const TextStyle& style);
/// Width in pixels of a text at that scale.
int text_width(std::string_view text, float scale);
/// Height of a capital at scale 1, px. Descenders reach 2 px further down.
constexpr int kTextHeight = 7;

/// Copies a colour picture to (x, y).
void paste(Image& image, const Image& part, int x, int y);

}  // namespace pliant::host
