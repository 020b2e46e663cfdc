#include "host/render/draw.hpp"

#include <algorithm>
#include <cmath>

#include "host/render/stroke_font.hpp"

namespace pliant::host {

namespace {

/// Width of a stroke of the font, px, at a scale. Chosen by eye, from 1 to 4.
float stroke_width(float scale) {
  return 0.2f + 0.6f * scale;
}
/// Characters begin at whole pixels, so that their stems are equally sharp.
int advance_px(char c, float scale) {
  return static_cast<int>(std::ceil(scale * glyph_of(c).advance));
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
  const float width = stroke_width(style.scale);
  for (const char c : text) {
    const Vec2 origin{static_cast<float>(x), static_cast<float>(y)};
    for (const std::vector<Vec2>& stroke : glyph_of(c).strokes)
      for (std::size_t k = 0; k + 1 < stroke.size(); ++k)
        draw_line(image, origin + style.scale * stroke[k], origin + style.scale * stroke[k + 1], width,
                  style.colour, style.opacity);
    x += advance_px(c, style.scale);
  }
}

int text_width(std::string_view text, float scale) {
  int width = 0;
  for (const char c : text) width += advance_px(c, scale);
  return width;
}

void paste(Image& image, const Image& part, int x, int y) {
  for (int j = 0; j < part.height; ++j)
    for (int i = 0; i < part.width; ++i)
      if (image.contains(x + i, y + j)) std::copy_n(part.at(i, j), part.channels, image.at(x + i, y + j));
}

}  // namespace pliant::host
