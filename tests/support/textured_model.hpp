#pragma once
// A small textured model for the tests of the host command: a curved sheet of 120 x 160 mm with a nose, one
// identity and three expression parameters, and fifteen landmarks.
#include <functional>
#include <string>
#include <vector>

#include "host/bake/table_writer.hpp"

struct TexturedModel {
  using Shape = std::function<pliant::Vec3(float u, float v)>;
  using Paint = std::function<float(float u, float v)>;

  Shape rest = sheet_with_nose;
  Paint paint = blotches;
  int albedo_side = 256;
  bool with_expressions = true;
  std::vector<std::uint8_t> print;  ///< of make_print_table, from the model without one

  TexturedModel();
  ~TexturedModel();

  static pliant::Vec3 sheet_with_nose(float u, float v);
  /// A few sizes, dark and light.
  static float blotches(float u, float v);
  static pliant::host::bake::FieldGrid grid(int side, const Shape& shape);

  static Shape bump(float u0, float v0, float radius, pliant::Vec3 direction);

  /// Landmarks in three rows and five columns; five of them bear the names of a five-point start, where a face has those.
  static std::vector<std::string> landmark_names();

  std::vector<std::uint8_t> bytes() const;
};
