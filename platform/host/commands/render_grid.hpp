#pragma once
/// \file render_grid.hpp
/// Different people, each with the same expressions, on one picture (Figure 4 of the paper).
#include "host/commands/args.hpp"
#include "host/commands/command.hpp"
#include "host/io/files.hpp"
#include "host/io/image.hpp"

namespace pliant::host {

/// One column a row of `people`, one row a row of `expressions`: tables with a column `name` and columns of parameters,
/// of which the identity is read from the first and expression and pose from the second. `people` may have a column
/// `tone`, the brightness of the skin (1). Bad input: no such column, no rows, more than 64 pictures a side.
/// \param cell  size of one picture.
Image draw_grid(const ModelFile& file, const std::string& people, const std::string& expressions,
                ImageSize cell, Console& console);

}  // namespace pliant::host
