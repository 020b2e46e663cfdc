#pragma once
/// \file files.hpp
/// Reads and writes whole files. Errors name the file; an incomplete file is never left behind.
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/model.hpp"

namespace pliant::host {

/// Reads a file. Bad input if it cannot be read, is a directory or is larger than `limit_bytes`.
std::string read_file(const std::string& path, std::size_t limit_bytes = std::size_t{1} << 28);

/// A file that gets its name only when it is complete. The caller writes to `working_path()`; `commit` renames it to `path()`.
/// Without `commit` the destructor removes it. If the path is a device or a pipe, it is written directly.
class PendingFile {
 public:
  /// Creates the working file. Bad input if that is impossible.
  explicit PendingFile(std::string path);
  ~PendingFile();
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;

  const std::string& path() const { return path_; }
  const std::string& working_path() const { return working_path_; }
  void commit();

 private:
  std::string path_, working_path_;
  bool committed_ = false;
};

/// A PendingFile with a function that writes to it.
class OutputFile {
 public:
  explicit OutputFile(const std::string& path);
  ~OutputFile();

  /// Appends bytes. Bad input, here or in `commit`, if the disk is full.
  void write(std::string_view bytes);
  void commit();

 private:
  PendingFile pending_;
  std::FILE* file_;
};

/// Writes a whole file.
void write_file(const std::string& path, std::string_view bytes);

/// A file as memory aligned to four bytes. It is mapped if possible, so that only pages in use take memory; otherwise (a pipe) it
/// is read.
class MappedFile {
 public:
  /// Bad input as for `read_file`.
  explicit MappedFile(const std::string& path);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  const void* data() const { return mapped_ != nullptr ? mapped_ : words_.data(); }
  std::size_t size_bytes() const { return size_bytes_; }

 private:
  void* mapped_ = nullptr;
  std::size_t size_bytes_ = 0;
  std::vector<std::uint32_t> words_;
};

/// A model table in a file. The file must not be modified during the object's life; it may be replaced by another.
class ModelFile {
 public:
  /// Bad input unless the file is a valid table.
  explicit ModelFile(const std::string& path);
  ModelFile(const ModelFile&) = delete;
  ModelFile& operator=(const ModelFile&) = delete;

  const Model& model() const { return model_; }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
  MappedFile bytes_;
  Model model_;
};

}  // namespace pliant::host
