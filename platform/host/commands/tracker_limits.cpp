#include "host/commands/tracker_limits.hpp"

#include "host/io/failure.hpp"

namespace pliant::host {

namespace {

constexpr int kLargeWidth = 480;  // px, from here the large profile

}  // namespace

TrackerLimits tracker_limits(const Args& args, const std::optional<ImageSize>& size) {
  const auto profile = args.text("--profile");
  if (profile && *profile != "s" && *profile != "l") fail_usage("--profile: s or l, not " + *profile);
  const bool small = profile == "s",
             large = profile == "l" || (!profile && size && size->width >= kLargeWidth);
  TrackerLimits limits = small ? profile_s() : large ? profile_l() : TrackerLimits{};
  if (size) {
    limits.width = static_cast<std::uint16_t>(size->width);
    limits.height = static_cast<std::uint16_t>(size->height);
  }
  return limits;
}

}  // namespace pliant::host
