// Videos through the ffmpeg program: a stand-in for it on PATH, which shows how it is called and how its failure is told; and
// the program itself, where it is installed.
#include <doctest/doctest.h>

#include <csignal>
#include <cstdlib>

#include "cli_run.hpp"
#include "host/commands/live_window.hpp"
#include "host/io/failure.hpp"
#include "host/io/files.hpp"
#include "host/io/frame_source.hpp"

namespace video_file_test {

using namespace pliant;
using namespace pliant::host;
using namespace cli_run;

namespace {

/// PATH with a folder in front, or that folder alone, until the object's end.
class SearchPath {
 public:
  SearchPath(const std::string& folder, bool is_alone) : before_(std::getenv("PATH")) {
    setenv("PATH", is_alone ? folder.c_str() : (folder + ":" + before_).c_str(), 1);
  }
  ~SearchPath() { setenv("PATH", before_.c_str(), 1); }
  SearchPath(const SearchPath&) = delete;
  SearchPath& operator=(const SearchPath&) = delete;

 private:
  std::string before_;
};

void put_program(const Folder& folder, const std::string& name, const std::string& script) {
  fs::permissions(folder.put(name, "#!/bin/sh\n" + script), fs::perms::owner_all);
}

std::size_t frame_count(FrameSource& source, Status* end) {
  FrameView frame;
  std::size_t count = 0;
  while ((*end = source.next(frame)) == Status::ok) ++count;
  return count;
}

const char* const kTwoFrames = "printf 'YUV4MPEG2 W2 H1 F25:1 Cmono\\nFRAME\\nabFRAME\\ncd'\n";

}  // namespace

TEST_CASE("a file that is no Y4M is read through ffmpeg, and its name is never a word of a shell") {
  const Folder folder;
  put_program(folder, "ffmpeg",
              "for a in \"$@\"; do echo \"$a\" >> \"${0%/*}/words\"; done\n" + std::string(kTwoFrames));
  const SearchPath path(folder.path.string(), false);
  const std::string name = "a clip; touch 'x' $(touch y).mp4";
  const OpenedFrames opened = open_frames(folder.put(name, "not a video of ours"));
  REQUIRE(opened.source != nullptr);
  CHECK(opened.source->width() == 2);
  Status end;
  CHECK(frame_count(*opened.source, &end) == 2);
  CHECK(end == Status::end_of_stream);
  CHECK(contains(read_file(folder / "words"), "-i\nfile:" + (folder / name) + "\n"));
  CHECK_FALSE(folder.has("x"));
  CHECK_FALSE(folder.has("y"));
}

TEST_CASE("a program's errors are kept in memory: a device may have no folder that can be written") {
  const Folder folder;
  put_program(folder, "ffmpeg", "readlink /proc/$$/fd/2 > \"${0%/*}/errors\"\n" + std::string(kTwoFrames));
  const SearchPath path(folder.path.string(), false);
  REQUIRE(open_frames(folder.put("a.mp4", "not a video of ours")).source != nullptr);
  CHECK(contains(read_file(folder / "errors"), "memfd:"));
}

TEST_CASE("what ffmpeg says of its failure is told, at the start and after some frames") {
  const Folder folder;
  put_program(folder, "ffmpeg", "echo 'first line' >&2; echo 'no such codec' >&2; exit 1\n");
  const SearchPath path(folder.path.string(), false);
  const std::string clip = folder.put("clip.mov", "x");
  const OpenedFrames none = open_frames(clip);
  CHECK(none.source == nullptr);
  CHECK(none.message == clip + ": cannot be read as a video: no such codec");
  put_program(folder, "ffmpeg", kTwoFrames + std::string("echo 'damaged' >&2; exit 1\n"));
  const OpenedFrames some = open_frames(clip);
  REQUIRE(some.source != nullptr);
  Status end;
  CHECK(frame_count(*some.source, &end) == 2);
  CHECK(end == Status::truncated);
  CHECK(some.source->message() == clip + ": frame 2: ffmpeg: damaged");
}

TEST_CASE("what ffmpeg says of a file that is cut off is told, though it does not call it a failure") {
  const Folder folder;
  const SearchPath path(folder.path.string(), false);
  const std::string clip = folder.put("clip.mkv", "x");
  for (const std::string says : {"File ended prematurely at pos. 9", "stream 0, offset 0x7: partial file"}) {
    put_program(folder, "ffmpeg", kTwoFrames + ("echo '" + says + "' >&2; echo 'Invalid data' >&2\n"));
    const OpenedFrames some = open_frames(clip);
    REQUIRE(some.source != nullptr);
    Status end;
    CHECK(frame_count(*some.source, &end) == 2);
    CHECK(end == Status::truncated);
    CHECK(some.source->message() == clip + ": frame 2: ffmpeg: " + says);
    CHECK(some.source->note() == "");
  }
}

TEST_CASE("what else ffmpeg says of a file that it reads to the end is a note, and the film is whole") {
  const Sequence s;
  put_program(s, "ffmpeg", "cat '" + s.video + "'; echo 'error while decoding MB 3 5' >&2\n");
  const SearchPath path(s.path.string(), false);
  auto words = s.track_words();
  words[3] = s.put("clip.ts", "x");
  const Ran r = run_words(words);
  CHECK(r.code == 0);
  CHECK(r.err == words[3] + ": was read to its end, though ffmpeg says: error while decoding MB 3 5\n");
  CHECK(contains(r.out, "frames=12 "));

  put_program(s, "ffmpeg", "echo 'nothing to decode' >&2\n");
  check_refused(words, {"clip.ts: cannot be read as a video: nothing to decode"});
}

TEST_CASE("the rate is the mean one that ffprobe tells, else that of ffmpeg's stream") {
  const Folder folder;
  put_program(folder, "ffmpeg", kTwoFrames);
  const SearchPath path(folder.path.string(), false);
  const std::string clip = folder.put("clip.mp4", "x");
  const auto times = [](const std::vector<std::string>& all) {
    std::string lines;
    for (const std::string& time : all) lines += "pts_time=" + time + "\n";
    return lines;
  };
  const std::string stated = "avg_frame_rate=30/1\nnb_frames=N/A\n", none = "avg_frame_rate=0/0\n";
  const struct {
    std::string says;
    double rate;
  } kCases[] = {
      {"avg_frame_rate=96/7\n", 96.0 / 7},
      {none, 25},
      {"avg_frame_rate=N/A\n", 25},
      {"", 25},
      {"avg_frame_rate=1000000000/33366700\n", 29.97},
      {"avg_frame_rate=1/2000000000\n", 25},
      {"avg_frame_rate=1/2\n", 0.5},
      {times({"0.0", "0.1", "0.4"}) + stated, 5},           // what is stated is wrong
      {times({"0.0", "0.1", "0.4"}) + none, 5},             // nothing is
      {times({"0.0", "0.033", "0.067"}) + stated, 30},      // is right but for rounding
      {times({"0.0", "0.4", "0.1", "0.2"}) + stated, 7.5},  // B-frames
      {times({"0.0", "0.0", "0.1", "0.2"}) + stated, 10},   // a picture that is not shown
      {times({"0.0", "N/A", "0.4"}) + stated, 30},
      {times({"1.0", "1.0"}) + stated, 30},
      {times({"0.0"}) + stated, 30},
      {times({"0.0", "5.0", "0.0", "5.0"}) + stated, 30},  // joined recordings, each with a clock of its own
      {stated + stated, 30},                               // a transport stream's is told twice
  };
  for (const auto& c : kCases) {
    CAPTURE(c.says);
    put_program(folder, "ffprobe", "printf '" + c.says + "'\n");
    const OpenedFrames opened = open_frames(clip);
    REQUIRE(opened.source != nullptr);
    CHECK(opened.source->rate().per_second() == doctest::Approx(c.rate).epsilon(1e-5));
  }
}

TEST_CASE("colours are those of the video's matrix, which ffprobe tells") {
  const Folder folder;
  const SearchPath path(folder.path.string(), false);
  const std::string clip = folder.put("clip.mp4", "x");
  using Colour = std::vector<std::uint8_t>;
  // One pixel of red in each: luma, Cb and Cr.
  const struct {
    const char *space, *pixel;
    Colour colour;
  } kCases[] = {
      {"color_space=bt709\n", "\\066\\143\\377", {254, 0, 0}},      // 54, 99, 255
      {"color_space=bt2020nc\n", "\\103\\134\\377", {254, 0, 0}},   // 67, 92, 255
      {"color_space=smpte170m\n", "\\114\\125\\377", {254, 0, 0}},  // 76, 85, 255
      {"color_space=unknown\n", "\\114\\125\\377", {254, 0, 0}},   {"", "\\114\\125\\377", {254, 0, 0}},
  };
  for (const auto& c : kCases) {
    CAPTURE(std::string(c.space));
    put_program(folder, "ffmpeg",
                std::string("printf 'YUV4MPEG2 W1 H1 F25:1 C420jpeg\\nFRAME\\n") + c.pixel + "'\n");
    put_program(folder, "ffprobe", "printf 'avg_frame_rate=30/1\n" + std::string(c.space) + "'\n");
    const OpenedFrames opened = open_frames(clip);
    REQUIRE(opened.source != nullptr);
    CHECK(opened.source->rate().per_second() == doctest::Approx(30));
    FrameView frame;
    REQUIRE(opened.source->next(frame) == Status::ok);
    CHECK(opened.source->colour().pixels == c.colour);
  }
}

TEST_CASE("of a long film the beginning is read, and the rate of an index counts, which knows the whole") {
  const Folder folder;
  put_program(folder, "ffmpeg", kTwoFrames);
  const SearchPath path(folder.path.string(), false);
  const std::string clip = folder.put("clip.mp4", "x");
  const auto rate_where = [&](const std::string& frames) {
    put_program(folder, "ffprobe",
                "echo \"$@\" > \"${0%/*}/words\"\nseq -f pts_time=%g 20000\n"
                "printf 'avg_frame_rate=24/1\\nnb_frames=" +
                    frames + "\\n'\n");
    const OpenedFrames opened = open_frames(clip);
    REQUIRE(opened.source != nullptr);
    return opened.source->rate().per_second();
  };
  CHECK(rate_where("N/A") == doctest::Approx(1));
  CHECK(rate_where("90000") == doctest::Approx(24));
  CHECK(contains(read_file(folder / "words"), "-read_intervals %+#20000 "));
}

TEST_CASE("a PNG with several frames is a video, whatever its name") {
  const Folder folder;
  put_program(folder, "ffmpeg",
              "for a in \"$@\"; do echo \"$a\" >> \"${0%/*}/words\"; done\n" + std::string(kTwoFrames));
  const SearchPath path(folder.path.string(), false);
  const auto chunk = [](const std::string& type, std::size_t bytes) {
    return std::string(3, '\0') + static_cast<char>(bytes) + type + std::string(bytes + 4, 'x');
  };
  const std::string head = "\x89PNG\r\n\x1a\n" + chunk("IHDR", 13);
  const OpenedFrames opened =
      open_frames(folder.put("clip.png", head + chunk("sRGB", 1) + chunk("acTL", 8) + chunk("IDAT", 3)));
  REQUIRE(opened.source != nullptr);
  Status end;
  CHECK(frame_count(*opened.source, &end) == 2);
  CHECK(contains(read_file(folder / "words"), "-f\napng\n-i\nfile:" + (folder / "clip.png") + "\n"));
  // One frame; a chunk behind the picture; cut off; a length that is none: pictures, which these are not.
  const std::string length_of_none = "\xff\xff\xff\xf0zzzz";
  for (const std::string& still : {head + chunk("IDAT", 3) + chunk("acTL", 8), head, head.substr(0, 12),
                                   head + length_of_none + length_of_none, std::string()})
    CHECK(open_frames(folder.put("still.png", still)).source == nullptr);
  CHECK_FALSE(contains(read_file(folder / "words"), "still.png"));
}

TEST_CASE("an animated WebP that ffmpeg does not read is named as what it is") {
  const Folder folder;
  put_program(folder, "ffmpeg", "echo 'Error marking filters as finished' >&2; exit 1\n");
  const SearchPath path(folder.path.string(), false);
  const std::string before_flags = "RIFF1234WEBPVP8X" + std::string("\x0a\0\0\0", 4);
  const std::string clip = folder.put("clip.webp", before_flags + "\x02");
  CHECK(contains(open_frames(clip).message, clip + ": is an animated WebP"));
  const std::string still = folder.put("still.webp", before_flags + "\x10");
  CHECK(open_frames(still).message ==
        still + ": cannot be read as a video: Error marking filters as finished");
}

TEST_CASE("without ffmpeg the message says what to install; Y4M and empty files do not need it") {
  const Folder folder;
  const SearchPath path(folder.path.string(), true);
  const OpenedFrames none = open_frames(folder.put("clip.mp4", "x"));
  CHECK(none.source == nullptr);
  CHECK(contains(none.message, "install ffmpeg"));
  CHECK(contains(open_frames(folder.put("empty.mp4", "")).message, "is empty"));
  CHECK(open_frames(folder.put("video", "YUV4MPEG2 W2 H1 F25:1 Cmono\nFRAME\nab")).source != nullptr);
}

TEST_CASE("a source that is dropped early ends the program behind it") {
  const Folder folder;
  put_program(folder, "ffmpeg", kTwoFrames + std::string("exec sleep 600\n"));
  const SearchPath path(folder.path.string(), false);
  CHECK(open_frames(folder.put("clip.mp4", "x")).source != nullptr);
}

TEST_CASE("a window gets every picture, and its closing or its lack is no crash") {
  const Folder folder;
  const SearchPath path(folder.path.string(), false);
  put_program(folder, "ffplay", "cat > \"${0%/*}/shown.y4m\"\n");
  {
    LiveWindow window({25, 1});
    for (int k = 0; k < 3; ++k) window.show(Image(4, 2, 3));
    CHECK(window.is_open());
    window.close();
  }
  const OpenedFrames shown = open_frames(folder / "shown.y4m");
  REQUIRE(shown.source != nullptr);
  Status end;
  CHECK(frame_count(*shown.source, &end) == 3);

  put_program(folder, "ffplay", "exit 0\n");
  const auto before = std::signal(SIGPIPE, SIG_IGN);  // as main does
  LiveWindow closed({25, 1});
  for (int k = 0; k < 1000 && closed.is_open(); ++k) closed.show(Image(200, 200, 1));
  CHECK_FALSE(closed.is_open());
  closed.close();

  put_program(folder, "ffplay", "echo 'no display' >&2; exit 1\n");
  LiveWindow failing({25, 1});
  const auto show = [&] {
    for (int k = 0; k < 1000; ++k) failing.show(Image(200, 200, 1));
  };
  CHECK_THROWS_WITH_AS(show(), "ffplay: no display", Failure);
  CHECK_FALSE(failing.is_open());
  std::signal(SIGPIPE, before);

  const Folder empty;
  const SearchPath nothing(empty.path.string(), true);
  CHECK_THROWS_WITH_AS(LiveWindow({25, 1}), doctest::Contains("ffplay is not installed"), Failure);
}

TEST_CASE("ffmpeg itself reads what it wrote" *
          doctest::skip(std::system("ffmpeg -version >/dev/null 2>&1") != 0)) {
  const Folder folder;
  const std::string command =
      "ffmpeg -v error -f lavfi -i testsrc=s=64x48:d=0.4:r=25 " + (folder / "clip.mp4");
  REQUIRE(std::system(command.c_str()) == 0);
  const OpenedFrames opened = open_frames(folder / "clip.mp4");
  REQUIRE(opened.source != nullptr);
  CHECK(opened.source->height() == 48);
  CHECK(opened.source->rate().per_second() == 25);
  Status end;
  CHECK(frame_count(*opened.source, &end) == 10);
  CHECK(end == Status::end_of_stream);
  const OpenedFrames bad = open_frames(folder.put("bad.mp4", "this is no video"));
  CHECK(contains(bad.message, "bad.mp4: cannot be read as a video: "));
}

TEST_CASE("a name with a percent sign is that file, not those of a pattern" *
          doctest::skip(std::system("ffmpeg -version >/dev/null 2>&1") != 0)) {
  const Folder folder;
  const auto make = [&](const std::string& size, const std::string& ending, const std::string& name) {
    const std::string made = folder / ("made" + ending);
    const std::string command = "ffmpeg -v error -f lavfi -i testsrc=d=0.4:r=25:s=" + size + " ";
    REQUIRE(std::system((command + (ending == ".bmp" ? "-frames:v 1 -update 1 " : "") + made).c_str()) == 0);
    fs::rename(made, folder / name);
  };
  make("32x24", ".bmp", "s0.bmp");
  make("64x48", ".bmp", "s%d.bmp");
  make("64x48", ".mp4", "s%02d.mp4");
  for (const std::string name : {"s%d.bmp", "s%02d.mp4"}) {
    CAPTURE(name);
    const std::size_t frames = name == "s%d.bmp" ? 1 : 10;
    const OpenedFrames opened = open_frames(folder / name);
    REQUIRE(opened.source != nullptr);
    CHECK(opened.source->width() == 64);
    CHECK(opened.source->rate().per_second() == 25);
    Status end;
    CHECK(frame_count(*opened.source, &end) == frames);
    CHECK(end == Status::end_of_stream);
  }
}

TEST_CASE("times that are irregular give the mean rate in every container" *
          doctest::skip(std::system("ffmpeg -version >/dev/null 2>&1") != 0)) {
  const Folder folder;
  // 30 a second, of which the second half has every fifth frame: 36 frames in 1.8333 s.
  const std::string film =
      "ffmpeg -v error -f lavfi -i testsrc=s=64x48:d=2:r=30 -vf 'select=lt(n\\,30)+not(mod(n\\,5))' -vsync "
      "vfr ";
  for (const char* name : {"a.mp4", "a.mkv", "a.ts", "a.avi"}) {
    CAPTURE(name);
    REQUIRE(std::system((film + "-c:v mpeg4 " + (folder / name)).c_str()) == 0);
    const OpenedFrames opened = open_frames(folder / name);
    REQUIRE(opened.source != nullptr);
    CHECK(opened.source->rate().per_second() == doctest::Approx(35 / (55.0 / 30)).epsilon(0.01));
  }
}

}  // namespace video_file_test
