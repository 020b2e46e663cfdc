#pragma once
/// \file glb.hpp
/// glTF 2.0 in one binary file (GLB): the buffer with its views and accessors, and the chunks around it.
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "host/io/json.hpp"
#include "pliant/geometry.hpp"

namespace pliant::host {

/// Numbers as the bytes of little-endian files, whatever the host is.
void put(std::string& out, std::uint32_t value, int bytes);
void put(std::string& out, float value);
void put(std::string& out, Vec3 v);

/// Collects the parts of a GLB. Every `add_` returns the index by which the JSON refers to the part.
class GlbFile {
 public:
  enum class Use { vertices, plain };

  /// Positions, normals, displacements of a morph target (`vertices`), or keys of an animation (`plain`).
  int add(const std::vector<Vec3>& values, Use use);
  /// Texture coordinates.
  int add(const std::vector<Vec2>& values);
  /// Rotations: x, y, z, w as glTF has them.
  int add(const std::vector<Quat>& values);
  /// Keys of an animation: times or weights.
  int add(const std::vector<float>& values);
  int add(const std::vector<std::array<std::uint16_t, 3>>& faces);
  /// A material that shows a picture, PNG or JPEG; a plain one for no bytes. `is_lit` false: the picture has its light
  /// in it already.
  int add_material(const std::string& picture, bool is_lit);

  /// The file. \param root  what else the JSON holds: scene, scenes, nodes, meshes, animations.
  std::string bytes(Json::Object root) const;

 private:
  int add_view(const std::string& part, int target);
  int add_accessor(int view, int component, std::size_t count, const char* type, Json::Array low,
                   Json::Array high);

  std::string buffer_;
  Json::Array views_, accessors_, materials_, images_, textures_;
  bool has_unlit_ = false;
};

/// glTF has metres: the scale of a node whose mesh is in millimetres.
Json::Array metres_per_millimetre();

}  // namespace pliant::host
