#pragma once
/// \file files.hpp
/// Reads and writes whole files. Errors name the file; an incomplete file is never left behind.
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/model.hpp"

namespace pliant::host {

class ChildProcess;

/// Reads a file. Bad input if it cannot be read, is a directory or is larger than `limit_bytes`.
std::string read_file(const std::string& path, std::size_t limit_bytes = std::size_t{1} << 28);

/// Whether an output of this name is standard output: "-", or a path of its descriptor, as /dev/stdout.
bool is_standard_output(const std::string& path);

/// A file that gets its name only when it is complete. Until `commit`, the bytes are in a temporary file in the same folder. It has
/// no name, or, where the file system has no such files, one that the destructor removes. A symbolic link is followed: its target
/// is replaced. What cannot be replaced is written directly: a device, a pipe, a descriptor as /dev/fd/3, and a file in a folder
/// that takes no other; a file that is a mount point gets the bytes at the end. "-" is standard output.
class OutputFile {
 public:
  /// Creates the temporary file. Bad input if that is impossible, or if there is a file of that name that may not be written.
  explicit OutputFile(const std::string& path);
  /// Writes to a program, which messages call `name`. `commit` waits for its end.
  OutputFile(std::unique_ptr<ChildProcess> program, const std::string& name);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// The path, or "standard output", as messages name it.
  const std::string& name() const { return name_; }
  /// Appends bytes. Bad input, here or in `commit`, if they cannot be written, for instance because the disk is full.
  void write(std::string_view bytes);
  /// Flushes the bytes to the disk and gives the file its name. Nothing may be written afterwards.
  void commit();
  /// Of a program that may not have read all: closes its input and waits for its end. Nothing may be written afterwards.
  /// \return why it failed; empty if it did not.
  std::string end_program();

 private:
  [[noreturn]] void fail() const;
  void write_at_once();
  bool is_direct() const { return temporary_.empty() && !has_no_name_; }

  std::string name_, target_;
  std::string temporary_;  // its path; empty if it has no name yet, or the target is written directly
  std::unique_ptr<ChildProcess> program_;  // which owns file_, if there is one
  std::FILE* file_ = nullptr;
  bool has_no_name_ = false;  // the temporary file has none yet
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
