#pragma once
/// \file size_table.hpp
/// What a table costs and how true it is at several sizes.
#include "host/bake/bake.hpp"

namespace pliant::host::bake {

struct SizeRow {
  int size = 0, bits = 0;
  std::size_t identities = 0, expressions = 0;
  std::size_t table_bytes = 0;
  Reconstruction errors;
};

/// One row for each size with 16 bits a sample, then for each with 8. Of `options` size and bits do not count.
std::vector<SizeRow> compare_sizes(const Source& source, const BakeOptions& options,
                                   const std::vector<int>& sizes);

/// The finest table of these parameters, 8 bits a sample, that takes at most `most_bytes`; size 0 where none does.
SizeRow finest_within(const Source& source, const BakeOptions& options, std::size_t most_bytes);

}  // namespace pliant::host::bake
