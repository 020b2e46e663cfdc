#include "host/learn/parallel.hpp"

#include <atomic>
#include <thread>
#include <vector>

namespace pliant::host::learn {

void run_parallel(int threads, std::size_t count,
                  const std::function<void(std::size_t, std::size_t)>& work) {
  std::atomic<std::size_t> next{0};
  const auto run = [&](std::size_t thread) {
    for (std::size_t k = next++; k < count; k = next++) work(k, thread);
  };
  std::vector<std::thread> others;
  for (int k = 1; k < threads; ++k) others.emplace_back(run, static_cast<std::size_t>(k));
  run(0);
  for (std::thread& t : others) t.join();
}

}  // namespace pliant::host::learn
