#include "face/part_points.hpp"

#include "face/ibug_landmarks.hpp"
#include "face/part_reader.hpp"

namespace pliant {

namespace {

/// 1: one of the two points of the upper lid, -1: of the lower one, 0: of neither.
std::int8_t lid_of(int number) {
  if (number == 37 || number == 38) return 1;
  return number == 40 || number == 41 ? -1 : 0;
}

}  // namespace

Status PartPoints::open(const Model& model) {
  side_count = count = parameter_count = 0;
  const Status status = PartTable::open(model.parts(), &table);
  if (status != Status::ok) return status;
  for (std::size_t k = 0; k < table.count(); ++k)
    for (int left = 0; left <= table[k].is_paired; ++left) {
      if (count + table[k].point_count > kMostPartReadings) return Status::capacity;
      PartSide& s = side[side_count];
      s.part = static_cast<std::uint8_t>(k);
      s.count = table[k].point_count;
      s.is_left = left != 0;
      s.first = static_cast<std::uint16_t>(count);
      const auto of_side = [&](int number) { return left != 0 ? mirrored_part_point(number) : number; };
      for (int a = 0; a < 2; ++a) {
        const std::uint16_t anchor = find_ibug(model, of_side(table[k].anchor[a]));
        if (anchor == kNone) return Status::not_found;
        s.anchor[a] = model.landmarks()[anchor].uv();
      }
      for (std::size_t p = 0; p < s.count; ++p, ++count) {
        landmark[count] = find_ibug(model, of_side(table[k].number[p]));
        lid[count] = lid_of(table[k].number[p]);
        uv[count] = is_fitted(count) ? model.landmarks()[landmark[count]].uv() : s.anchor[0];
      }
      ++side_count;
    }
  return Status::ok;
}

void PartPoints::move(const View& view, const Vec3* moved) {
  const CropMap axes = upright(view);
  const Projector projector(view, true);
  for (std::size_t k = 0; k < count; ++k) {
    if (!is_fitted(k)) continue;
    const Vec3 by = projector.rotated(moved[landmark[k]]);
    offset_mm[k] = offset_mm[k] + axes.to_crop(view.s * Vec2{by.x, by.y});
  }
}

}  // namespace pliant
