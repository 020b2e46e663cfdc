// The luma of a camera's buffers, and the queue between its thread and the application's. No camera is needed.
#include <doctest/doctest.h>

#include <thread>
#include <vector>

#include "camera/frame_queue.hpp"
#include "camera/luma_layout.hpp"
#include "cli_run.hpp"
#include "host/io/camera_spec.hpp"
#include "host/io/frame_source.hpp"
#include "host/io/owned.hpp"
#include "pliant/pyramid.hpp"

namespace libcamera_test {

using namespace pliant;
using namespace cli_run;

namespace {

constexpr std::uint32_t kYuyv = fourcc('Y', 'U', 'Y', 'V'), kUyvy = fourcc('U', 'Y', 'V', 'Y'),
                        kNv12 = fourcc('N', 'V', '1', '2'), kYuv420 = fourcc('Y', 'U', '1', '2'),
                        kR8 = fourcc('R', '8', ' ', ' '), kMjpeg = fourcc('M', 'J', 'P', 'G');
constexpr int kWidth = 22, kHeight = 9;

std::uint8_t luma_at(int x, int y) {
  return static_cast<std::uint8_t>(7 * x + 31 * y + 3);
}

/// A plane of `stride` bytes a row with the luma where the format has it, and 0xee everywhere else.
std::vector<std::uint8_t> plane_of(const LumaLayout& layout, std::size_t stride) {
  std::vector<std::uint8_t> plane(stride * kHeight, 0xee);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      plane[static_cast<std::size_t>(y) * stride +
            static_cast<std::size_t>(layout.first_byte + x * layout.pixel_step_bytes)] = luma_at(x, y);
  return plane;
}

bool shows_the_luma(const FrameView& v) {
  for (int y = 0; y < v.height; ++y)
    for (int x = 0; x < v.width; ++x)
      if (v.data[static_cast<std::size_t>(y) * v.stride_bytes +
                 static_cast<std::size_t>(x * v.pixel_step_bytes)] != luma_at(x, y))
        return false;
  return true;
}

}  // namespace

TEST_CASE("the luma of every layout is seen in the camera's own memory, with and without padding") {
  for (const std::uint32_t format : {kR8, kNv12, kYuv420, kYuyv, kUyvy}) {
    CAPTURE(fourcc_text(format));
    const LumaLayout* layout = luma_layout(format);
    REQUIRE(layout != nullptr);
    CHECK(layout->pixel_step_bytes == (format == kYuyv || format == kUyvy ? 2 : 1));
    const auto row = static_cast<std::size_t>(kWidth * layout->pixel_step_bytes);
    for (const std::size_t stride : {row, row + 10, std::size_t{64}}) {
      const auto plane = plane_of(*layout, stride);
      FrameView v;
      v.time_ns = 77;
      v.sequence = 5;
      REQUIRE(view_luma(*layout, {plane.data(), plane.size()}, kWidth, kHeight, stride, &v) == Status::ok);
      CHECK(check(v) == Status::ok);
      CHECK(v.data == plane.data() + layout->first_byte);
      CHECK(v.stride_bytes == stride);
      CHECK(v.time_ns == 77);
      CHECK(v.sequence == 5);
      CHECK(shows_the_luma(v));
    }
  }
}

TEST_CASE("a stride of 0 means rows without padding") {
  const LumaLayout& layout = *luma_layout(kYuyv);
  const auto plane = plane_of(layout, 2 * kWidth);
  FrameView v;
  REQUIRE(view_luma(layout, {plane.data(), plane.size()}, kWidth, kHeight, 0, &v) == Status::ok);
  CHECK(v.stride_bytes == 2 * kWidth);
  CHECK(shows_the_luma(v));
}

TEST_CASE("a plane may end with its last luma byte, and not one earlier") {
  for (const std::uint32_t format : {kR8, kYuyv, kUyvy}) {
    const LumaLayout& layout = *luma_layout(format);
    const std::size_t stride = 64;
    const auto plane = plane_of(layout, stride);
    const std::size_t needed =
        (kHeight - 1) * stride +
        static_cast<std::size_t>((kWidth - 1) * layout.pixel_step_bytes + 1 + layout.first_byte);
    FrameView v;
    CHECK(view_luma(layout, {plane.data(), needed}, kWidth, kHeight, stride, &v) == Status::ok);
    v = {};
    CHECK(view_luma(layout, {plane.data(), needed - 1}, kWidth, kHeight, stride, &v) == Status::truncated);
    CHECK(v.data == nullptr);
    CHECK(view_luma(layout, {plane.data(), 0}, kWidth, kHeight, stride, &v) == Status::truncated);
  }
}

TEST_CASE("impossible planes are refused") {
  const LumaLayout& layout = *luma_layout(kYuyv);
  const auto plane = plane_of(layout, 64);
  const PlaneMemory memory{plane.data(), plane.size()};
  FrameView v;
  CHECK(view_luma(layout, {nullptr, 1000}, kWidth, kHeight, 64, &v) == Status::bad_argument);
  CHECK(view_luma(layout, memory, 0, kHeight, 64, &v) == Status::bad_argument);
  CHECK(view_luma(layout, memory, -3, kHeight, 0, &v) == Status::bad_argument);
  CHECK(view_luma(layout, memory, kWidth, 0, 64, &v) == Status::bad_argument);
  CHECK(view_luma(layout, memory, kWidth, kHeight, 2 * kWidth - 2, &v) == Status::bad_argument);
  CHECK(v.data == nullptr);
}

TEST_CASE("packed luma makes the same pyramid as planar luma") {
  const LumaLayout& packed = *luma_layout(kUyvy);
  const LumaLayout& planar = *luma_layout(kR8);
  const auto a = plane_of(packed, 64), b = plane_of(planar, kWidth);
  FrameView va, vb;
  REQUIRE(view_luma(packed, {a.data(), a.size()}, kWidth, kHeight, 64, &va) == Status::ok);
  REQUIRE(view_luma(planar, {b.data(), b.size()}, kWidth, kHeight, kWidth, &vb) == Status::ok);
  PyramidLimits limits;
  limits.width = kWidth;
  limits.height = kHeight;
  limits.levels = 1;
  Owned<Pyramid> pa(limits), pb(limits);
  REQUIRE(pa->build(va) == Status::ok);
  REQUIRE(pb->build(vb) == Status::ok);
  const ImageView &la = pa->level(0), &lb = pb->level(0);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) CHECK(la.data[y * la.stride + x] == lb.data[y * lb.stride + x]);
}

