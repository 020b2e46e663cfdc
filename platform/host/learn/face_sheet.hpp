#pragma once
/// \file face_sheet.hpp
/// The triangles of a face model with closed eyes and mouth, and their places in the chart: the same for every face.
#include <array>
#include <cstdint>
#include <vector>

#include "pliant/cascade.hpp"

namespace pliant::host::learn {

/// What a triangle shows.
enum class FacePart : std::uint8_t { skin, eye, mouth, around };

/// A triangle of a textured mesh.
struct FaceTriangle {
  std::array<std::uint32_t, 3> corner;
  FacePart part = FacePart::skin;
};

/// The model's mesh refined evenly, with its openings filled.
struct FaceSheet {
  /// \param depth  bisections of the base mesh; 2 gives four times its triangles.
  FaceSheet(const Model& model, int depth);

  std::vector<Vec2> uv;
  std::vector<FaceTriangle> triangles;
  std::vector<float> edge_mm;  ///< distance of each vertex to the outer edge, at rest

  /// Positions of all vertices, mm. \param cascade  of the same model, all parameters free.
  std::vector<Vec3> positions(Cascade& cascade, const float* q) const;
  /// Positions of the model's landmarks, mm. \param cascade  as above.
  std::vector<Vec3> landmarks(Cascade& cascade, const float* q) const;
  /// Unit normals, outwards.
  std::vector<Vec3> normals(const std::vector<Vec3>& positions) const;

 private:
  std::vector<Vec3> samples_, landmark_samples_;  // of the fields, for each vertex and landmark
};

}  // namespace pliant::host::learn
