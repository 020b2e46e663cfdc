#pragma once
// The best items of different kinds.
#include <cstddef>

#include "pliant/arena.hpp"

namespace pliant {

/// Puts an item into a list that has the best first, each of another kind: one of the same kind that is as good keeps it out,
/// a worse one leaves for it. \param count  items in the list, at most list.count. Cost: one pass over the list.
template <class Item, class IsBetter, class IsSame>
void insert_distinct(Span<Item> list, std::size_t* count, const Item& item, IsBetter is_better,
                     IsSame is_same) {
  std::size_t at = *count;
  while (at > 0 && is_better(item, list[at - 1])) --at;
  for (std::size_t i = 0; i < at; ++i)
    if (is_same(list[i], item)) return;
  if (at == list.count) return;
  std::size_t last = at;  // what leaves: the first of the same kind, else the worst if there is no room
  while (last < *count && !is_same(list[last], item)) ++last;
  if (last == *count) *count < list.count ? ++*count : --last;
  for (std::size_t i = last; i > at; --i) list[i] = list[i - 1];
  list[at] = item;
}

}  // namespace pliant
