#include "host/render/draw.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>

namespace pliant::host {

namespace {

struct Glyph {
  char character;
  std::uint8_t rows[7];  // five bits a row, the leftmost pixel highest
};

constexpr Glyph kFont[] = {
    {'0', {14, 17, 19, 21, 25, 17, 14}}, {'1', {4, 12, 4, 4, 4, 4, 14}},
    {'2', {14, 17, 1, 6, 8, 16, 31}},    {'3', {30, 1, 1, 14, 1, 1, 30}},
    {'4', {2, 6, 10, 18, 31, 2, 2}},     {'5', {31, 16, 30, 1, 1, 17, 14}},
    {'6', {6, 8, 16, 30, 17, 17, 14}},   {'7', {31, 1, 2, 4, 8, 8, 8}},
    {'8', {14, 17, 17, 14, 17, 17, 14}}, {'9', {14, 17, 17, 15, 1, 2, 12}},
    {'A', {14, 17, 17, 31, 17, 17, 17}}, {'B', {30, 17, 17, 30, 17, 17, 30}},
    {'C', {14, 17, 16, 16, 16, 17, 14}}, {'D', {30, 17, 17, 17, 17, 17, 30}},
    {'E', {31, 16, 16, 30, 16, 16, 31}}, {'F', {31, 16, 16, 30, 16, 16, 16}},
    {'G', {14, 17, 16, 23, 17, 17, 15}}, {'H', {17, 17, 17, 31, 17, 17, 17}},
    {'I', {14, 4, 4, 4, 4, 4, 14}},      {'J', {7, 2, 2, 2, 2, 18, 12}},
    {'K', {17, 18, 20, 24, 20, 18, 17}}, {'L', {16, 16, 16, 16, 16, 16, 31}},
    {'M', {17, 27, 21, 21, 17, 17, 17}}, {'N', {17, 25, 21, 19, 17, 17, 17}},
    {'O', {14, 17, 17, 17, 17, 17, 14}}, {'P', {30, 17, 17, 30, 16, 16, 16}},
    {'Q', {14, 17, 17, 17, 21, 18, 13}}, {'R', {30, 17, 17, 30, 20, 18, 17}},
    {'S', {15, 16, 16, 14, 1, 1, 30}},   {'T', {31, 4, 4, 4, 4, 4, 4}},
    {'U', {17, 17, 17, 17, 17, 17, 14}}, {'V', {17, 17, 17, 17, 17, 10, 4}},
    {'W', {17, 17, 17, 21, 21, 27, 17}}, {'X', {17, 17, 10, 4, 10, 17, 17}},
    {'Y', {17, 17, 10, 4, 4, 4, 4}},     {'Z', {31, 1, 2, 4, 8, 16, 31}},
    {'.', {0, 0, 0, 0, 0, 12, 12}},      {',', {0, 0, 0, 0, 12, 4, 8}},
    {'-', {0, 0, 0, 31, 0, 0, 0}},       {':', {0, 12, 12, 0, 12, 12, 0}},
    {'/', {1, 1, 2, 4, 8, 16, 16}},      {'%', {25, 25, 2, 4, 8, 19, 19}},
    {'=', {0, 0, 31, 0, 31, 0, 0}},      {'+', {0, 4, 4, 31, 4, 4, 0}},
    {'_', {0, 0, 0, 0, 0, 0, 31}},
};

const Glyph* find_glyph(char c) {
  const char wanted = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  for (const Glyph& glyph : kFont)
    if (glyph.character == wanted) return &glyph;
  return nullptr;
}

bool is_near(const Image& image, Vec2 p) {
  const float margin = 4.0f * static_cast<float>(image.width + image.height);
  return is_finite(p) && magnitude(p.x) < margin && magnitude(p.y) < margin;
}

/// Blends the colour into the pixels of the box from `low` to `high`, each by its `coverage`.
template <class Coverage>
void paint(Image& image, Vec2 low, Vec2 high, Colour colour, float opacity, Coverage coverage) {
  const int x0 = std::max(0, static_cast<int>(std::floor(low.x))),
            y0 = std::max(0, static_cast<int>(std::floor(low.y)));
  const int x1 = std::min(image.width - 1, static_cast<int>(std::ceil(high.x)));
  const int y1 = std::min(image.height - 1, static_cast<int>(std::ceil(high.y)));
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) {
      const float fraction = clamp(coverage(Vec2{static_cast<float>(x), static_cast<float>(y)}), 0, 1);
      if (fraction > 0) blend(image, x, y, colour, opacity * fraction);
    }
}

}  // namespace

