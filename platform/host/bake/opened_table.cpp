#include "host/bake/opened_table.hpp"

namespace pliant::host::bake {

OpenedTable::OpenedTable(const std::vector<std::uint8_t>& table)
    : table_(table), status_(Model::open(table_.data(), table_.size(), &model_)) {}

}  // namespace pliant::host::bake
