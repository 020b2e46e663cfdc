#pragma once
#include <cstddef>
#include <filesystem>
#include <string>

/// A folder of its own for a test, gone afterwards. No two runs share one.
struct Folder {
  std::filesystem::path path;
  explicit Folder(const std::string& name = "");
  ~Folder();
  /// The path of a file.
  std::string operator/(const std::string& name) const;
  /// Writes a file; returns its path.
  std::string put(const std::string& name, const std::string& bytes) const;
  bool has(const std::string& name) const;
  std::size_t file_count() const;
  /// Number of files that a command began and left behind.
  std::size_t temporary_count() const;
};
