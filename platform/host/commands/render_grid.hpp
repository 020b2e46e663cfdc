#pragma once
/// \file render_grid.hpp
/// Renders several people with the same expressions into one picture (the paper, Figure 4).
#include <string>

#include "host/commands/command.hpp"
#include "host/io/files.hpp"
#include "host/io/image.hpp"

namespace pliant::host {

/// Renders one column for each row of `people` and one row for each row of `expressions`. Both are tables with a column `name`
/// and columns of parameters. The first gives identities, the second expressions and poses. `people` may have a column
/// `tone`, the brightness of the surface (1). Bad input: no column `name`, no rows, more than 64 rows.
/// \param cell  size of one picture.
Image draw_grid(const ModelFile& file, const std::string& people, const std::string& expressions,
                ImageSize cell, Console& console);

}  // namespace pliant::host
