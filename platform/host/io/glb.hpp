#pragma once
/// \file glb.hpp
/// Writes glTF 2.0 as one binary file (GLB).
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "host/io/json.hpp"
#include "pliant/geometry.hpp"

namespace pliant::host {

/// Appends numbers as little-endian bytes.
void put(std::string& out, std::uint32_t value, int bytes);
void put(std::string& out, float value);
void put(std::string& out, Vec3 v);

/// Collects the parts of a GLB file. Every `add` returns the index of the part in the JSON.
class GlbFile {
 public:
  enum class Use { vertices, plain };

  /// Adds positions, normals or displacements of a morph target (`vertices`), or keys of an animation (`plain`).
  int add(const std::vector<Vec3>& values, Use use);
  /// Adds texture coordinates.
  int add(const std::vector<Vec2>& values);
  /// Adds rotations, written as x, y, z, w.
  int add(const std::vector<Quat>& values);
  /// Adds times or weights of an animation.
  int add(const std::vector<float>& values);
  int add(const std::vector<std::array<std::uint16_t, 3>>& faces);
  /// Adds a material with a PNG or JPEG as its texture; without a texture if `picture` is empty. If not `is_lit`, it is unlit,
  /// as the picture contains the light.
  int add_material(const std::string& picture, bool is_lit);

  /// The bytes of the file.
  /// \param root  further members of the JSON: scene, scenes, nodes, meshes, animations.
  std::string bytes(Json root) const;

 private:
  int add_view(const std::string& part, int target);
  int add_accessor(int view, int component, std::size_t count, const char* type, const Json& low = {},
                   const Json& high = {});

  std::string buffer_;
  Json views_, accessors_, materials_, images_, textures_;  // lists, or null if empty
  bool has_unlit_ = false;
};

/// Scale of a node whose mesh is in millimetres; glTF is in metres.
Json metres_per_millimetre();

}  // namespace pliant::host
