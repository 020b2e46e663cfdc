#include "host/render/stroke_font.hpp"

#include <array>

namespace pliant::host {

namespace {

/// A point is two digits, x and y, in half units: 0 to 9, then a to i. Strokes are separated by blanks. A stroke that begins with ~
/// is a smooth curve through its points, one that begins with & a closed one.
struct Source {
  char character;
  const char* strokes;
};
constexpr Source kSources[] = {
    {'A', "0e408e 1a7a"},
    {'B', "4e0e0040 ~40717546 0646 ~46878d4e"},
    {'C', "~835013071b5e8b"},
    {'D', "3e0e0030 ~3073877b3e"},
    {'E', "70000e7e 0666"},
    {'F', "70000e 0666"},
    {'G', "~835013071b5e8b 8b8858"},
    {'H', "000e 808e 0686"},
    {'I', "000e"},
    {'J', "505a ~5a4d2e0c"},
    {'K', "000e 7008 357e"},
    {'L', "000e7e"},
    {'M', "0e004a808e"},
    {'N', "0e008e80"},
    {'O', "&4072877c4e1c0712"},
    {'P', "0e0040 ~40818647 4707"},
    {'Q', "&4072877c4e1c0712 5b8f"},
    {'R', "0e0040 ~40818647 4707 478e"},
    {'S', "~824003478b4e0c"},
    {'T', "0080 404e"},
    {'U', "000a ~0a1d4e7d8a 8a80"},
    {'V', "004e80"},
    {'W', "003e527ea0"},
    {'X', "008e 800e"},
    {'Y', "004780 474e"},
    {'Z', "00800e8e"},
    {'a', "&3455695d3e1d0915 646e"},
    {'b', "000e &3455695d3e1d0915"},
    {'c', "~663415091d3e6c"},
    {'d', "&3455695d3e1d0915 606e"},
    {'e', "0969 ~69553415091d3e6c"},
    {'f', "~503123 232e 0444"},
    {'g', "&3455695d3e1d0915 646f ~6f4i1h"},
    {'h', "000e ~08254467 676e"},
    {'i', "040e 0101"},
    {'j', "242f ~2f1i0i 2121"},
    {'k', "000e 540a 285e"},
    {'l', "000c ~0c1e2e"},
    {'m', "040e ~08244456 565e ~587494a6 a6ae"},
    {'n', "040e ~08254467 676e"},
    {'o', "&3455695d3e1d0915"},
    {'p', "040i &3455695d3e1d0915"},
    {'q', "646i &3455695d3e1d0915"},
    {'r', "040e ~082544"},
    {'s', "~553406395b3e0d"},
    {'t', "212b ~2b3e5e 0444"},
    {'u', "040a ~0a1d3e5d6a 646e"},
    {'v', "043e64"},
    {'w', "042e466e84"},
    {'x', "046e 640e"},
    {'y', "043e 641i"},
    {'z', "04640e6e"},
    {'0', "&3052675c3e1c0712"},
    {'1', "14303e"},
    {'2', "~033063480e 0e6e"},
    {'3', "~02306336 ~366a3e0c"},
    {'4', "4e400a6a"},
    {'5', "601006 ~06356a3e0c"},
    {'6', "~50140a &36576a5d3e1d0a17"},
    {'7', "00602e"},
    {'8', "&305155361511 &36576a5d3e1d0a17"},
    {'9', "&3051645738170411 ~645a1e"},
    {'.', "0e0e"},
    {',', "1e0g"},
    {':', "0606 0e0e"},
    {'-', "0949"},
    {'/', "0f50"},
    {'%', "&21432503 &89ab8d6b 2e80"},
    {'=', "0666 0a6a"},
    {'+', "0969 363c"},
    {'_', "0g6g"},
    {'(', "~20072g"},
    {')', "~00270g"},
    {'<', "64096e"},
    {'>', "04690e"},
    {'\'', "0003"},
};
constexpr float kBlank = 3, kSpacing = 1.8f, kDigit = 3;
/// Lines for each piece of a curve. Enough at 40 px.
constexpr int kPieces = 4;

float coordinate(char digit) {
  return 0.5f * static_cast<float>(digit <= '9' ? digit - '0' : digit - 'a' + 10);
}

/// Catmull and Rom's curve through the points.
std::vector<Vec2> smooth(const std::vector<Vec2>& p, bool is_closed) {
  const auto count = static_cast<int>(p.size());
  const auto at = [&](int i) {
    const int k = is_closed ? (i + count) % count : i < 0 ? 0 : i >= count ? count - 1 : i;
    return p[static_cast<std::size_t>(k)];
  };
  std::vector<Vec2> out{p.front()};
  for (int i = 0; i < (is_closed ? count : count - 1); ++i)
    for (int k = 1; k <= kPieces; ++k) {
      const float t = static_cast<float>(k) / kPieces, s = t * t, c = s * t;
      out.push_back(0.5f * ((2 * s - t - c) * at(i - 1) + (2 - 5 * s + 3 * c) * at(i) +
                            (t + 4 * s - 3 * c) * at(i + 1) + (c - s) * at(i + 2)));
    }
  return out;
}

StrokeGlyph parsed(const Source& source) {
  StrokeGlyph glyph;
  float widest = source.character >= '0' && source.character <= '9' ? kDigit : 0;
  for (const char* at = source.strokes; *at != '\0';) {
    const char kind = *at;
    if (kind == '~' || kind == '&') ++at;
    std::vector<Vec2> points;
    for (; *at != '\0' && *at != ' '; at += 2) points.push_back({coordinate(at[0]), coordinate(at[1])});
    for (const Vec2 p : points) widest = max(widest, p.x);
    glyph.strokes.push_back(kind == '~' || kind == '&' ? smooth(points, kind == '&') : points);
    if (*at == ' ') ++at;
  }
  glyph.advance = widest + kSpacing;
  return glyph;
}

}  // namespace

const StrokeGlyph& glyph_of(char c) {
  static const auto glyphs = [] {
    std::array<StrokeGlyph, 128> all;
    for (StrokeGlyph& glyph : all) glyph.advance = kBlank;
    for (const Source& source : kSources) all[static_cast<std::size_t>(source.character)] = parsed(source);
    return all;
  }();
  static const StrokeGlyph nothing;
  const auto k = static_cast<unsigned char>(c);
  if ((k & 0xc0) == 0x80) return nothing;
  return glyphs[k < glyphs.size() ? k : ' '];
}

}  // namespace pliant::host
