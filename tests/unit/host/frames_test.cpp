#include <doctest/doctest.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "host/io/failure.hpp"
#include "host/io/frame_source.hpp"
#include "host/io/sources.hpp"
#include "host/io/y4m_header.hpp"
#include "host/io/y4m_writer.hpp"

namespace frames_test {

using namespace pliant;
using namespace pliant::host;

namespace {

// A folder of its own, gone at the end of the case.
class Folder {
 public:
  Folder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "pliant_frames_XXXXXX").string();
    REQUIRE(mkdtemp(pattern.data()) != nullptr);
    path_ = pattern;
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  std::string path() const { return path_.string(); }
  std::string write(const std::string& name, const std::string& bytes) const {
    std::ofstream(path_ / name, std::ios::binary) << bytes;
    return (path_ / name).string();
  }

 private:
  std::filesystem::path path_;
};

std::string grey_bytes(int count, int first) {
  std::string s;
  for (int i = 0; i < count; ++i) s.push_back(static_cast<char>(first + i));
  return s;
}

std::string pgm(int width, int height, int first) {
  return "P5\n" + std::to_string(width) + " " + std::to_string(height) + "\n255\n" +
         grey_bytes(width * height, first);
}

struct Run {
  std::vector<std::string> frames;  // luma
  Status end = Status::ok;
  std::string message;
  int width = 0, height = 0;
  double rate = 0;
};

// Reads everything; the message is that of the opener or of the end.
Run read_all(const std::string& name) {
  Run run;
  OpenedFrames opened = open_frames(name);
  if (opened.source == nullptr) {
    CHECK(!opened.message.empty());
    run.end = Status::io_error;
    run.message = opened.message;
    return run;
  }
  FrameSource& source = *opened.source;
  run.width = source.width();
  run.height = source.height();
  run.rate = source.rate().per_second();
  FrameView f;
  while ((run.end = source.next(f)) == Status::ok) {
    REQUIRE(check(f) == Status::ok);
    CHECK(f.sequence == run.frames.size());
    CHECK(source.message().empty());
    run.frames.emplace_back(reinterpret_cast<const char*>(f.data),
                            static_cast<std::size_t>(f.width * f.height));
  }
  CHECK(source.next(f) == run.end);
  run.message = source.message();
  CHECK(run.message.empty() == (run.end == Status::end_of_stream));
  return run;
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

const std::string kHeader = "YUV4MPEG2 W4 H3 F30000:1001 Ip A1:1 Cmono XCOLORRANGE=FULL\n";

}  // namespace

TEST_CASE("a folder is read in the natural order of its names, with comments in the headers") {
  const Folder folder;
  folder.write("f10.pgm", pgm(3, 2, 100));
  folder.write("f9.pgm", "P5 # made by hand\n# 4 4\n3\n2 #\n255\n" + grey_bytes(6, 90));
  folder.write("f009b.PGM", pgm(3, 2, 95));
  folder.write("notes.txt", "not a picture");
  const Run run = read_all(folder.path());
  CHECK(run.end == Status::end_of_stream);
  REQUIRE(run.frames.size() == 3);
  CHECK(run.frames[0] == grey_bytes(6, 90));
  CHECK(run.frames[1] == grey_bytes(6, 95));
  CHECK(run.frames[2] == grey_bytes(6, 100));
  CHECK(run.width == 3);
  CHECK(run.height == 2);
  CHECK(run.rate == 25);
}

TEST_CASE("natural order is a strict order of numbers and text") {
  const std::vector<std::string> sorted = {"a",    "a1",  "a01", "a2",   "a2b",  "a02b", "a10",
                                           "a10b", "ab1", "b",   "b001", "b1.5", "b1.10"};
  for (std::size_t i = 0; i < sorted.size(); ++i)
    for (std::size_t k = 0; k < sorted.size(); ++k) {
      CAPTURE(sorted[i]);
      CAPTURE(sorted[k]);
      if (i == k) CHECK(!is_naturally_before(sorted[i], sorted[k]));
      if (i != k)
        CHECK(is_naturally_before(sorted[i], sorted[k]) != is_naturally_before(sorted[k], sorted[i]));
    }
  CHECK(is_naturally_before("f9.pgm", "f10.pgm"));
  CHECK(is_naturally_before("f00009.pgm", "f00010.pgm"));
  CHECK(is_naturally_before("00099999999999999999999998", "99999999999999999999999"));
}

TEST_CASE("colour becomes luma by the weights of BT.601, and a smaller maximum is stretched") {
  const Folder folder;
  const std::string rgb = {'\xff', 0, 0, 0, '\xff', 0, 0, 0, '\xff', '\x80', '\x80', '\x80'};
  folder.write("1.ppm", "P6 4 1 255\n" + rgb);
  folder.write("2.pgm", std::string("P5 4 1 100\n") + '\0' + 'd' + '2' + '\xff');
  const Run run = read_all(folder.path());
  REQUIRE(run.frames.size() == 2);
  CHECK(run.frames[0] == std::string({'\x4c', '\x96', '\x1d', '\x80'}));
  CHECK(run.frames[1] == std::string({'\0', '\xff', '\x80', '\xff'}));
  const Image grey = host::to_grey(host::read_image(folder.path() + "/1.ppm"));  // whoever reads it
  CHECK(std::string(grey.pixels.begin(), grey.pixels.end()) == run.frames[0]);
  const Image image = host::read_image(folder.path() + "/2.pgm");  // as detect, fit and points read it
  CHECK(image.pixels == std::vector<std::uint8_t>{0, 0, 0, 255, 255, 255, 128, 128, 128, 255, 255, 255});
}

TEST_CASE("comments end a header as the specification of PNM says, at a carriage return, too") {
  const Folder folder;
  const auto pixels_of = [&](const std::string& header) {
    const std::string path = folder.write("c.pgm", header + "abcdef");
    const Run run = read_all(path);
    REQUIRE(run.frames.size() == 1);
    const Image grey = host::to_grey(host::read_image(path));
    CHECK(std::string(grey.pixels.begin(), grey.pixels.end()) == run.frames[0]);
    return run.frames[0];
  };
  for (const std::string header :
       {"P5 3 2 255\n", "P5 3 2#w\r255\n", "P5#c\r3#w\r2#w\n255\r", "P5 3 2 255# of all\n\n", "P5 3 2 255#1\r#2\n ",
        // Not so written in the specification, but by programs.
        "P5 3 2 255#c\n", "P5 3 2 255#c\r"}) {
    CAPTURE(header);
    CHECK(pixels_of(header) == "abcdef");
  }
  CHECK(pixels_of("P5 3 2 255 #").substr(0, 2) == "#a");  // the white space has ended the header
}

TEST_CASE("a picture that is cut off is none, whoever reads it") {
  const Folder folder;
  const std::string whole = "P6 4 1 255\n" + std::string(12, 'x');
  CHECK(host::read_image(folder.write("whole.ppm", whole)).width == 4);
  const std::string path = folder.write("cut.ppm", whole.substr(0, whole.size() - 5));
  CHECK(contains(read_all(path).message, "cut.ppm: ends 5 bytes early"));
  CHECK_THROWS_WITH_AS(host::read_image(path), doctest::Contains("cut.ppm: ends 5 bytes early"),
                       host::Failure);
}

TEST_CASE("one picture is a stream of one frame") {
  const Folder folder;
  CHECK(read_all(folder.write("x.pgm", pgm(5, 5, 1))).frames.size() == 1);
}

TEST_CASE("bad folders and pictures are named, after the good frames before them") {
  const Folder folder;
  CHECK(contains(read_all(folder.path()).message, "no PNG, JPEG, PGM or PPM picture"));
  CHECK(contains(read_all(folder.path() + "/absent").message, "absent: no such file"));
  folder.write("1.pgm", pgm(4, 4, 1));
  folder.write("2.pgm", pgm(4, 5, 1));
  const Run run = read_all(folder.path());
  CHECK(run.frames.size() == 1);
  CHECK(run.end == Status::size_mismatch);
  CHECK(contains(run.message, "2.pgm: is 4x5, but the first picture is 4x4"));
}

TEST_CASE("a PGM cut at any byte gives a status and a message that names the file") {
  const Folder folder;
  const std::string whole = pgm(4, 3, 7);
  folder.write("1.pgm", whole);
  for (std::size_t n = 0; n < whole.size(); ++n) {
    folder.write("2.pgm", whole.substr(0, n));
    const Run run = read_all(folder.path());
    CAPTURE(n);
    CHECK(run.frames.size() == 1);
    CHECK((run.end == Status::io_error || run.end == Status::truncated));
    CHECK(contains(run.message, "2.pgm: "));
    // The raster's 12 bytes start once the maximum is complete; "2" and "25" are maxima, too.
    if (n >= 11) CHECK(contains(run.message, "ends " + std::to_string(whole.size() - n) + " bytes early"));
  }
}

TEST_CASE("impossible PGM headers are refused with the reason") {
  const Folder folder;
  const auto message = [&](const std::string& bytes) {
    return read_all(folder.write("x.pgm", bytes)).message;
  };
  CHECK(contains(message("hello"), "not a PGM"));
  CHECK(contains(message("P2\n1 1\n255\n7"), "P2"));
  CHECK(contains(message("P5\n0 4\n255\n"), "0x4"));
  CHECK(contains(message("P5\n20000 4\n255\n"), "20000x4"));
  CHECK(contains(message("P5\n99999999999999 4\n255\n"), "no width"));
  CHECK(contains(message("P5\n-3 4\n255\n"), "no width"));
  CHECK(contains(message("P5\n3x 4\n255\n"), "no width"));
  CHECK(contains(message("P5\n3 4\n65535\n"), "8-bit"));
  CHECK(contains(message("P5\n3 4\n0\n"), "8-bit"));
  CHECK(contains(message("P5 # no end"), "no width"));
  CHECK(contains(message("P5\n16384 16384\n255\nabc"), "bytes early"));
}

TEST_CASE("a Y4M stream gives its luma, size, rate and times") {
  const Folder folder;
  const std::string path = folder.write(
      "clip.y4m", kHeader + "FRAME\n" + grey_bytes(12, 1) + "FRAME Ip Xsomething\n" + grey_bytes(12, 50));
  const Run run = read_all(path);
  CHECK(run.end == Status::end_of_stream);
  REQUIRE(run.frames.size() == 2);
  CHECK(run.frames[0] == grey_bytes(12, 1));
  CHECK(run.frames[1] == grey_bytes(12, 50));
  CHECK(run.width == 4);
  CHECK(run.height == 3);
  CHECK(run.rate == doctest::Approx(29.97).epsilon(1e-4));
  FrameView f;
  OpenedFrames opened = open_frames(path);
  CHECK(opened.source->next(f) == Status::ok);
  CHECK(f.time_ns == 0);
  CHECK(opened.source->next(f) == Status::ok);
  CHECK(f.time_ns == 33366667);
}

TEST_CASE("chroma of every layout is skipped, for odd sizes too") {
  const struct {
    const char* tag;
    int chroma;
  } layouts[] = {{"Cmono ", 0}, {"C420 ", 12}, {"C420jpeg ", 12}, {"C420mpeg2 ", 12}, {"C420paldv ", 12},
                 {"C422 ", 18}, {"C411 ", 12}, {"C444 ", 30},     {"C444alpha ", 45}, {"", 12}};
  for (const auto& l : layouts) {
    CAPTURE(l.tag);
    const Folder folder;
    const std::string frame =
        "FRAME\n" + grey_bytes(15, 20) + std::string(static_cast<std::size_t>(l.chroma), 'c');
    const Run run =
        read_all(folder.write("x.y4m", std::string("YUV4MPEG2 W5 H3 ") + l.tag + "F25:1\n" + frame + frame));
    CHECK(run.end == Status::end_of_stream);
    REQUIRE(run.frames.size() == 2);
    CHECK(run.frames[1] == grey_bytes(15, 20));
  }
}

TEST_CASE("a stream cut anywhere gives the whole frames before the cut, then says what is missing") {
  for (const std::string& tag : {std::string("Cmono"), std::string("C420jpeg")}) {
    const Folder folder;
    const std::string header = "YUV4MPEG2 W4 H3 F25:1 " + tag + "\n";
    const std::string frame = "FRAME\n" + grey_bytes(12, 1) + std::string(tag == "Cmono" ? 0u : 8u, 'c');
    const std::string whole = header + frame + frame + frame;
    for (std::size_t n = 0; n <= whole.size(); ++n) {
      CAPTURE(n);
      const Run run = read_all(folder.write("cut.y4m", whole.substr(0, n)));
      if (n < header.size()) {
        CHECK(contains(run.message, "cut.y4m: "));
        continue;
      }
      const std::size_t frames = (n - header.size()) / frame.size(),
                        rest = (n - header.size()) % frame.size();
      CHECK(run.frames.size() == frames);
      CHECK(run.end == (rest == 0 ? Status::end_of_stream : Status::truncated));
      if (rest == 0) continue;
      CHECK(contains(run.message, "cut.y4m: frame " + std::to_string(frames) +
                                      " is cut off: " + std::to_string(frame.size() - rest) + " bytes"));
    }
  }
}

TEST_CASE("headers with wrong values are refused with a message that names the value") {
  const Folder folder;
  const auto message = [&](const std::string& line) {
    return read_all(folder.write("lie.y4m", line + "\nFRAME\n" + grey_bytes(12, 1))).message;
  };
  CHECK(contains(message("YUV4MPEG2 H3 F25:1"), "no width"));
  CHECK(contains(message("YUV4MPEG2 W4 F25:1"), "no height"));
  CHECK(contains(message("YUV4MPEG2 W0 H3"), "width is 0"));
  CHECK(contains(message("YUV4MPEG2 W4 H16385"), "height is 16385"));
  CHECK(contains(message("YUV4MPEG2 W99999999999999 H3"), "W99999999999999"));
  CHECK(contains(message("YUV4MPEG2 W-4 H3"), "W-4"));
  CHECK(contains(message("YUV4MPEG2 W H3"), "in W"));
  CHECK(contains(message("YUV4MPEG2 W4 H3 F25"), "F25"));
  CHECK(contains(message("YUV4MPEG2 W4 H3 F1:999999999"), "F1:999999999"));
  CHECK(contains(message("YUV4MPEG2 W4 H3 C420p10"), "C420p10"));
  CHECK(contains(message("YUV4MPEG2 W4 H3 Cmono16"), "Cmono16"));
  CHECK(contains(message("YUV4MPEG2 W4 H3 C"), "space C "));
  CHECK(contains(message("YUV4MPEG W4 H3"), "not a Y4M"));
  CHECK(contains(message("\x89PNG"), "not a Y4M"));
  CHECK(contains(message("YUV4MPEG2 W4 H3 X" + std::string(5000, 'x')), "first line"));
  CHECK(contains(read_all(folder.write("empty.y4m", "")).message, "empty.y4m: is empty"));
}

TEST_CASE("a size that does not fit the frames is noticed at the next frame") {
  const Folder folder;
  const std::string frame = "FRAME\n" + grey_bytes(12, 1);
  const Run small = read_all(folder.write("a.y4m", "YUV4MPEG2 W4 H2 Cmono\n" + frame + frame));
  CHECK(small.frames.size() == 1);
  CHECK(small.end == Status::io_error);
  CHECK(contains(small.message, "a.y4m: frame 1: no FRAME"));
  const Run large = read_all(folder.write("b.y4m", "YUV4MPEG2 W16384 H16384 Cmono\n" + frame));
  CHECK(large.frames.empty());
  CHECK(large.end == Status::truncated);
  CHECK(contains(large.message, "bytes are missing"));
}

TEST_CASE("pixels that are not square are refused: a face would be too narrow") {
  for (const char* aspect : {"", "A1:1 ", "A0:0 ", "A59:59 ", "A1445:1444 ", "A1001:1000 ", "A1000:1001 "}) {
    CAPTURE(aspect);
    Y4mHeader h;
    CHECK(parse_y4m_header(std::string("YUV4MPEG2 ") + aspect + "W4 H3", h).empty());
  }
  for (const char* aspect :
       {"A2:1 ", "A128:117 ", "A1002:1000 ", "A1000:1002 ", "A1:0 ", "A-1:-1 ", "A ", "A1 "}) {
    CAPTURE(aspect);
    Y4mHeader h;
    CHECK(contains(parse_y4m_header(std::string("YUV4MPEG2 ") + aspect + "W4 H3", h), "not square"));
  }
}

TEST_CASE("a limited range is read as the full one") {
  const Folder folder;
  const std::string luma{'\0', '\x10', '\x11', '\x7e', '\xeb', '\xff'};
  for (const char* range : {"", "XCOLORRANGE=FULL ", "XCOLORRANGE=LIMITED "}) {
    const Run run = read_all(
        folder.write("r.y4m", std::string("YUV4MPEG2 W3 H2 Cmono ") + range + "F25:1\nFRAME\n" + luma));
    REQUIRE(run.frames.size() == 1);
    const std::string full{'\0', '\0', '\x01', '\x80', '\xff', '\xff'};
    CHECK(run.frames[0] == (std::string(range) == "XCOLORRANGE=LIMITED " ? full : luma));
  }
}

TEST_CASE("an unknown or zero rate is 25") {
  for (const char* f : {"", "F0:0 ", "F0:1 "}) {
    Y4mHeader h;
    CHECK(parse_y4m_header(std::string("YUV4MPEG2 ") + f + "W4 H3", h).empty());
    CHECK(h.rate.per_second() == 25);
  }
}

TEST_CASE("grey frames are written and read back without change") {
  const Folder folder;
  const std::string path = folder.path() + "/out.y4m";
  Y4mWriter writer(path, {30, 1});
  Image grey(5, 3, 1);
  for (int first : {3, 60}) {
    const std::string g = grey_bytes(15, first);
    std::copy(g.begin(), g.end(), grey.pixels.begin());
    writer.write(grey);
  }
  CHECK_FALSE(std::filesystem::exists(path));
  writer.commit();
  const Run run = read_all(path);
  CHECK(run.end == Status::end_of_stream);
  REQUIRE(run.frames.size() == 2);
  CHECK(run.frames[0] == grey_bytes(15, 3));
  CHECK(run.frames[1] == grey_bytes(15, 60));
  CHECK(run.rate == 30);
}

TEST_CASE("the colour writer writes luma and the chroma of BT.601") {
  const Folder folder;
  const std::string path = folder.path() + "/out.y4m";
  Y4mWriter writer(path, {25, 1});
  // Left four pixels red, the right column (half a block, repeated) blue.
  Image picture(3, 2, 3);
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 3; ++x) picture.at(x, y)[x < 2 ? 0 : 2] = 255;
  writer.write(picture);
  writer.commit();
  const Run run = read_all(path);
  REQUIRE(run.frames.size() == 1);
  CHECK(run.frames[0] == std::string({'\x4c', '\x4c', '\x1d', '\x4c', '\x4c', '\x1d'}));
  std::ifstream file(path, std::ios::binary);
  std::string line;
  std::getline(file, line);
  CHECK(contains(line, "C420jpeg"));
  std::string bytes((std::istreambuf_iterator<char>(file)), {});
  REQUIRE(bytes.size() == 6 + 6 + 4);
  // Cb of red 85 and of blue 255; Cr of red 255 and of blue 107.
  CHECK(bytes.substr(12, 4) == std::string({'\x55', '\xff', '\xff', '\x6b'}));
}

