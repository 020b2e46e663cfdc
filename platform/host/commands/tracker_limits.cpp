#include "host/commands/tracker_limits.hpp"

#include "host/io/failure.hpp"

namespace pliant::host {

namespace {

/// Width of the frames from which profile L is the default, px: halfway between 320, for which profile M is made, and
/// 640, for which profile L is. Round value, not tuned.
constexpr int kLargeWidth = 480;

}  // namespace

TrackerLimits tracker_limits(const Args& args, const std::optional<ImageSize>& size) {
  const std::string by_width = size && size->width >= kLargeWidth ? "l" : "m";
  const std::string profile = args.text("--profile").value_or(by_width);
  if (profile != "s" && profile != "m" && profile != "l") fail_usage("--profile: s, m or l, not " + profile);
  TrackerLimits limits = profile == "s" ? profile_s() : profile == "m" ? profile_m() : profile_l();
  if (size) {
    limits.width = static_cast<std::uint16_t>(size->width);
    limits.height = static_cast<std::uint16_t>(size->height);
  }
  return limits;
}

}  // namespace pliant::host
