#include "host/io/files.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include "host/io/child_process.hpp"
#include "host/io/failure.hpp"

namespace pliant::host {

namespace {

/// Makes a file with a name that did not exist, beside `target`. \param make  makes the one of a path; false with errno EEXIST
/// where there is one. \return its path; empty with errno set if that is impossible.
template <class Make>
std::string name_beside(const std::string& target, Make&& make) {
  constexpr int kMostNames = 1000;  // temporary files of one process in one folder
  const auto folder = std::filesystem::path(target).parent_path();
  for (int k = 0; k < kMostNames; ++k) {
    const auto name = ".pliant-" + std::to_string(::getpid()) + "-" + std::to_string(k) + ".part";
    if (const std::string path = (folder / name).string(); make(path)) return path;
    if (errno != EEXIST) break;
  }
  return {};
}

/// Creates a temporary file in the folder of `target`: without a name, so that nothing is left of it where the program is ended,
/// or, where the file system has no such files, with one. Null with errno set if that is impossible.
std::FILE* create_beside(const std::string& target, std::string* path) {
  path->clear();
  const auto folder = std::filesystem::path(target).parent_path().string();
  int file = ::open(folder.empty() ? "." : folder.c_str(), O_WRONLY | O_TMPFILE | O_CLOEXEC, 0666);
  if (file < 0)
    *path = name_beside(target, [&](const std::string& name) {
      // O_EXCL: neither another process's file nor a symbolic link is ever opened.
      file = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
      return file >= 0;
    });
  return file < 0 ? nullptr : ::fdopen(file, "wb");
}

/// The descriptor that a path like /dev/stdout or /dev/fd/3 names; -1 for any other. Such a path must not be resolved: what the
/// shell redirects to a file would replace that file.
int descriptor_of(const std::string& path) {
  if (path == "/dev/stdout" || path == "/dev/stderr")
    return path == "/dev/stdout" ? STDOUT_FILENO : STDERR_FILENO;
  for (const std::string folder : {"/dev/fd/", "/proc/self/fd/"}) {
    if (path.rfind(folder, 0) != 0) continue;
    const std::string digits = path.substr(folder.size());
    const bool is_number =
        !digits.empty() && digits.size() < 6 && digits.find_first_not_of("0123456789") == std::string::npos;
    return is_number ? std::stoi(digits) : -1;
  }
  return -1;
}

/// Where symbolic links lead, also to a file that is not there yet. Bad input if they lead in a circle.
std::string followed(const std::string& name) {
  constexpr int kMostLinks = 40;  // as Linux
  std::error_code ignored;
  std::filesystem::path path = name;
  for (int k = 0; std::filesystem::is_symlink(std::filesystem::symlink_status(path, ignored)); ++k) {
    if (k == kMostLinks) fail_input(name, std::string("cannot be written: ") + std::strerror(ELOOP));
    path = path.parent_path() / std::filesystem::read_symlink(path, ignored);
  }
  return path.string();
}

/// Whether a write to a pipe failed because of a signal (interrupt.hpp): the rest is still to be written.
bool was_interrupted() {
  return errno == EINTR;
}

}  // namespace

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

bool is_standard_output(const std::string& path) {
  return path == "-" || descriptor_of(path) == STDOUT_FILENO;
}

OutputFile::OutputFile(const std::string& path) : name_(path), target_(path) {
  if (is_standard_output(path)) {
    name_ = "standard output";
    file_ = stdout;
    write_at_once();
    return;
  }
  std::error_code ignored;
  const auto status = std::filesystem::status(path, ignored);
  if (std::filesystem::is_directory(status)) fail_input(path, "is a directory");
  const bool is_special = std::filesystem::exists(status) && !std::filesystem::is_regular_file(status);
  if (std::filesystem::is_regular_file(status) && ::access(path.c_str(), W_OK) != 0)
    fail_input(path, std::string("cannot be written: ") + std::strerror(errno));
  if (const int descriptor = descriptor_of(path); descriptor >= 0) {
    file_ = ::fdopen(::dup(descriptor), "wb");
  } else if (is_special) {
    file_ = std::fopen(path.c_str(), "wb");
  } else {
    target_ = followed(path);
    file_ = create_beside(target_, &temporary_);
    has_no_name_ = file_ != nullptr && temporary_.empty();
    if (file_ == nullptr && std::filesystem::exists(status)) file_ = std::fopen(target_.c_str(), "wb");
  }
  if (file_ == nullptr) fail_input(path, std::string("cannot be written: ") + std::strerror(errno));
  write_at_once();
  if (std::filesystem::exists(status) && !is_direct())
    ::fchmod(::fileno(file_), static_cast<mode_t>(status.permissions()));
}

OutputFile::OutputFile(std::unique_ptr<ChildProcess> program, const std::string& name)
    : name_(name), program_(std::move(program)), file_(program_->stream()) {
  write_at_once();
}

/// Without a buffer: one whose writing a signal interrupts drops what it holds, and who reads a live track gets each row at once.
void OutputFile::write_at_once() {
  std::setvbuf(file_, nullptr, _IONBF, 0);
}

OutputFile::~OutputFile() {
  if (file_ != nullptr && file_ != stdout && program_ == nullptr) std::fclose(file_);
  if (!temporary_.empty()) std::remove(temporary_.c_str());
}

void OutputFile::fail() const {
  fail_input(name_, std::string("writing failed: ") + std::strerror(errno));
}

void OutputFile::write(std::string_view bytes) {
  while (!bytes.empty()) {
    errno = 0;
    const std::size_t written = std::fwrite(bytes.data(), 1, bytes.size(), file_);
    bytes.remove_prefix(written);
    if (!bytes.empty() && !was_interrupted()) fail();
  }
}

std::string OutputFile::end_program() {
  return program_->finish();
}

void OutputFile::commit() {
  if (file_ == stdout) return;
  if (program_ != nullptr) {
    if (const std::string why = end_program(); !why.empty()) fail_input(name_, why);
    return;
  }
  // The bytes are on the disk before the name is, so that a power cut leaves the old file or the new one.
  if (!is_direct() && ::fsync(::fileno(file_)) != 0) fail();
  if (has_no_name_) {
    const std::string file = "/proc/self/fd/" + std::to_string(::fileno(file_));
    temporary_ = name_beside(target_, [&](const std::string& name) {
      return ::linkat(AT_FDCWD, file.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0;
    });
    if (temporary_.empty()) fail();
  }
  if (std::fclose(std::exchange(file_, nullptr)) != 0) fail();
  if (temporary_.empty() || std::rename(temporary_.c_str(), target_.c_str()) == 0) {
    temporary_.clear();
    return;
  }
  if (errno != EBUSY) fail();
  // A file that is mounted by itself, as in a container, can be written, not replaced.
  std::error_code why;
  std::filesystem::copy_file(temporary_, target_, std::filesystem::copy_options::overwrite_existing, why);
  if (why) fail_input(name_, "writing failed: " + why.message());
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
