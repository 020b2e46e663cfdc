#include "host/bake/obj_file.hpp"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string_view>

#include "host/bake/source_error.hpp"
#include "host/io/numbers.hpp"
#include "host/io/words.hpp"

namespace pliant::host::bake {

namespace {

constexpr std::size_t kMostMaterials = 1000;                    // bounds the time
constexpr std::streamoff kMostBytes = std::streamoff{1} << 28;  // bounds the memory

class ObjReader {
 public:
  explicit ObjReader(const std::string& path) : path_(path) {
    std::error_code ignored;
    if (const auto kind = std::filesystem::status(path, ignored).type();
        kind == std::filesystem::file_type::fifo)
      throw SourceError(path, 0, "is a pipe, not a file");
    std::ifstream in(path, std::ios::binary | std::ios::ate);
    const auto size = in ? static_cast<std::streamoff>(in.tellg()) : -1;
    if (size < 0) throw SourceError(path, 0, "cannot be read");
    if (size > kMostBytes)
      throw SourceError(path, 0, "is larger than " + std::to_string(kMostBytes >> 20) + " MiB");
    text_.resize(static_cast<std::size_t>(size));
    in.seekg(0);
    if (size > 0 && !in.read(text_.data(), size)) throw SourceError(path, 0, "cannot be read");
    mesh_.path = path;
    mesh_.materials.emplace_back();
  }

  ObjMesh run() {
    for (std::string_view text = text_; !text.empty();) {
      line_ = ++last_line_;
      rest_ = joined_line(text);
      if (line_ == 1) rest_ = without_byte_order_mark(rest_);
      read_line();
    }
    if (mesh_.vertices.empty()) throw SourceError(path_, 0, "holds no vertices");
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw SourceError(path_, line_, what); }

  /// Takes a line from the text. One whose last character is a backslash goes on in the next one: the characters that separate the
  /// two become blanks. A comment does not go on, since it may end in the path of a folder.
  std::string_view joined_line(std::string_view& text) {
    const std::size_t start = text_.size() - text.size();
    for (;; ++last_line_) {
      const std::string_view line = take_line(text);
      const std::size_t end = static_cast<std::size_t>(line.data() - text_.data()) + line.size();
      const std::size_t next = text_.size() - text.size();
      if (next == end || line.empty() || line.back() != '\\' || line.find('#') != std::string_view::npos)
        return std::string_view(text_).substr(start, end - start);
      for (std::size_t k = end - 1; k < next; ++k) text_[k] = ' ';
    }
  }

  std::string_view word() {
    const auto is_blank = [](char c) { return c == ' ' || c == '\t'; };
    std::size_t first = 0;
    while (first < rest_.size() && is_blank(rest_[first])) ++first;
    std::size_t last = first;
    while (last < rest_.size() && !is_blank(rest_[last])) ++last;
    const std::string_view result = rest_.substr(first, last - first);
    rest_.remove_prefix(last);
    return result;
  }

  /// The next number of the line, which `what` has under this name.
  float number(const char* name, const char* what) {
    const std::string_view text = word();
    if (text.empty() || text[0] == '#') fail(std::string(what) + " lacks " + name);
    const std::optional<float> value = parse_float(text);
    if (!value) fail("'" + std::string(text) + "' is not a number");
    return *value;
  }

  int index(std::string_view text, std::size_t count, const char* of) {
    int value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size())
      fail("'" + std::string(text) + "' is not an index");
    const int from_zero = value < 0 ? static_cast<int>(count) + value : value - 1;
    if (value == 0 || from_zero < 0 || static_cast<std::size_t>(from_zero) >= count)
      fail("there is no " + std::string(of) + " " + std::string(text));
    return from_zero;
  }

  void read_line() {
    const std::string_view key = word();
    if (key == "v") {
      constexpr const char* kWhat = "the vertex, which has three numbers x y z,";
      const float x = number("x", kWhat), y = number("y", kWhat), z = number("z", kWhat);
      mesh_.vertices.push_back({x, y, z});
    } else if (key == "vt") {
      constexpr const char* kWhat = "the texture coordinate, which has two numbers u v,";
      const float u = number("u", kWhat);
      const bool has_v = rest_.find_first_not_of(" \t") < rest_.find('#');
      mesh_.texture.push_back({u, has_v ? number("v", kWhat) : 0});
    } else if (key == "f") {
      read_polygon();
    } else if (key == "usemtl") {
      const std::string name = trimmed(rest_);
      const auto found = std::find(mesh_.materials.begin(), mesh_.materials.end(), name);
      material_ = static_cast<int>(found - mesh_.materials.begin());
      if (found == mesh_.materials.end()) mesh_.materials.push_back(name);
      if (mesh_.materials.size() > kMostMaterials)
        fail("uses more than " + std::to_string(kMostMaterials) + " materials");
    } else if (key == "mtllib") {
      if (mesh_.libraries.size() < kMostMaterials) mesh_.libraries.push_back(trimmed(rest_));
    } else if (key == "g" || key == "o") {
      is_fixed_ = false;
      for (std::string_view name = word(); !name.empty(); name = word()) is_fixed_ |= name == "fixed";
    }
  }

  void read_polygon() {
    const std::size_t first = mesh_.corners.size();
    for (std::string_view text = word(); !text.empty() && text[0] != '#'; text = word()) {
      const std::size_t slash = text.find('/');
      ObjCorner corner{index(text.substr(0, slash), mesh_.vertices.size(), "vertex"), -1};
      if (slash != std::string_view::npos) {
        const std::string_view behind = text.substr(slash + 1), texture = behind.substr(0, behind.find('/'));
        if (!texture.empty()) corner.texture = index(texture, mesh_.texture.size(), "texture coordinate");
      }
      mesh_.corners.push_back(corner);
    }
    if (mesh_.corners.size() - first < 3) fail("a face has at least three corners");
    mesh_.polygon_end.push_back(static_cast<int>(mesh_.corners.size()));
    mesh_.polygon_line.push_back(line_);
    mesh_.is_fixed.push_back(is_fixed_);
    mesh_.material.push_back(material_);
  }

  std::string path_, text_;
  std::string_view rest_;
  int line_ = 0, last_line_ = 0;  // the first and the last line of the file that the current one is made of
  bool is_fixed_ = false;         // the current group
  int material_ = 0;              // the current one
  ObjMesh mesh_;
};

}  // namespace

ObjMesh read_obj(const std::string& path) {
  return ObjReader(path).run();
}

ObjMesh read_obj_like(const std::string& path, const ObjMesh& like) {
  ObjMesh mesh = read_obj(path);
  const auto differ = [&](std::size_t here, std::size_t there, const char* what) {
    if (here != there)
      throw SourceError(
          path, 0,
          "has " + std::to_string(here) + " " + what + ", not " + std::to_string(there) + " as " + like.path);
  };
  differ(mesh.vertices.size(), like.vertices.size(), "vertices");
  differ(mesh.polygon_end.size(), like.polygon_end.size(), "faces");
  differ(mesh.corners.size(), like.corners.size(), "corners of faces");
  for (std::size_t k = 0; k < mesh.corners.size(); ++k)
    if (mesh.corners[k].vertex != like.corners[k].vertex) {
      std::size_t polygon = 0;
      while (static_cast<std::size_t>(mesh.polygon_end[polygon]) <= k) ++polygon;
      throw SourceError(path, mesh.polygon_line[polygon], "the face differs from that of " + like.path);
    }
  return mesh;
}

}  // namespace pliant::host::bake
