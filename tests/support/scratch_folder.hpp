#pragma once
#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

/// A folder of its own for a test, gone afterwards. No two runs share one.
struct Folder {
  std::filesystem::path path;
  explicit Folder(const std::string& name) {
    std::string made =
        (std::filesystem::temp_directory_path() / ("pliant_test_" + name + "_XXXXXX")).string();
    if (mkdtemp(made.data()) == nullptr) throw std::runtime_error("no folder " + made);
    path = made;
  }
  ~Folder() { std::filesystem::remove_all(path); }
  std::string file(const std::string& name, const std::string& text) const {
    std::ofstream(path / name) << text;
    return (path / name).string();
  }
};