void blend(Image& image, int x, int y, Colour colour, float opacity) {
  if (!image.contains(x, y)) return;
  std::uint8_t* pixel = image.at(x, y);
  const std::uint8_t target[3] = {colour.r, colour.g, colour.b};
  for (int c = 0; c < image.channels; ++c) {
    const float mixed =
        static_cast<float>(pixel[c]) * (1 - opacity) + static_cast<float>(target[c]) * opacity;
    pixel[c] = static_cast<std::uint8_t>(mixed + 0.5f);
  }
}

void draw_line(Image& image, Vec2 a, Vec2 b, float width, Colour colour, float opacity) {
  if (!is_near(image, a) || !is_near(image, b)) return;
  const float reach = 0.5f * width + 1;
  const Vec2 along = b - a;
  const float squared = dot(along, along);
  paint(image, {min(a.x, b.x) - reach, min(a.y, b.y) - reach}, {max(a.x, b.x) + reach, max(a.y, b.y) + reach},
        colour, opacity, [&](Vec2 p) {
          const float t = squared > 0 ? clamp(dot(p - a, along) / squared, 0, 1) : 0;
          return 0.5f * width + 0.5f - length(p - (a + t * along));
        });
}

void draw_dot(Image& image, Vec2 centre, float radius, Colour colour, float opacity) {
  if (!is_near(image, centre)) return;
  const Vec2 reach{radius + 1, radius + 1};
  paint(image, centre - reach, centre + reach, colour, opacity,
        [&](Vec2 p) { return radius + 0.5f - length(p - centre); });
}

void draw_ring(Image& image, Vec2 centre, float radius, float width, Colour colour, float opacity) {
  if (!is_near(image, centre)) return;
  const Vec2 reach{radius + width, radius + width};
  paint(image, centre - reach, centre + reach, colour, opacity,
        [&](Vec2 p) { return 0.5f * width + 0.5f - magnitude(length(p - centre) - radius); });
}

void fill_box(Image& image, const ImageBox& box, Colour colour, float opacity) {
  for (int j = box.y; j < box.y + box.height; ++j)
    for (int i = box.x; i < box.x + box.width; ++i) blend(image, i, j, colour, opacity);
}

void draw_border(Image& image, int thickness, Colour colour) {
  fill_box(image, {0, 0, image.width, thickness}, colour, 1);
  fill_box(image, {0, image.height - thickness, image.width, thickness}, colour, 1);
  fill_box(image, {0, 0, thickness, image.height}, colour, 1);
  fill_box(image, {image.width - thickness, 0, thickness, image.height}, colour, 1);
}

void draw_text(Image& image, int x, int y, std::string_view text, const TextStyle& style) {
  const int scale = style.scale;
  for (const char c : text) {
    if (const Glyph* glyph = find_glyph(c))
      for (int row = 0; row < kTextHeight; ++row)
        for (int column = 0; column < 5; ++column)
          if ((glyph->rows[row] >> (4 - column)) & 1)
            fill_box(image, {x + column * scale, y + row * scale, scale, scale}, style.colour, style.opacity);
    x += 6 * scale;
  }
}

int text_width(std::string_view text, int scale) {
  return 6 * scale * static_cast<int>(text.size()) - scale;
}

void paste(Image& image, const Image& part, int x, int y) {
  for (int j = 0; j < part.height; ++j)
    for (int i = 0; i < part.width; ++i)
      if (image.contains(x + i, y + j)) std::copy_n(part.at(i, j), part.channels, image.at(x + i, y + j));
}

}  // namespace pliant::host
