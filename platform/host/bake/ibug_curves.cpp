#include "host/bake/ibug_curves.hpp"

#include <algorithm>

#include "host/io/ibug_names.hpp"

namespace pliant::host::bake {

namespace {

struct IbugCurve {
  const char* name;
  CurveKind kind;
  int first, last, close;  // from landmark to landmark, then to `close` unless it is negative
};

constexpr IbugCurve kIbugCurves[] = {
    {"outline", CurveKind::boundary, 0, 16, -1},     {"brow_right", CurveKind::brow, 17, 21, -1},
    {"brow_left", CurveKind::brow, 22, 26, -1},      {"lid_upper_right", CurveKind::lid, 36, 39, -1},
    {"lid_lower_right", CurveKind::lid, 39, 41, 36}, {"lid_upper_left", CurveKind::lid, 42, 45, -1},
    {"lid_lower_left", CurveKind::lid, 45, 47, 42},  {"lip_outer_upper", CurveKind::lip, 48, 54, -1},
    {"lip_outer_lower", CurveKind::lip, 54, 59, 48}, {"lip_inner_upper", CurveKind::lip, 60, 64, -1},
    {"lip_inner_lower", CurveKind::lip, 64, 67, 60}};

}  // namespace

std::vector<SourceCurve> ibug_curves(const std::vector<SourceLandmark>& landmarks) {
  std::vector<SourceCurve> curves;
  for (const IbugCurve& c : kIbugCurves) {
    SourceCurve curve{c.name, c.kind, {}};
    bool is_complete = true;
    const auto append = [&](int k) {
      const auto landmark = std::find_if(landmarks.begin(), landmarks.end(),
                                         [&](const SourceLandmark& l) { return l.name == ibug_name(k); });
      is_complete &= landmark != landmarks.end();
      if (is_complete) curve.points.push_back(landmark->uv);
    };
    for (int k = c.first; k <= c.last; ++k) append(k);
    if (c.close >= 0) append(c.close);
    if (is_complete) curves.push_back(std::move(curve));
  }
  return curves;
}

}  // namespace pliant::host::bake
