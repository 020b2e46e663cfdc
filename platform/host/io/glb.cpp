#include "host/io/glb.hpp"

#include <algorithm>
#include <cstring>

#include "host/io/bounding_box.hpp"

namespace pliant::host {

namespace {

constexpr int kFloat = 5126, kUint16 = 5123, kVertexData = 34962, kIndices = 34963, kNoTarget = 0,
              kClampToEdge = 33071;

/// A chunk of a GLB file: length, kind, contents padded to a multiple of four bytes.
std::string chunk(std::uint32_t kind, std::string contents, char filler) {
  contents.resize((contents.size() + 3) / 4 * 4, filler);
  std::string out;
  put(out, static_cast<std::uint32_t>(contents.size()), 4);
  put(out, kind, 4);
  return out + contents;
}

}  // namespace

void put(std::string& out, std::uint32_t value, int bytes) {
  for (int k = 0; k < bytes; ++k) out += static_cast<char>(value >> (8 * k) & 255u);
}

void put(std::string& out, float value) {
  std::uint32_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  put(out, bits, 4);
}

void put(std::string& out, Vec3 v) {
  put(out, v.x);
  put(out, v.y);
  put(out, v.z);
}

Json metres_per_millimetre() {
  return {0.001f, 0.001f, 0.001f};
}

int GlbFile::add_view(const std::string& part, int target) {
  Json view = Json::object({{"buffer", 0}, {"byteOffset", buffer_.size()}, {"byteLength", part.size()}});
  if (target != kNoTarget) view["target"] = target;
  views_.push_back(std::move(view));
  buffer_ += part;
  buffer_.resize((buffer_.size() + 3) / 4 * 4, '\0');
  return static_cast<int>(views_.size()) - 1;
}

int GlbFile::add_accessor(int view, int component, std::size_t count, const char* type, const Json& low,
                          const Json& high) {
  Json accessor =
      Json::object({{"bufferView", view}, {"componentType", component}, {"count", count}, {"type", type}});
  if (!low.is_null()) {
    accessor["min"] = low;
    accessor["max"] = high;
  }
  accessors_.push_back(std::move(accessor));
  return static_cast<int>(accessors_.size()) - 1;
}

int GlbFile::add(const std::vector<Vec3>& values, Use use) {
  std::string bytes;
  for (const Vec3 v : values) put(bytes, v);
  const BoundingBox<Vec3> box(values);
  const Vec3 low = box.low, high = box.high;
  const int view = add_view(bytes, use == Use::vertices ? kVertexData : kNoTarget);
  return add_accessor(view, kFloat, values.size(), "VEC3", {low.x, low.y, low.z}, {high.x, high.y, high.z});
}

int GlbFile::add(const std::vector<Vec2>& values) {
  std::string bytes;
  for (const Vec2 v : values) {
    put(bytes, v.x);
    put(bytes, v.y);
  }
  return add_accessor(add_view(bytes, kVertexData), kFloat, values.size(), "VEC2");
}

int GlbFile::add(const std::vector<Quat>& values) {
  std::string bytes;
  for (const Quat& q : values)
    for (const float component : {q.x, q.y, q.z, q.w}) put(bytes, component);
  return add_accessor(add_view(bytes, kNoTarget), kFloat, values.size(), "VEC4");
}

int GlbFile::add(const std::vector<float>& values) {
  std::string bytes;
  float low = values.empty() ? 0 : values[0], high = low;
  for (const float v : values) {
    put(bytes, v);
    low = min(low, v);
    high = max(high, v);
  }
  return add_accessor(add_view(bytes, kNoTarget), kFloat, values.size(), "SCALAR", Json::array({low}),
                      Json::array({high}));
}

int GlbFile::add(const std::vector<std::array<std::uint16_t, 3>>& faces) {
  std::string bytes;
  for (const auto& face : faces)
    for (const std::uint16_t v : face) put(bytes, v, 2);
  return add_accessor(add_view(bytes, kIndices), kUint16, 3 * faces.size(), "SCALAR", {}, {});
}

int GlbFile::add_material(const std::string& picture, bool is_lit) {
  Json surface = Json::object({{"metallicFactor", 0}, {"roughnessFactor", 0.8f}});
  if (!picture.empty()) {
    const bool is_jpeg = picture.compare(0, 2, "\xff\xd8") == 0;
    images_.push_back(Json::object(
        {{"bufferView", add_view(picture, kNoTarget)}, {"mimeType", is_jpeg ? "image/jpeg" : "image/png"}}));
    textures_.push_back(Json::object({{"source", images_.size() - 1}, {"sampler", 0}}));
    surface["baseColorTexture"]["index"] = textures_.size() - 1;
  }
  Json material = Json::object({{"pbrMetallicRoughness", surface}, {"doubleSided", true}});
  if (!is_lit) material["extensions"]["KHR_materials_unlit"] = Json::object();
  has_unlit_ = has_unlit_ || !is_lit;
  materials_.push_back(std::move(material));
  return static_cast<int>(materials_.size()) - 1;
}

std::string GlbFile::bytes(Json root) const {
  root["asset"] = Json::object({{"version", "2.0"}, {"generator", "pliant"}});
  if (has_unlit_) root["extensionsUsed"] = Json::array({"KHR_materials_unlit"});
  const auto add_list = [&root](const char* name, const Json& list) {
    if (!list.empty()) root[name] = list;
  };
  add_list("materials", materials_);
  add_list("images", images_);
  add_list("textures", textures_);
  // A chart may reach its picture's border, where glTF's default would blend in the opposite one.
  if (!textures_.empty())
    root["samplers"][0] = Json::object({{"wrapS", kClampToEdge}, {"wrapT", kClampToEdge}});
  add_list("accessors", accessors_);
  add_list("bufferViews", views_);
  root["buffers"] = Json::array({Json::object({{"byteLength", buffer_.size()}})});
  const std::string chunks = chunk(0x4e4f534a, json_text(root), ' ') + chunk(0x004e4942, buffer_, '\0');
  std::string out = "glTF";
  put(out, 2, 4);
  put(out, static_cast<std::uint32_t>(12 + chunks.size()), 4);
  return out + chunks;
}

}  // namespace pliant::host
