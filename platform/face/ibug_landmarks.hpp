#pragma once
// Landmarks of a model that are named by the iBUG scheme: ibug00 to ibug67.
#include "pliant/face_box.hpp"
#include "pliant/model.hpp"

namespace pliant {

/// Index of landmark ibugNN of a model, or kNone. \param number  NN. \param expected  index that is compared first: models
/// list the scheme's landmarks in its order.
std::uint16_t find_ibug(const Model& model, int number, std::size_t expected = 0);

/// Those whose middle and distances are a face's box: outer corners of the eyes, then of the mouth, each the right one of
/// the face first. \return false if the model lacks one.
bool find_box_corners(const Model& model, std::uint16_t (&corners)[4]);

/// The face box of these corners. \param scale  px per mm. Not inline, for the sake of code size.
FaceBox box_of_corners(const Vec2 (&x)[4], float scale);

/// Where landmarks are, for the two functions below.
inline auto places_of(Span<const Vec2> landmarks) {
  return [landmarks](std::size_t k, Vec2* x) {
    *x = landmarks[k];
    return true;
  };
}

/// The face box of a model whose landmark k is at x where `place(k, &x)` returns true. Side 0 if one is not seen or the model
/// lacks it. \param scale  px per mm.
template <class Place>
FaceBox box_at_landmarks(const Model& model, float scale, const Place& place) {
  std::uint16_t corners[4];
  if (!find_box_corners(model, corners)) return {};
  Vec2 x[4];
  for (int k = 0; k < 4; ++k)
    if (!place(corners[k], &x[k])) return {};
  return box_of_corners(x, scale);
}

/// Mean distance of a model's landmarks from where `place(index, &x)` has them, over that of their outer eye corners. Negative for
/// a model that lacks these, and where `place` is false.
template <class Place>
float mean_distance(const Model& model, Span<const Vec2> landmarks, const Place& place) {
  std::uint16_t corners[4];
  if (!find_box_corners(model, corners)) return -1;
  float sum = 0;
  for (std::size_t k = 0; k < landmarks.count; ++k) {
    Vec2 x;
    if (!place(k, &x)) return -1;
    sum += length(landmarks[k] - x);
  }
  return sum / (static_cast<float>(landmarks.count) * length(landmarks[corners[1]] - landmarks[corners[0]]));
}

}  // namespace pliant
