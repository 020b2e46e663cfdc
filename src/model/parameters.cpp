#include "model/parameters.hpp"

namespace pliant {

std::size_t count_of(Group group, const Model& model) {
  std::size_t count = 0;
  for (const Parameter& p : model.parameters()) count += p.group == group;
  return count;
}

}  // namespace pliant
