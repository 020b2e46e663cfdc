#pragma once
/// \file files.hpp
/// Whole files in and out: reading with a message that names the file, writing that leaves nothing half-done.
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/model.hpp"

namespace pliant::host {

/// All bytes of a file. Bad input when it cannot be read, is a directory, or is larger than `limit_bytes`.
std::string read_file(const std::string& path, std::size_t limit_bytes = std::size_t{1} << 28);

/// A file that appears under its name only when it is complete: whoever makes it writes to `working_path()`,
/// `commit` gives it its name, and what was not committed is removed. A path that exists and is no regular
/// file (a device, a pipe) is its own working path.
class PendingFile {
 public:
  /// Creates the working file, empty. Bad input when that cannot be done.
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

/// A pending file that is written piece by piece.
class OutputFile {
 public:
  explicit OutputFile(const std::string& path);
  ~OutputFile();

  /// Bad input on a full disk, here or in `commit`.
  void write(std::string_view bytes);
  void commit();

 private:
  PendingFile pending_;
  std::FILE* file_;
};

/// Writes a whole file in one go.
void write_file(const std::string& path, std::string_view bytes);

/// A whole file as aligned memory: mapped, so that what nobody reads takes no memory and what is read is shared, or,
/// where that is impossible (a pipe), read.
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

/// A model table in a file, with the view on it. The file must not be written to meanwhile; replacing it is harmless.
class ModelFile {
 public:
  /// Bad input, with the reason, for anything but a valid table.
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
