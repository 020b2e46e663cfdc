#include "host/io/files.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "host/io/failure.hpp"

namespace pliant::host {

std::string read_file(const std::string& path, std::size_t limit_bytes) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) fail_input(path, "is a directory, not a file");
  std::FILE* file = std::fopen(path.c_str(), "rb");
  if (file == nullptr) fail_input(path, std::strerror(errno));
  std::string bytes;
  char block[65536];
  std::size_t got = 0;
  while ((got = std::fread(block, 1, sizeof block, file)) > 0 && bytes.size() <= limit_bytes)
    bytes.append(block, got);
  const bool failed = std::ferror(file) != 0;
  std::fclose(file);
  if (failed) fail_input(path, "reading failed");
  if (bytes.size() > limit_bytes) fail_input(path, "larger than any file of its kind should be");
  return bytes;
}

PendingFile::PendingFile(std::string path) : path_(std::move(path)) {
  std::error_code ignored;
  const auto status = std::filesystem::status(path_, ignored);
  if (std::filesystem::is_directory(status)) fail_input(path_, "is a directory");
  const bool is_special = std::filesystem::exists(status) && !std::filesystem::is_regular_file(status);
  working_path_ = is_special ? path_ : path_ + ".part";
  std::FILE* file = std::fopen(working_path_.c_str(), "wb");
  if (file == nullptr) fail_input(path_, std::string("cannot be written: ") + std::strerror(errno));
  std::fclose(file);
}

PendingFile::~PendingFile() {
  if (!committed_ && working_path_ != path_) std::remove(working_path_.c_str());
}

void PendingFile::commit() {
  if (working_path_ != path_ && std::rename(working_path_.c_str(), path_.c_str()) != 0)
    fail_input(path_, std::string("cannot be written: ") + std::strerror(errno));
  committed_ = true;
}

OutputFile::OutputFile(const std::string& path)
    : pending_(path), file_(std::fopen(pending_.working_path().c_str(), "wb")) {
  if (file_ == nullptr) fail_input(path, std::string("cannot be written: ") + std::strerror(errno));
}

OutputFile::~OutputFile() {
  if (file_ != nullptr) std::fclose(file_);
}

void OutputFile::write(std::string_view bytes) {
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_) != bytes.size())
    fail_input(pending_.path(), std::string("writing failed: ") + std::strerror(errno));
}

void OutputFile::commit() {
  const int result = std::fclose(file_);
  file_ = nullptr;
  if (result != 0) fail_input(pending_.path(), std::string("writing failed: ") + std::strerror(errno));
  pending_.commit();
}

void write_file(const std::string& path, std::string_view bytes) {
  OutputFile file(path);
  file.write(bytes);
  file.commit();
}

MappedFile::MappedFile(const std::string& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  struct stat facts = {};
  if (file >= 0 && ::fstat(file, &facts) == 0 && S_ISREG(facts.st_mode) && facts.st_size > 0) {
    size_bytes_ = static_cast<std::size_t>(facts.st_size);
    mapped_ = ::mmap(nullptr, size_bytes_, PROT_READ, MAP_PRIVATE, file, 0);
    if (mapped_ == MAP_FAILED) mapped_ = nullptr;
  }
  if (file >= 0) ::close(file);
  if (mapped_ != nullptr) return;
  const std::string bytes = read_file(path);
  size_bytes_ = bytes.size();
  words_.resize((size_bytes_ + 3) / 4);
  if (!bytes.empty()) std::memcpy(words_.data(), bytes.data(), size_bytes_);
}

MappedFile::~MappedFile() {
  if (mapped_ != nullptr) ::munmap(mapped_, size_bytes_);
}

ModelFile::ModelFile(const std::string& path) : path_(path), bytes_(path) {
  if (bytes_.size_bytes() < sizeof(table::Header)) fail_input(path, text(Status::truncated));
  require(Model::open(bytes_.data(), bytes_.size_bytes(), &model_), path);
}

}  // namespace pliant::host
