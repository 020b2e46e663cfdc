#pragma once
/// \file tracker_limits.hpp
/// The TrackerLimits that `pliant track` and `pliant bench faults` run with and `pliant plan` describes: those of a profile.
#include <optional>
#include <string>
#include <vector>

#include "host/commands/args.hpp"
#include "pliant/model.hpp"
#include "pliant/tracker_profiles.hpp"

namespace pliant::host {

/// The options of those commands that change the limits.
constexpr Option kProfileOption{"--profile", "s|m|l", "limits of a small, medium or large device"};
constexpr Option kVerticesOption{"--vertices", "V", "vertices of the mesh, at most"};
constexpr Option kPointsOption{"--points", "N", "templates, those of later key frames included"};

/// Work of a search that takes one frame whatever its size, for videos that need not be tracked in real time; as
/// TrackerLimits::search_work. Of a print there is no bound.
std::uint32_t whole_search(const Model& model, const TrackerLimits& limits);

/// The limits of the profile that `--profile` names, else M, or L from a width of 480 px on; and as the other options say.
/// \param size  of the frames; none: the size of the profile. Bad usage: another profile, and counts out of range.
TrackerLimits tracker_limits(const Args& args, const std::optional<ImageSize>& size);
/// The same limits with as many vertices as the model's base mesh has, at least: without, no tracker can be made.
TrackerLimits with_base_mesh(TrackerLimits limits, const Model& model);

/// What the limits lack for a track of the model, in words; empty if nothing.
/// \param is_free  one flag a parameter: those that every frame estimates.
std::string lack_of(const Model& model, const TrackerLimits& limits,
                    const std::vector<std::uint8_t>& is_free);

}  // namespace pliant::host
