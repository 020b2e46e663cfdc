// Fuzzes the C interface: a sequence of calls with any limits, frames, points, poses, boxes and states on a small model. Whatever
// the order and the numbers, a call gives a status of the interface, and results are finite.
#include <cstdlib>
#include <cstring>
#include <string>

#include "aligned_block.hpp"
#include "model_table.hpp"
#include "pliant/geometry.hpp"
#include "pliant/pliant.h"
#include "random.hpp"

namespace {

constexpr std::size_t kMostPixels = 160 * 160, kMostCalls = 24;

void require(bool condition) {
  if (!condition) std::abort();
}

/// The input, and zeros behind its end.
struct Bytes {
  const std::uint8_t* at;
  const std::uint8_t* end;
  unsigned next() { return at < end ? *at++ : 0; }
  unsigned word() {  // one call after the other: the order within an expression is the compiler's
    const unsigned low = next();
    return low | next() << 8;
  }
  /// Usual numbers more often than any bits.
  float number(float usual) {
    static constexpr float kEdges[] = {0, -0.0f, 1, -1, 1e-38f, 1e20f, -1e30f, 3e38f, 64, 1e-6f};
    const unsigned kind = next();
    if (kind < 160) return usual * (1 + (static_cast<float>(next()) - 128) / 512);
    if (kind < 200) return kEdges[kind % 10];
    std::uint32_t bits = word();
    bits |= word() << 16;
    float any;
    std::memcpy(&any, &bits, sizeof any);
    return any;
  }
};

struct Session {
  fuzz::Table table{fuzz::small_table()};
  AlignedBlock block{std::size_t{1} << 22};
  std::vector<std::uint8_t> pixels;
  Session() {
    Random random(7);
    for (std::size_t k = 0; k < 2 * kMostPixels; ++k)
      pixels.push_back(static_cast<std::uint8_t>(random.below(40) + (k / 7 % 3 == 0 ? 80 : 0) +
                                                 (k / 1100 % 2 == 0 ? 60 : 0)));
  }
};

class Calls {
 public:
  Calls(Session& session, Bytes bytes) : session_(session), bytes_(bytes) {}

  void run() {
    if (!create()) return;
    for (std::size_t k = 0; k < kMostCalls && bytes_.at < bytes_.end; ++k) call();
  }

 private:
  bool create() {
    limits_ = pliant_profile("SMLx"[bytes_.next() % 16 == 0 ? bytes_.next() % 4 : 0]);
    limits_.width = limits_.height = 96;
    limits_.region_width = limits_.region_height = 0;
    if (bytes_.next() % 2 == 0) {
      std::uint8_t* raw = reinterpret_cast<std::uint8_t*>(&limits_);
      for (unsigned k = bytes_.next() % 4; k > 0; --k)
        raw[bytes_.next() % sizeof limits_] = static_cast<std::uint8_t>(bytes_.next());
    }
    size_t needed = 0;
    const pliant_status measured =
        pliant_required_bytes(session_.table.data(), session_.table.size(), &limits_, &needed);
    if (measured != PLIANT_OK || needed > session_.block.size()) return false;
    const size_t given = bytes_.next() % 8 == 0 ? bytes_.word() % (needed + 1) : needed;
    const pliant_status status = pliant_create(session_.block.data(), given, session_.table.data(),
                                               session_.table.size(), &limits_, &tracker_);
    require((status == PLIANT_OK) == (given >= needed));
    return status == PLIANT_OK;
  }

  pliant_frame frame() {
    pliant_frame f{};
    f.pixel_step_bytes = bytes_.next() % 16 == 0 ? static_cast<int32_t>(bytes_.next() % 4) : 1;
    f.width = bytes_.next() % 16 == 0 ? static_cast<int32_t>(bytes_.word()) - 100 : limits_.width;
    f.height = bytes_.next() % 16 == 0 ? static_cast<int32_t>(bytes_.word()) - 100 : limits_.height;
    f.stride_bytes = static_cast<std::size_t>(limits_.width) * 2;
    if (bytes_.next() % 16 == 0) f.stride_bytes = bytes_.word();
    // Only what is there may be named: sizes are the caller's promise.
    const bool is_small =
        f.width > 0 && f.height > 0 && f.stride_bytes * static_cast<std::size_t>(f.height) <= kMostPixels;
    f.pixels = is_small && bytes_.next() % 16 != 0 ? session_.pixels.data() + bytes_.next() : nullptr;
    sequence_ += bytes_.next() % 8 == 0 ? bytes_.next() - 8u : 1u;
    f.sequence = sequence_;
    f.time_ns = bytes_.next() % 8 == 0 ? static_cast<int64_t>(bytes_.word()) << (bytes_.next() % 48)
                                       : 33333333ll * sequence_;
    return f;
  }
  pliant_camera camera() {
    return {bytes_.number(130), bytes_.number(48), bytes_.number(48),
            bytes_.number(0),   bytes_.number(0),  bytes_.number(0)};
  }
  pliant_pose pose() {
    return {{bytes_.number(1), bytes_.number(0), bytes_.number(0), bytes_.number(0)},
            {bytes_.number(0), bytes_.number(0), bytes_.number(300)}};
  }
  pliant_start_options options(const pliant_camera* camera) {
    return {bytes_.next() % 2 == 0 ? camera : nullptr, bytes_.number(130), bytes_.next() % 2,
            bytes_.next() % 4};
  }

