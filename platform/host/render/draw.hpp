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
void fill_box(Image& image, int x, int y, int width, int height, Colour colour, float opacity);
/// Draws a border along the edges of the picture.
void draw_border(Image& image, int thickness, Colour colour);

/// Draws text in a 5 x 7 font whose dots are `scale` x `scale` pixels; (x, y) is its upper left corner. All letters are
/// capitals.
void draw_text(Image& image, int x, int y, std::string_view text, int scale, Colour colour,
               float opacity = 1);
/// Width of such a text in pixels.
int text_width(std::string_view text, int scale);
constexpr int kTextHeight = 7;

/// Copies a colour picture to (x, y).
void paste(Image& image, const Image& part, int x, int y);

}  // namespace pliant::host
