#include "scratch_folder.hpp"

#include <stdlib.h>

#include <fstream>
#include <iterator>
#include <stdexcept>

namespace fs = std::filesystem;

Folder::Folder(const std::string& name) {
  std::string made = (fs::temp_directory_path() / ("pliant_test_" + name + "_XXXXXX")).string();
  if (mkdtemp(made.data()) == nullptr) throw std::runtime_error("no folder " + made);
  path = made;
}

Folder::~Folder() {
  fs::remove_all(path);
}

std::string Folder::operator/(const std::string& name) const {
  return (path / name).string();
}

std::string Folder::put(const std::string& name, const std::string& bytes) const {
  std::ofstream(*this / name, std::ios::binary) << bytes;
  return *this / name;
}

bool Folder::has(const std::string& name) const {
  return fs::exists(path / name);
}

std::size_t Folder::file_count() const {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(path), fs::directory_iterator{}));
}

std::size_t Folder::temporary_count() const {
  std::size_t count = 0;
  for (const auto& entry : fs::directory_iterator(path)) count += entry.path().extension() == ".part" ? 1 : 0;
  return count;
}
