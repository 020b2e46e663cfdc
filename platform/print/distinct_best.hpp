#pragma once
// The best items of different kinds.
#include <cstddef>

#include "pliant/arena.hpp"

namespace pliant {

/// Puts an item into a list that has the best first, each of another kind: one of the same kind that is as good keeps it out,
/// worse ones leave for it. Kinds may overlap. \param count  items in the list, at most list.count. Cost: one pass over the list.
template <class Item, class IsBetter, class IsSame>
void insert_distinct(Span<Item> list, std::size_t* count, const Item& item, IsBetter is_better,
                     IsSame is_same) {
  std::size_t at = *count;
  while (at > 0 && is_better(item, list[at - 1])) --at;
  for (std::size_t i = 0; i < at; ++i)
    if (is_same(list[i], item)) return;
  if (at == list.count) return;
  std::size_t end = at;
  for (std::size_t i = at; i < *count; ++i)
    if (!is_same(list[i], item)) list[end++] = list[i];
  if (end == list.count) --end;  // no room: the worst leaves
  for (std::size_t i = end; i > at; --i) list[i] = list[i - 1];
  list[at] = item;
  *count = end + 1;
}

}  // namespace pliant
