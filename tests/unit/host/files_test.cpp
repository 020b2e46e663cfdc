// Files that get their names when they are complete, and options that name files.
#include "host/io/files.hpp"

#include <doctest/doctest.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstring>

#include "cli_run.hpp"
#include "host/io/failure.hpp"
#include "host/io/interrupt.hpp"

namespace files_test {

using namespace pliant::host;
using namespace cli_run;

TEST_CASE("a file has its old contents until commit, and keeps them without it") {
  const Folder folder;
  const std::string path = folder.put("a.txt", "old");
  {
    OutputFile file(path);
    file.write("half");
    CHECK(read_file(path) == "old");
  }
  CHECK(read_file(path) == "old");
  CHECK(folder.file_count() == 1);
  write_file(path, "new");
  CHECK(read_file(path) == "new");
  CHECK(folder.file_count() == 1);
}

TEST_CASE("a program that is killed leaves no file behind, where the file system has files without names") {
  const Folder folder;
  const int trial = ::open(folder.path.c_str(), O_WRONLY | O_TMPFILE, 0600);
  if (trial < 0) return;
  ::close(trial);
  const pid_t child = ::fork();
  if (child == 0) {
    OutputFile file(folder / "a.txt");
    file.write("half");
    ::raise(SIGKILL);
  }
  REQUIRE(child > 0);
  int status = 0;
  REQUIRE(::waitpid(child, &status, 0) == child);
  CHECK(WIFSIGNALED(status));
  CHECK(folder.file_count() == 0);
}

TEST_CASE("the first Ctrl-C sets a flag, the second has its usual effect") {
  static int usual = 0;
  const auto before = std::signal(SIGINT, [](int) { ++usual; });
  {
    const InterruptWatch watch;
    CHECK_FALSE(watch.was_interrupted());
    ::raise(SIGINT);
    CHECK(watch.was_interrupted());
    CHECK(usual == 0);
    ::raise(SIGINT);
    CHECK(usual == 1);
  }
  std::signal(SIGINT, before);
}

TEST_CASE("Ctrl-C ends a read that waits for input") {
  int ends[2];
  REQUIRE(::pipe(ends) == 0);
  const InterruptWatch watch;
  const ::pid_t child = ::fork();
  if (child == 0) {
    ::usleep(20000);
    ::kill(::getppid(), SIGINT);
    ::usleep(2000000);  // a read that the signal has not ended gets a byte
    ::_exit(::write(ends[1], "x", 1) == 1 ? 0 : 1);
  }
  REQUIRE(child > 0);
  char byte;
  CHECK(::read(ends[0], &byte, 1) == -1);
  CHECK(watch.was_interrupted());
  ::kill(child, SIGKILL);
  CHECK(::waitpid(child, nullptr, 0) == child);
  ::close(ends[0]);
  ::close(ends[1]);
}

TEST_CASE("what is written to a full pipe arrives whole, though Ctrl-C interrupts it") {
  constexpr std::size_t kBytes = 200000;  // more than a pipe holds
  int ends[2];
  REQUIRE(::pipe(ends) == 0);
  const InterruptWatch watch;
  const ::pid_t child = ::fork();
  if (child == 0) {
    ::close(ends[1]);
    ::usleep(50000);
    ::kill(::getppid(), SIGINT);
    ::usleep(50000);
    std::size_t all = 0;
    char block[4096];
    for (::ssize_t got; (got = ::read(ends[0], block, sizeof block)) > 0;)
      all += static_cast<std::size_t>(got);
    ::_exit(all == kBytes ? 0 : 1);
  }
  REQUIRE(child > 0);
  {
    OutputFile file("/proc/self/fd/" + std::to_string(ends[1]));
    for (int row = 0; row < 200; ++row) file.write(std::string(kBytes / 200, 'x'));
    file.commit();
  }
  CHECK(watch.was_interrupted());
  ::close(ends[1]);
  int status = -1;
  CHECK(::waitpid(child, &status, 0) == child);
  CHECK(status == 0);
  ::close(ends[0]);
}

TEST_CASE("what a descriptor is redirected to keeps what was written before and after") {
  const Folder folder;
  const std::string path = folder / "log.txt";
  const int log = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  REQUIRE(log >= 0);
  const auto put = [&](const char* text) { REQUIRE(::write(log, text, std::strlen(text)) >= 0); };
  put("before ");
  for (const char* name : {"/dev/fd/", "/proc/self/fd/"}) write_file(name + std::to_string(log), "file ");
  put("after");
  ::close(log);
  CHECK(read_file(path) == "before file file after");
  CHECK(is_standard_output("-"));
  CHECK(is_standard_output("/dev/stdout"));
  CHECK(is_standard_output("/dev/fd/1"));
  CHECK_FALSE(is_standard_output("/dev/fd/12"));
  CHECK_FALSE(is_standard_output("dev/stdout"));
}

TEST_CASE("links are followed to a file that is not there yet, through several of them; a loop is refused") {
  const Folder folder;
  fs::create_directory(folder.path / "in");
  fs::create_symlink("in/real.txt", folder.path / "second");
  fs::create_symlink("second", folder.path / "first");
  write_file(folder / "first", "text");
  CHECK(fs::is_symlink(folder.path / "first"));
  CHECK(fs::is_symlink(folder.path / "second"));
  CHECK(read_file(folder / "in/real.txt") == "text");
  fs::create_symlink("b", folder.path / "a");
  fs::create_symlink("a", folder.path / "b");
  CHECK_THROWS_AS(write_file(folder / "a", "text"), Failure);
  CHECK(fs::is_symlink(folder.path / "a"));
  CHECK(fs::is_symlink(folder.path / "b"));
}

TEST_CASE("a file in a folder that takes no other is written in place" * doctest::skip(::geteuid() == 0)) {
  const Folder folder;
  const std::string path = folder.put("f.txt", "before");
  fs::permissions(folder.path, fs::perms::owner_read | fs::perms::owner_exec);
  write_file(path, "now");
  fs::permissions(folder.path, fs::perms::owner_all);
  CHECK(read_file(path) == "now");
}

TEST_CASE("a signal that is ignored, as nohup does with the end of a terminal, ends nothing") {
  const auto before = std::signal(SIGHUP, SIG_IGN);
  {
    const InterruptWatch watch;
    ::raise(SIGHUP);
    CHECK_FALSE(watch.was_interrupted());
  }
  const bool is_ignored = std::signal(SIGHUP, before) == SIG_IGN;
  CHECK(is_ignored);
}

TEST_CASE("a file that may not be written is not replaced" * doctest::skip(::geteuid() == 0)) {
  const Folder folder;
  const std::string path = folder.put("kept.csv", "kept");
  REQUIRE(::chmod(path.c_str(), 0444) == 0);
  CHECK_THROWS_WITH_AS(OutputFile{path}, doctest::Contains("cannot be written: Permission denied"), Failure);
  CHECK(read_file(path) == "kept");
}

TEST_CASE("two writers of one file do not mix: the last commit wins") {
  const Folder folder;
  const std::string path = folder / "a.txt";
  OutputFile first(path), second(path);
  first.write("first, ");
  second.write("second");
  first.write("whole");
  first.commit();
  CHECK(read_file(path) == "first, whole");
  second.commit();
  CHECK(read_file(path) == "second");
  CHECK(folder.file_count() == 1);
}

TEST_CASE(
    "a link to a file stays a link, and nothing is written through a link with the temporary file's name") {
  const Folder folder;
  folder.put("target.txt", "old");
  fs::create_symlink("target.txt", folder.path / "link.txt");
  write_file(folder / "link.txt", "new");
  CHECK(fs::is_symlink(folder.path / "link.txt"));
  CHECK(read_file(folder / "target.txt") == "new");
  // Also where the target is not there yet.
  fs::create_directory(folder.path / "other");
  fs::create_symlink("other/later.txt", folder.path / "to_come.txt");
  write_file(folder / "to_come.txt", "new");
  CHECK(fs::is_symlink(folder.path / "to_come.txt"));
  CHECK(read_file(folder / "other/later.txt") == "new");

  folder.put("victim.txt", "untouched");
  const std::string process = std::to_string(getpid());
  fs::create_symlink("victim.txt", folder.path / (".pliant-" + process + "-0.part"));
  write_file(folder / "a.txt", "text");
  CHECK(read_file(folder / "victim.txt") == "untouched");
  CHECK(read_file(folder / "a.txt") == "text");
}

TEST_CASE("a file keeps its permissions, and a new one has those of the process") {
  const Folder folder;
  const auto mode_of = [&](const std::string& name) {
    struct stat facts = {};
    REQUIRE(::stat((folder / name).c_str(), &facts) == 0);
    return facts.st_mode & 0777u;
  };
  const mode_t before = ::umask(027);
  write_file(folder / "new.txt", "text");
  ::umask(before);
  CHECK(mode_of("new.txt") == 0640u);
  REQUIRE(::chmod((folder / "new.txt").c_str(), 0604) == 0);
  write_file(folder / "new.txt", "more");
  CHECK(mode_of("new.txt") == 0604u);
}

TEST_CASE("a name as long as the file system allows can be written") {
  const Folder folder;
  const std::string path = folder / std::string(255, 'x');
  write_file(path, "text");
  CHECK(read_file(path) == "text");
}

TEST_CASE("a folder, a missing folder and a full device are refused by name") {
  const Folder folder;
  CHECK_THROWS_WITH_AS(OutputFile(folder.path.string()), doctest::Contains("is a directory"), Failure);
  CHECK_THROWS_WITH_AS(OutputFile(folder / "none/a.txt"), doctest::Contains("none/a.txt: cannot be written"),
                       Failure);
  if (!fs::exists("/dev/full")) return;
  CHECK_THROWS_WITH_AS(write_file("/dev/full", "text"), doctest::Contains("/dev/full: writing failed"),
                       Failure);
  CHECK(fs::exists("/dev/full"));
}

TEST_CASE("an output that is an input, two outputs of one name and a name of another format are bad usage") {
  const Folder folder;
  const std::string video = folder.put("v.y4m", "video"), model = folder.put("m.plm", "model");
  fs::create_symlink("v.y4m", folder.path / "same.y4m");
  const std::vector<std::string> track{"track", model, "--frames", video};
  const struct {
    std::vector<std::string> more;
    const char* part;
  } cases[] = {
      {{"--out", video}, "--out would overwrite the input"},
      {{"--out", model}, "--out would overwrite the input"},
      {{"--out", folder / "t.csv", "--overlay", folder / "same.y4m"}, "--overlay would overwrite the input"},
      {{"--out", folder / "t", "--report", folder / "t"}, "two outputs have the name"},
      {{"--out", folder / "t", "--report", folder / "../" + folder.path.filename().string() + "/./t"},
       "two outputs have the name"},
      {{"--out", "-", "--overlay", "-"}, "two outputs have the name -"},
      {{"--out", "/dev/stdout", "--overlay", "-"}, "two outputs have the name /dev/stdout"},
      {{"--out", folder / "t.csv", "--overlay", folder / "o.mp4"}, "--overlay writes Y4M"},
      {{"--out", folder / "t.csv", "--sheet", folder / "s.JPG"}, "--sheet writes PNG"},
      {{"--out", folder / "t.json"}, "--out writes CSV"},
  };
  for (const auto& c : cases) {
    std::vector<std::string> words = track;
    words.insert(words.end(), c.more.begin(), c.more.end());
    const Ran r = run_words(words);
    CAPTURE(r.err);
    CHECK(r.code == 2);
    CHECK(contains(r.err, c.part));
  }
  CHECK(read_file(video) == "video");
  CHECK(folder.file_count() == 3);
  // A file of a folder that is read, or that would be read with it the next time.
  const std::string points = folder.put("points.txt", "points"), frame = folder.put("1.png", "frame");
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {"bake", folder.path.string(), "-o", points},
           {"track", model, "--frames", folder.path.string(), "--out", folder / "t.csv", "--sheet", frame},
           {"track", model, "--frames", folder.path.string(), "--out", folder / "t.csv", "--sheet",
            folder / "new.png"}}) {
    const Ran r = run_words(words);
    CAPTURE(r.err);
    CHECK(r.code == 2);
    CHECK(contains(r.err, "would be read with the folder " + folder.path.string() + ": " + words.back()));
  }
  CHECK(read_file(points) == "points");
  const Ran beside =
      run_words({"detect", model, "--image", folder.path.string(), "-o", folder / "faces.txt"});
  CHECK(beside.code == 1);  // not bad usage: only pictures are read there
  CHECK(run_words({"bake", folder.path.string(), "-o", folder / "m.plm"}).code == 1);  // not bad usage
}

}  // namespace files_test
