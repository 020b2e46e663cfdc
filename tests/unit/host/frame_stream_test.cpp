// The frames of a source: their numbers and times, and mirrored.
#include "host/commands/frame_stream.hpp"

#include "cli_run.hpp"
#include "host/io/failure.hpp"

using namespace pliant;
using namespace pliant::host;
using namespace cli_run;

namespace {

/// Three frames of 16 x 16 at 25 frames a second; pixel x of row 0 is 10 k + x in frame k.
std::string film() {
  std::string bytes = "YUV4MPEG2 W16 H16 F25:1 Cmono\n";
  for (int k = 0; k < 3; ++k) {
    bytes += "FRAME\n";
    for (int i = 0; i < 256; ++i) bytes += static_cast<char>(10 * k + i % 16);
  }
  return bytes;
}

}  // namespace

TEST_CASE("frames have numbers, and times from the first frame on") {
  const Folder folder;
  FrameStream frames(folder.put("v.y4m", film()), false);
  CHECK(frames.size().width == 16);
  CHECK(frames.rate().per_second() == 25);
  CHECK_FALSE(frames.is_live());
  FrameView frame;
  for (std::size_t k = 0; k < 3; ++k) {
    REQUIRE(frames.next(&frame));
    CHECK(frames.number(frame) == k);
    CHECK(frames.time_s(frame) == doctest::Approx(0.04 * static_cast<double>(k)));
    CHECK(frame.data[3] == 10 * k + 3);
  }
  CHECK_FALSE(frames.next(&frame));
  CHECK(frames.message().empty());
}

TEST_CASE("mirrored frames have their columns in reverse") {
  const Folder folder;
  FrameStream frames(folder.put("v.y4m", film()), true);
  FrameView frame;
  for (int k = 0; k < 3; ++k) {
    REQUIRE(frames.next(&frame));
    CHECK(frame.width == 16);
    for (int x = 0; x < 16; ++x) CHECK(frame.data[x] == 10 * k + 15 - x);
  }
}

TEST_CASE("a source that does not exist is a failure that names it") {
  const Folder folder;
  CHECK_THROWS_WITH_AS(FrameStream(folder / "none.y4m", false), doctest::Contains("none.y4m"), Failure);
}

TEST_CASE("the picture of a frame is the frame, mirrored as it is, and in colour if the source is") {
  const Folder folder;
  FrameView frame;
  FrameStream grey(folder.put("v.y4m", film()), true);
  REQUIRE(grey.next(&frame));
  CHECK(grey.picture(frame).channels == 1);
  CHECK(*grey.picture(frame).at(0, 0) == 15);
  Image colour(16, 16, 3);
  colour.at(15, 2)[2] = 99;
  FrameStream mirrored(folder.put("p.png", encode_png(colour)), true);
  REQUIRE(mirrored.next(&frame));
  CHECK(mirrored.picture(frame).at(0, 2)[2] == 99);
}
