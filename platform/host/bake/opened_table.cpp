#include "host/bake/opened_table.hpp"

#include <cstring>

namespace pliant::host::bake {

OpenedTable::OpenedTable(const std::vector<std::uint8_t>& table) : words_((table.size() + 3) / 4) {
  if (!table.empty()) std::memcpy(words_.data(), table.data(), table.size());
  status_ = Model::open(words_.data(), table.size(), &model_);
}

}  // namespace pliant::host::bake
