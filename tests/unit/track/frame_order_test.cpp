#include "track/frame_order.hpp"

#include <doctest/doctest.h>

#include <limits>

namespace frame_order_test {

using namespace pliant;

namespace {

FrameView frame(std::int64_t time_ns, std::uint32_t sequence) {
  FrameView view;
  view.time_ns = time_ns;
  view.sequence = sequence;
  return view;
}

}  // namespace

TEST_CASE("a frame is stale if neither its time nor its number goes on") {
  FrameOrder order;
  CHECK_FALSE(order.is_stale(frame(-5, 0)));  // the first one may have any time
  order.note(frame(100, 7));
  CHECK(order.is_stale(frame(100, 7)));
  CHECK(order.is_stale(frame(99, 7)));
  CHECK(order.is_stale(frame(100, 6)));
  CHECK_FALSE(order.is_stale(frame(101, 7)));  // a camera without numbers
  CHECK_FALSE(order.is_stale(frame(50, 8)));   // a clock that was set back
  CHECK_FALSE(order.is_stale(frame(50, 900)));
}

TEST_CASE("numbers may wrap") {
  FrameOrder order;
  order.note(frame(100, 0xFFFFFFFFu));
  CHECK_FALSE(order.is_stale(frame(100, 0)));
  CHECK(order.is_stale(frame(100, 0xFFFFFFFEu)));
  CHECK(order.is_stale(frame(100, 0xF0000000u)));
  CHECK_FALSE(order.is_stale(frame(100, 0x70000000u)));
}

TEST_CASE("after forget_time the next frame may have any time") {
  FrameOrder order;
  order.note(frame(100, 7));
  order.forget_time();
  CHECK_FALSE(order.is_stale(frame(1, 7)));
  constexpr auto kEarliest = std::numeric_limits<std::int64_t>::min();
  CHECK_FALSE(order.is_stale(frame(kEarliest, 7)));
  order.note(frame(kEarliest, 7));
  CHECK(order.is_stale(frame(kEarliest, 7)));
}

}  // namespace frame_order_test
