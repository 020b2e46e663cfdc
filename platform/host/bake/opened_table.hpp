#pragma once
/// \file opened_table.hpp
/// A model table that owns its memory.
#include <cstdint>
#include <vector>

#include "host/io/aligned_table.hpp"
#include "pliant/model.hpp"

namespace pliant::host::bake {

/// Copies a table into aligned memory and opens it. Its model is valid as long as this object lives.
class OpenedTable {
 public:
  explicit OpenedTable(const std::vector<std::uint8_t>& table);
  OpenedTable(const OpenedTable&) = delete;
  OpenedTable& operator=(const OpenedTable&) = delete;

  /// What Model::open returned.
  Status status() const { return status_; }
  /// Empty unless the status is ok.
  const Model& model() const { return model_; }

 private:
  AlignedTable table_;
  Model model_;
  Status status_;
};

}  // namespace pliant::host::bake
