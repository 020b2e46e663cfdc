#include "host/commands/tracker_limits.hpp"

#include <algorithm>
#include <limits>

#include "host/io/failure.hpp"
#include "host/io/owned.hpp"
#include "pliant/cascade.hpp"

namespace pliant::host {

namespace {

/// Width of the frames from which profile L is the default, px: halfway between 320, for which profile M is made, and
/// 640, for which profile L is. Round value, not tuned.
constexpr int kLargeWidth = 480;

}  // namespace

std::uint32_t whole_search(const Model& model, const TrackerLimits& limits) {
  if (!model.print().empty()) return std::numeric_limits<std::uint32_t>::max();
  const TrackerLimits usual;  // whose search takes one frame
  const auto area = [](const TrackerLimits& l) { return static_cast<double>(l.width) * l.height; };
  return static_cast<std::uint32_t>(usual.search_work * std::max(1.0, area(limits) / area(usual)));
}

TrackerLimits tracker_limits(const Args& args, const std::optional<ImageSize>& size) {
  const std::string by_width = size && size->width >= kLargeWidth ? "l" : "m";
  const std::string profile = args.text("--profile").value_or(by_width);
  if (profile != "s" && profile != "m" && profile != "l") fail_usage("--profile: s, m or l, not " + profile);
  TrackerLimits limits = profile == "s" ? profile_s() : profile == "m" ? profile_m() : profile_l();
  if (size) {
    limits.width = static_cast<std::uint16_t>(size->width);
    limits.height = static_cast<std::uint16_t>(size->height);
  }
  limits.vertices = static_cast<std::uint16_t>(args.integer(kVerticesOption.name, limits.vertices, 4, 10000));
  if (!args.has(kPointsOption.name)) return limits;
  // A quarter of the templates is for later key frames, an equal number for each.
  const int points = args.integer(kPointsOption.name, 0, 8, 4096);
  const int each = limits.key_frames > 0 ? points / 4 / limits.key_frames : 0;
  limits.key_patches = static_cast<std::uint16_t>(each * limits.key_frames);
  limits.patches = static_cast<std::uint16_t>(points - limits.key_patches);
  return limits;
}

TrackerLimits with_base_mesh(TrackerLimits limits, const Model& model) {
  limits.vertices = std::max(limits.vertices, static_cast<std::uint16_t>(model.base_uv().count));
  return limits;
}

std::string lack_of(const Model& model, const TrackerLimits& limits,
                    const std::vector<std::uint8_t>& is_free) {
  const auto told = [](std::size_t needed, const char* what, std::size_t room) {
    return "the model has " + std::to_string(needed) + what + ", and the profile memory for " +
           std::to_string(room) + ": take another profile, or bake a smaller model";
  };
  Owned<Cascade> cascade(model);
  if (!is_free.empty()) cascade->set_free(is_free.data());
  const std::size_t free = cascade->column_count(), samples = cascade->samples_per_point();
  if (limits.free_parameters > 0 && free > limits.free_parameters)
    return told(free, " free parameters", limits.free_parameters);
  if (limits.samples_per_point > 0 && samples > limits.samples_per_point)
    return told(samples, " shapes, corrective ones included", limits.samples_per_point);
  return {};
}

}  // namespace pliant::host
