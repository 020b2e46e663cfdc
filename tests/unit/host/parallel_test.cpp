// Work on several threads.
#include "host/learn/parallel.hpp"

#include <doctest/doctest.h>

#include <atomic>
#include <stdexcept>
#include <vector>

namespace parallel_test {

using namespace pliant::host::learn;

TEST_CASE("each piece of work is done once") {
  for (const int threads : {1, 2, 5}) {
    std::vector<std::atomic<int>> done(100);
    run_parallel(threads, done.size(), [&](std::size_t k, std::size_t thread) {
      done[k] += thread < static_cast<std::size_t>(threads) ? 1 : 100;
    });
    for (const auto& times : done) CHECK(times == 1);
  }
  run_parallel(3, 0, [](std::size_t, std::size_t) { throw std::logic_error("no work"); });
}

TEST_CASE("an exception on any thread reaches the caller, and the others stop") {
  for (const int threads : {1, 4}) {
    std::atomic<int> done{0};
    const auto work = [&](std::size_t k, std::size_t) {
      if (k == 5) throw std::runtime_error("five");
      ++done;
    };
    CHECK_THROWS_WITH_AS(run_parallel(threads, 1000000, work), "five", std::runtime_error);
    CHECK(done < 999999);
    // Thrown by each of the threads.
    CHECK_THROWS_AS(run_parallel(threads, 8, [](std::size_t, std::size_t) { throw std::bad_alloc(); }),
                    std::bad_alloc);
  }
}

}  // namespace parallel_test
