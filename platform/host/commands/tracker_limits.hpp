#pragma once
/// \file tracker_limits.hpp
/// The TrackerLimits that `pliant track` runs with and `pliant plan` describes: those of a profile.
#include <optional>

#include "host/commands/args.hpp"
#include "pliant/tracker_limits.hpp"

namespace pliant::host {

/// The limits of the profile that `--profile` names, else M, or L from a width of 480 px on.
/// \param size  of the frames; none: the size of the profile. Bad usage: another profile.
TrackerLimits tracker_limits(const Args& args, const std::optional<ImageSize>& size);

}  // namespace pliant::host