  void call() {
    const unsigned what = bytes_.next() % 9;
    if (what < 5) return start(what);
    if (what == 5) return save();
    if (what == 6) return ask();
    pliant_result result;
    const pliant_frame f = frame();
    check(pliant_update(tracker_, &f, &result));
  }

  void start(unsigned how) {
    const pliant_frame f = frame();
    const pliant_camera c = camera();
    const pliant_start_options o = options(&c);
    if (how == 0) return check(pliant_start_by_detection(tracker_, &o));
    if (how == 1) {
      const pliant_pose p = pose();
      const float q[4] = {bytes_.number(0), bytes_.number(0.1f), bytes_.number(0), bytes_.number(0.1f)};
      return check(pliant_start_from_pose(tracker_, &f, &c, &p, q));
    }
    if (how == 2) {
      const float x = bytes_.number(20), y = bytes_.number(20);
      const float width = bytes_.number(50), height = bytes_.number(60);
      return check(pliant_start_from_box(tracker_, &f, x, y, width, height, &o));
    }
    if (how == 3) return start_from_points(f, o);
    pliant_state s = state();
    s.camera = c;
    s.pose = pose();
    for (float& q : parameters_) q = bytes_.number(0.1f);
    check(pliant_start_from_state(tracker_, &f, &s));
  }

  void start_from_points(const pliant_frame& f, const pliant_start_options& o) {
    static const char* const kNames[] = {"eye_right",  "eye_left", "nose_tip", "mouth_right",
                                         "mouth_left", "ibug00",   "none",     ""};
    std::vector<pliant_point> points;
    for (unsigned k = bytes_.next() % 9; k > 0; --k) {
      const unsigned name = bytes_.next() % 8;
      points.push_back({kNames[name], bytes_.number(20 + 14 * static_cast<float>(name % 4)),
                        bytes_.number(30 + 8 * static_cast<float>(name))});
    }
    check(pliant_start_from_landmarks(tracker_, &f, points.data(), points.size(), &o));
  }

  pliant_state state() {
    pliant_state s{};
    s.parameters = parameters_;
    s.landmark_offsets = offsets_;
    s.parameter_count = bytes_.next() % 16 == 0 ? bytes_.next() % 5 : 4;
    s.landmark_count = bytes_.next() % 2 == 0 ? 15 : 0;
    return s;
  }

  void save() {
    pliant_state s = state();
    const pliant_status status = pliant_save(tracker_, &s);
    require(status <= PLIANT_STALE_FRAME);
    if (status != PLIANT_OK) return;
    require(pliant::is_finite(s.pose.t[2]) && s.pose.t[2] > 0);
    for (const float q : parameters_) require(pliant::is_finite(q));
  }

  void ask() {
    const char* name = nullptr;
    float x = 0, y = 0;
    require(pliant_landmark_name(tracker_, bytes_.next(), &name) <= PLIANT_STALE_FRAME);
    if (pliant_get_landmark_at(tracker_, bytes_.next(), &x, &y) == PLIANT_OK)
      require(pliant::is_finite(x) && pliant::is_finite(y));
    if (pliant_get_parameter(tracker_, "jawOpen", &x) == PLIANT_OK) require(pliant::is_finite(x));
  }

  /// After a call; what a tracker tells while it has a track is finite.
  void check(pliant_status status) {
    require(status <= PLIANT_STALE_FRAME);
    pliant_result result;
    if (pliant_get_result(tracker_, &result) != PLIANT_OK || result.state == PLIANT_LOST) return;
    for (const float x : result.pose.q) require(pliant::is_finite(x));
    for (const float x : result.pose.t) require(pliant::is_finite(x));
    require(result.pose.t[2] > 0 && pliant::is_finite(result.rms_px));
  }

  Session& session_;
  Bytes bytes_;
  pliant_limits limits_{};
  pliant_tracker* tracker_ = nullptr;
  std::uint32_t sequence_ = 0;
  float parameters_[4] = {}, offsets_[45] = {};
};

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static Session session;
  Calls(session, {data, data + size}).run();
  return 0;
}