TEST_CASE("formats without luma of eight bits in place are recognised") {
  for (const std::uint32_t format : {kMjpeg, fourcc('R', 'G', '2', '4'), fourcc('B', 'G', '1', '0'),
                                     fourcc('R', '1', '0', ' '), std::uint32_t{0}})
    CHECK(luma_layout(format) == nullptr);
  CHECK(fourcc_text(kYuyv) == "YUYV");
  CHECK(fourcc_text(kR8) == "R8");
  CHECK(fourcc_text(0x01020304) == "????");
}

TEST_CASE("among readable formats the nearest size is chosen, and planar is preferred to packed") {
  std::uint32_t format = 0;
  FormatOffer::Size size;
  const std::vector<FormatOffer::Size> some = {{320, 240}, {640, 480}, {1280, 720}};
  REQUIRE(choose_format({{kMjpeg, some}, {kYuyv, some}, {kNv12, some}}, 640, 480, &format, &size));
  CHECK(format == kNv12);
  CHECK(size.width == 640);
  CHECK(size.height == 480);
  // A size that only the packed format has is worth the copy.
  REQUIRE(choose_format({{kNv12, {{1280, 720}}}, {kYuyv, some}}, 320, 240, &format, &size));
  CHECK(format == kYuyv);
  CHECK(size.width == 320);
  // No list of sizes: any will do.
  REQUIRE(choose_format({{kYuv420, {}}}, 500, 400, &format, &size));
  CHECK(size.width == 500);
  CHECK(size.height == 400);
  // Rather somewhat too large than as much too small.
  REQUIRE(choose_format({{kR8, {{300, 200}, {500, 400}}}}, 400, 300, &format, &size));
  CHECK(size.width == 500);
  CHECK_FALSE(choose_format({{kMjpeg, some}}, 640, 480, &format, &size));
  CHECK_FALSE(choose_format({}, 640, 480, &format, &size));
}

TEST_CASE("a full queue drops its oldest item and counts it") {
  using namespace std::chrono_literals;
  FrameQueue<int> queue(2);
  CHECK_FALSE(queue.push(1).has_value());
  CHECK_FALSE(queue.push(2).has_value());
  CHECK(queue.push(3) == 1);
  CHECK(queue.push(4) == 2);
  CHECK(queue.dropped_count() == 2);
  CHECK(queue.pop(0ms) == 3);
  CHECK_FALSE(queue.push(5).has_value());
  CHECK(queue.pop(0ms) == 4);
  CHECK(queue.pop(0ms) == 5);
  CHECK_FALSE(queue.pop(1ms).has_value());
  CHECK(queue.dropped_count() == 2);
  FrameQueue<int> least(0);  // holds one all the same
  CHECK_FALSE(least.push(1).has_value());
  CHECK(least.push(2) == 1);
}

