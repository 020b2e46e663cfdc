// The best items of different kinds, against sorting all of them.
#include "print/distinct_best.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <random>
#include <vector>

namespace distinct_best_test {

using namespace pliant;

namespace {

struct Item {
  int kind, value;
};

std::vector<Item> best_by_insertion(const std::vector<Item>& items, std::size_t room) {
  std::vector<Item> list(room + 1, Item{-1, -1});
  std::size_t count = 0;
  for (const Item& item : items)
    insert_distinct(
        Span<Item>{list.data(), room}, &count, item,
        [](const Item& a, const Item& b) { return a.value > b.value; },
        [](const Item& a, const Item& b) { return a.kind == b.kind; });
  REQUIRE(count <= room);
  CHECK(list[room].kind == -1);
  list.resize(count);
  return list;
}

std::vector<Item> best_by_sorting(const std::vector<Item>& items, std::size_t room) {
  std::map<int, int> best;
  for (const Item& item : items)
    best[item.kind] = std::max(item.value, best.count(item.kind) > 0 ? best[item.kind] : 0);
  std::vector<Item> sorted;
  for (const auto& [kind, value] : best) sorted.push_back({kind, value});
  std::sort(sorted.begin(), sorted.end(), [](const Item& a, const Item& b) { return a.value > b.value; });
  if (sorted.size() > room) sorted.resize(room);
  return sorted;
}

}  // namespace

TEST_CASE("the list holds the best item of each of the best kinds, in order") {
  std::mt19937 random(1);
  for (int trial = 0; trial < 300; ++trial) {
    const std::size_t room = random() % 5;
    std::vector<Item> items(random() % 12);
    std::vector<int> values(items.size());
    for (std::size_t i = 0; i < items.size(); ++i) values[i] = static_cast<int>(i);  // no two are alike
    std::shuffle(values.begin(), values.end(), random);
    for (std::size_t i = 0; i < items.size(); ++i) items[i] = {static_cast<int>(random() % 6), values[i]};
    const std::vector<Item> found = best_by_insertion(items, room), right = best_by_sorting(items, room);
    REQUIRE(found.size() == right.size());
    for (std::size_t i = 0; i < found.size(); ++i) CHECK(found[i].value == right[i].value);
  }
}

TEST_CASE("of items that are equally good the first one stays") {
  const std::vector<Item> found = best_by_insertion({{1, 5}, {2, 5}, {1, 5}, {3, 5}}, 2);
  REQUIRE(found.size() == 2);
  CHECK(found[0].kind == 1);
  CHECK(found[1].kind == 2);
}

TEST_CASE("an item like two that are not like each other takes the place of both, or of neither") {
  // Those that are at most 2 apart are alike. 12 is the best, then the smallest.
  const auto list_of = [](const std::vector<int>& values) {
    std::vector<Item> list(3);
    std::size_t count = 0;
    for (const int place : values)
      insert_distinct(
          Span<Item>{list.data(), list.size()}, &count, Item{place, place == 12 ? 0 : place},
          [](const Item& a, const Item& b) { return a.value < b.value; },
          [](const Item& a, const Item& b) { return std::abs(a.kind - b.kind) <= 2; });
    std::vector<int> places;
    for (std::size_t k = 0; k < count; ++k) places.push_back(list[k].kind);
    return places;
  };
  CHECK(list_of({10, 14, 12}) == std::vector<int>{12});
  CHECK(list_of({10, 14, 30, 12}) == std::vector<int>{12, 30});
  CHECK(list_of({12, 10, 14}) == std::vector<int>{12});
}

}  // namespace distinct_best_test
