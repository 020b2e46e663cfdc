#include "face/ibug_landmarks.hpp"

#include "face/aligner_table.hpp"
#include "model/table_reader.hpp"

namespace pliant {

std::uint16_t find_ibug(const Model& model, int number, std::size_t expected) {
  if (number >= kMostAlignerLandmarks) return kNone;
  char name[] = "ibug00";
  name[4] = static_cast<char>('0' + number / 10);
  name[5] = static_cast<char>('0' + number % 10);
  const Span<const Landmark> all = model.landmarks();
  if (expected < all.count && same_name(all[expected].name, name))
    return static_cast<std::uint16_t>(expected);
  return model.find_landmark(name);
}

bool find_box_corners(const Model& model, std::uint16_t (&corners)[4]) {
  static constexpr std::uint8_t kNumbers[4] = {36, 45, 48, 54};
  for (std::size_t k = 0; k < 4; ++k) {
    corners[k] = find_ibug(model, kNumbers[k]);
    if (corners[k] == kNone) return false;
  }
  return true;
}

FaceBox box_of_corners(const Vec2 (&x)[4], float scale) {
  return face_box_of(x[0], x[1], x[2], x[3], scale);
}

}  // namespace pliant
