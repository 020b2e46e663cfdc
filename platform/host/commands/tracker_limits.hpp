#pragma once
/// \file tracker_limits.hpp
/// The capacities of the tracker that commands run, and plan for.
#include "host/commands/args.hpp"
#include "pliant/tracker.hpp"

namespace pliant::host {

/// Those of the profile that `--profile` names, else what suits the size of the frames; without a size, the profile's
/// own. Raises UsageError for another profile.
TrackerLimits tracker_limits(const Args& args, const std::optional<ImageSize>& size);

}  // namespace pliant::host
