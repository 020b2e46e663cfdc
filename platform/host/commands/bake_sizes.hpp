#pragma once
/// \file bake_sizes.hpp
#include <string>
#include <vector>

#include "host/bake/bake.hpp"
#include "host/commands/command.hpp"

namespace pliant::host {

/// `pliant bake --sizes`: bytes and errors of the table at each size, 16 and 8 bits a sample, and of the finest small
/// profile (8 bits, 20 identities, 20 expressions) within `flash_bytes`.
void print_sizes(const bake::BakeOptions& options, const std::vector<int>& sizes, std::size_t flash_bytes,
                 Console& console);

}  // namespace pliant::host
