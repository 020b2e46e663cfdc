#pragma once
/// \file size_table.hpp
/// Bytes and errors of a model table at several sizes.
#include "host/bake/bake.hpp"

namespace pliant::host::bake {

struct SizeRow {
  int size = 0, bits = 0;
  std::size_t identities = 0, expressions = 0;
  std::size_t table_bytes = 0;
  Reconstruction errors;
};

/// One row for each size with 16 bits a sample, then one for each size with 8 bits. `options.size` and `.bits` are ignored.
/// Corrective shapes beyond those that a table holds are left out, as `bake` does it.
/// \param source  of any size
std::vector<SizeRow> compare_sizes(Source source, const BakeOptions& options, const std::vector<int>& sizes);

/// The largest of the usual sizes whose table with 8 bits a sample takes at most `most_bytes`; a row of size 0 if none does.
SizeRow finest_within(Source source, const BakeOptions& options, std::size_t most_bytes);

}  // namespace pliant::host::bake
