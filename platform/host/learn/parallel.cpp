#include "host/learn/parallel.hpp"

#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace pliant::host::learn {

void run_parallel(int threads, std::size_t count,
                  const std::function<void(std::size_t, std::size_t)>& work) {
  std::atomic<std::size_t> next{0};
  std::exception_ptr failure;
  std::mutex failing;
  const auto run = [&](std::size_t thread) {
    try {
      for (std::size_t k = next++; k < count; k = next++) work(k, thread);
    } catch (...) {
      const std::lock_guard<std::mutex> lock(failing);
      if (failure == nullptr) failure = std::current_exception();
      next = count;  // the others stop
    }
  };
  std::vector<std::thread> others;
  try {
    for (int k = 1; k < threads; ++k) others.emplace_back(run, static_cast<std::size_t>(k));
  } catch (const std::system_error&) {  // no more threads are to be had: those that there are do the work
  }
  run(0);
  for (std::thread& t : others) t.join();
  if (failure != nullptr) std::rethrow_exception(failure);
}

}  // namespace pliant::host::learn
