#pragma once
/// \file bench.hpp
/// The topics of `pliant bench`. Each prints rows `topic,peer,variant,metric,value`; times are medians over repeats in one
/// process, to be compared with another program's of the same run.
#include <ostream>

#include "cli/files.hpp"

namespace pliant::cli {

/// Stellar operators, restricted adaptation, criteria, memory. With a model also its own mesh.
void bench_mesh(std::ostream& out, const ModelFile* model);

}  // namespace pliant::cli
