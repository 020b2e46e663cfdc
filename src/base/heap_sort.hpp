#pragma once
// Sorting in place, without recursion or dynamic memory.
#include <cstddef>

namespace pliant {

/// Sorts a[0 ... count - 1] ascending by `less`, a strict weak order. Not stable. O(count log count).
template <class T, class Less>
void heap_sort(T* a, std::size_t count, Less less) {
  const auto sift = [a, less](std::size_t hole, std::size_t end) {
    const T value = a[hole];
    for (std::size_t child = 2 * hole + 1; child < end; child = 2 * hole + 1) {
      if (child + 1 < end && less(a[child], a[child + 1])) ++child;
      if (!less(value, a[child])) break;
      a[hole] = a[child];
      hole = child;
    }
    a[hole] = value;
  };
  for (std::size_t i = count / 2; i-- > 0;) sift(i, count);
  for (std::size_t end = count; end > 1;) {
    --end;
    const T last = a[end];
    a[end] = a[0];
    a[0] = last;
    sift(0, end);
  }
}

}  // namespace pliant
