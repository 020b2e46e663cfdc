#pragma once
/// \file record_limit.hpp
/// As many shapes as a table has room for.
#include "host/bake/source.hpp"
#include "model/table_reader.hpp"

namespace pliant::host::bake {

/// Shapes of a source, count, at most: a record each, and one for the rest shape.
constexpr std::size_t kMostShapes = table::kMaxRecords - 1;

/// If there are too many shapes, leaves out corrective ones, first those that move the surface least at one standard deviation of
/// both parameters, and adds a warning that tells how many. The others stay, in their order, even if they are too many.
void leave_out_corrections(Source& source);

}  // namespace pliant::host::bake