TEST_CASE("a writer that cannot write says why") {
  const Folder folder;
  const std::string path = folder.path() + "/out.y4m";
  CHECK_THROWS_WITH_AS(Y4mWriter("/nowhere/at/all.y4m", {}), doctest::Contains("/nowhere/at/all.y4m: "),
                       Failure);
  Y4mWriter writer(path, {});
  CHECK_THROWS_AS(writer.write(Image(0, 3, 1)), Failure);
  writer.write(Image(4, 3, 1));
  CHECK_THROWS_AS(writer.write(Image(4, 3, 3)), Failure);
  CHECK_THROWS_AS(writer.write(Image(3, 4, 1)), Failure);
  if (std::filesystem::exists("/dev/full")) {
    Y4mWriter full("/dev/full", {});
    CHECK_THROWS_WITH_AS(full.write(Image(4, 3, 1)), doctest::Contains("/dev/full: "), Failure);
  }
}

TEST_CASE("'-' is standard input") {
  const Folder folder;
  const std::string path = folder.write("in.y4m", kHeader + "FRAME\n" + grey_bytes(12, 1) + "FRAME\nabc");
  REQUIRE(std::freopen(path.c_str(), "rb", stdin) != nullptr);
  const Run run = read_all("-");
  CHECK(run.frames.size() == 1);
  CHECK(run.end == Status::truncated);
  CHECK(run.message == "standard input: frame 1 is cut off: 9 bytes are missing");
}

TEST_CASE("a folder may hold PNG, JPEG and PNM pictures, and names the damaged one") {
  const Folder folder;
  Image grey(8, 8, 1, 77);
  folder.write("1.png", encode_png(grey));
  folder.write("2.JPG", encode_jpeg(grey, 95));
  folder.write("3.pgm", pgm(8, 8, 9));
  const Run run = read_all(folder.path());
  CHECK(run.end == Status::end_of_stream);
  REQUIRE(run.frames.size() == 3);
  CHECK(run.frames[0] == std::string(64, 77));
  CHECK(run.frames[1] == run.frames[0]);
  CHECK(run.frames[2] == grey_bytes(64, 9));
  folder.write("2.JPG", "no picture");
  const Run damaged = read_all(folder.path());
  CHECK(damaged.frames.size() == 1);
  CHECK(contains(damaged.message, "2.JPG: is not a picture"));
}

}  // namespace frames_test