TEST_CASE("a closed queue accepts nothing, gives the items it has, and then returns at once") {
  using namespace std::chrono_literals;
  FrameQueue<int> queue(3);
  CHECK_FALSE(queue.push(1).has_value());
  queue.close();
  CHECK(queue.push(2) == 2);
  CHECK(queue.pop(10s) == 1);
  CHECK_FALSE(queue.pop(10s).has_value());
  queue.reset();
  CHECK_FALSE(queue.is_closed());
  CHECK_FALSE(queue.push(3).has_value());
  CHECK(queue.pop(10s) == 3);
}

TEST_CASE(
    "between two threads items keep their order, none is doubled, and the lost ones are counted as dropped") {
  using namespace std::chrono_literals;
  FrameQueue<int> queue(4);
  constexpr int kCount = 20000;
  std::uint64_t returned = 0;
  std::thread camera([&] {
    for (int k = 0; k < kCount; ++k)
      if (queue.push(k)) ++returned;
    queue.close();
  });
  int last = -1, taken = 0;
  while (const auto item = queue.pop(10s)) {
    CHECK(*item > last);
    last = *item;
    ++taken;
  }
  camera.join();
  CHECK(last == kCount - 1);  // the newest is never the one that goes
  CHECK(returned == queue.dropped_count());
  CHECK(static_cast<std::uint64_t>(taken) + returned == kCount);
}

TEST_CASE("a waiting thread is woken by a frame and by the end") {
  using namespace std::chrono_literals;
  FrameQueue<int> queue(1);
  std::thread camera([&] {
    std::this_thread::sleep_for(20ms);
    queue.push(1);
    std::this_thread::sleep_for(20ms);
    queue.close();
  });
  const auto start = std::chrono::steady_clock::now();
  CHECK(queue.pop(20s) == 1);
  CHECK_FALSE(queue.pop(20s).has_value());
  CHECK(std::chrono::steady_clock::now() - start < 10s);
  camera.join();
}

TEST_CASE("a camera is given by nothing, a number or an id, and optionally a size") {
  const struct {
    const char *name, *camera;
    int width, height;
  } cases[] = {
      {"camera:", "", 640, 480},
      {"camera:@320x240", "", 320, 240},
      {"camera:1", "1", 640, 480},
      {"camera:0@1280x720", "0", 1280, 720},
      {"camera:/base/soc/i2c0mux/i2c@1/imx219@10", "/base/soc/i2c0mux/i2c@1/imx219@10", 640, 480},
      {"camera:/base/soc/i2c0mux/i2c@1/imx219@10@800x600", "/base/soc/i2c0mux/i2c@1/imx219@10", 800, 600},
      {"camera:\\_SB_.PCI0-1:1.0-1d6b:0102", "\\_SB_.PCI0-1:1.0-1d6b:0102", 640, 480},
      {"camera:a@15x15", "a@15x15", 640, 480},
      {"camera:a@99999x10", "a@99999x10", 640, 480},
      {"camera:a@x", "a@x", 640, 480},
      {"camera:a@-32x32", "a@-32x32", 640, 480},
  };
  for (const auto& c : cases) {
    CAPTURE(c.name);
    CameraSpec spec;
    REQUIRE(parse_camera_spec(c.name, &spec));
    CHECK(spec.camera == c.camera);
    CHECK(spec.width == c.width);
    CHECK(spec.height == c.height);
  }
  CameraSpec spec;
  CHECK_FALSE(parse_camera_spec("cameras", &spec));
  CHECK_FALSE(parse_camera_spec("video.y4m", &spec));
}

TEST_CASE("a missing camera gives one line and exit code 1") {
  const Folder folder;
  const std::string model = folder.put("m.plm", model_bytes());
  const Ran r =
      run_words({"track", model, "--frames", "camera:no such camera", "--init", "f", "--out", folder / "t"});
  CAPTURE(r.err);
  CHECK(r.code == 1);
  CHECK(is_one_line(r.err));
  CHECK((contains(r.err, "no camera") || contains(r.err, "without libcamera")));
  CHECK_FALSE(folder.has("t"));
  CHECK(run_words({"camera", "dance"}).code == 2);
  const Ran list = run_words({"camera", "list"});
  CHECK(list.code == (list.out.empty() ? 1 : 0));  // a machine may have one
  CHECK(is_one_line(list.out.empty() ? list.err : list.out.substr(0, list.out.find('\n') + 1)));
}

}  // namespace libcamera_test
