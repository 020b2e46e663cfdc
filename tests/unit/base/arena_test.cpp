#include "pliant/arena.hpp"

#include <doctest/doctest.h>

#include <initializer_list>

namespace arena_test {

using namespace pliant;

namespace {
struct Thing {
  int* numbers = nullptr;
  double* more = nullptr;
  void lay_out(Arena& arena, int count) {
    numbers = arena.take<int>(static_cast<std::size_t>(count));
    more = arena.take<double>(3);
  }
};
constexpr std::size_t measured() {
  Arena arena;
  arena.take<int>(5);
  arena.take<char>(1);
  return arena.used_bytes();
}
}  // namespace

static_assert(measured() == 48, "measuring works at compile time");

TEST_CASE("an arena that only measures gives null and counts what a real one takes") {
  alignas(Arena::kAlignment) unsigned char block[256];
  Arena measuring, real(block, sizeof block);
  for (std::size_t n : {1u, 7u, 16u, 3u}) {
    CHECK(measuring.take<short>(n) == nullptr);
    CHECK(real.take<short>(n) != nullptr);
    CHECK(measuring.used_bytes() == real.used_bytes());
  }
}

TEST_CASE("everything taken is aligned and disjoint") {
  alignas(Arena::kAlignment) unsigned char block[256];
  Arena arena(block, sizeof block);
  char* a = arena.take<char>(3);
  double* b = arena.take<double>(2);
  CHECK(reinterpret_cast<std::uintptr_t>(b) % Arena::kAlignment == 0);
  CHECK(reinterpret_cast<char*>(b) >= a + 3);
}

TEST_CASE("every smaller block fails cleanly, the measured one succeeds") {
  const std::size_t need = measured_bytes<Thing>(10);
  alignas(Arena::kAlignment) unsigned char block[256];
  REQUIRE(need <= sizeof block);
  for (std::size_t bytes = 0; bytes <= need; ++bytes) {
    Arena arena(block, bytes);
    Thing thing;
    const Status status = create_in(arena, thing, 10);
    if (bytes < need) {
      CHECK(status == Status::out_of_memory);
      CHECK(thing.numbers == nullptr);
      CHECK(arena.used_bytes() == 0);
    } else {
      CHECK(status == Status::ok);
      CHECK(arena.used_bytes() == need);
    }
  }
}

TEST_CASE("more than the address space has does not fit, and is not measured as little") {
  alignas(Arena::kAlignment) unsigned char block[256];
  for (const std::size_t count :
       {SIZE_MAX / 8, SIZE_MAX / 8 + 1, SIZE_MAX / 8 + 2, SIZE_MAX / 4 + 2, SIZE_MAX - 3, SIZE_MAX}) {
    CAPTURE(count);
    Arena arena(block, sizeof block), measuring;
    CHECK(arena.take<double>(count) == nullptr);
    CHECK(arena.exhausted());
    CHECK(measuring.take<double>(count) == nullptr);
    CHECK(measuring.used_bytes() >= SIZE_MAX - Arena::kAlignment);
  }
  Arena sum;
  for (int k = 0; k < 3; ++k) (void)sum.take<char>(SIZE_MAX / 2);
  CHECK(sum.used_bytes() >= SIZE_MAX - Arena::kAlignment);
}

TEST_CASE("a block that is not aligned is refused and nothing changes") {
  alignas(Arena::kAlignment) unsigned char block[256];
  for (std::size_t off = 1; off < Arena::kAlignment; ++off) {
    Arena arena(block + off, sizeof block - off);
    Thing thing;
    CHECK(create_in(arena, thing, 10) == Status::misaligned);
    CHECK(thing.numbers == nullptr);
    CHECK(arena.used_bytes() == 0);
  }
}

TEST_CASE("a scope gives back what was taken inside it, and the high-water mark remembers") {
  alignas(Arena::kAlignment) unsigned char block[256];
  Arena arena(block, sizeof block);
  arena.take<char>(16);
  {
    Arena::Scope scope(arena);
    arena.take<char>(100);
    CHECK(arena.take<char>(1000) == nullptr);
    CHECK(arena.exhausted());
  }
  CHECK(arena.used_bytes() == 16);
  CHECK_FALSE(arena.exhausted());
  CHECK(arena.high_water_bytes() == 128);
}

}  // namespace arena_test
