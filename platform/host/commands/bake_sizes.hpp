#pragma once
/// \file bake_sizes.hpp
#include <vector>

#include "host/bake/bake.hpp"
#include "host/commands/command.hpp"

namespace pliant::host {

/// `pliant bake --sizes`: prints bytes and errors of the table for each size, with 16 and with 8 bits a sample. The last row is
/// the largest table of a small profile (8 bits, 20 identities, 20 expressions) that takes at most `flash_bytes`.
void print_sizes(const bake::BakeOptions& options, const std::vector<int>& sizes, std::size_t flash_bytes,
                 Console& console);

}  // namespace pliant::host
