#include "host/bake/material_pictures.hpp"

#include <algorithm>
#include <filesystem>
#include <iomanip>
#include <map>
#include <sstream>

#include "host/bake/material_library.hpp"
#include "host/bake/source_error.hpp"
#include "host/io/words.hpp"

namespace pliant::host::bake {

namespace {

namespace fs = std::filesystem;

/// Pictures of materials, count, at most. Bounds the memory.
constexpr std::size_t kMostPictures = 64;

/// False also for a pipe, which would be waited for, and for what no name can be.
bool is_plain_file(const std::string& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

/// Words of a line. One in quotes may have blanks.
std::vector<std::string> words_in(const std::string& line) {
  std::istringstream in(line);
  std::vector<std::string> words;
  for (std::string word; in >> std::quoted(word);) words.push_back(word);
  return words;
}

/// The material files that `mtllib` lines name: one a line, with blanks in its name, or several, which may be quoted.
std::vector<std::string> libraries_in(const std::string& folder, const std::vector<std::string>& lines) {
  std::vector<std::string> names;
  for (std::string line : lines) {
    std::replace(line.begin(), line.end(), '\\', '/');
    const std::vector<std::string> each = words_in(line);
    const bool are_several = each.size() > 1 && !is_plain_file(folder + line) &&
                             (line[0] == '"' || is_plain_file(folder + each[0]));
    if (are_several)
      names.insert(names.end(), each.begin(), each.end());
    else
      names.emplace_back(unquoted(line));
  }
  return names;
}

/// The name of each material's picture; empty for one that has none.
std::map<std::string, std::string> picture_names(const ObjMesh& mesh, std::vector<std::string>* warnings) {
  std::map<std::string, std::string> names;
  const std::string folder = mesh.path.substr(0, mesh.path.find_last_of('/') + 1);
  for (const std::string& library : libraries_in(folder, mesh.libraries)) {
    if (!is_plain_file(folder + library)) {
      warnings->push_back("there is no material file " + folder + library +
                          ": the surface has no texture from it");
      continue;
    }
    names.merge(read_picture_names(folder + library, warnings));
  }
  for (const std::string& material : mesh.materials)
    if (!names.empty() && !material.empty() && names.count(material) == 0)
      warnings->push_back("no material file has the material '" + material +
                          "': its part of the surface has no texture");
  return names;
}

}  // namespace

std::vector<Image> read_material_pictures(const ObjMesh& mesh, int most_side, std::vector<int>* picture_of,
                                          std::vector<std::string>* warnings) {
  const std::map<std::string, std::string> names = picture_names(mesh, warnings);
  std::vector<Image> pictures;
  picture_of->assign(mesh.materials.size(), -1);
  std::map<std::string, int> ids;
  for (std::size_t m = 0; m < mesh.materials.size(); ++m) {
    const auto name = names.find(mesh.materials[m]);
    if (name == names.end() || name->second.empty()) continue;
    const auto [entry, fresh] = ids.insert({name->second, static_cast<int>(ids.size())});
    (*picture_of)[m] = entry->second;
    if (!fresh) continue;
    if (!is_plain_file(name->second))
      throw SourceError(
          name->second, 0,
          "the picture of material '" + mesh.materials[m] + "' cannot be read (--texture none does without)");
    if (ids.size() > kMostPictures)
      throw SourceError(mesh.path, 0, "has more than " + std::to_string(kMostPictures) + " pictures");
    pictures.push_back(shrunk_to(read_image(name->second), most_side, most_side));
  }
  return pictures;
}

}  // namespace pliant::host::bake
