#pragma once
/// \file parallel.hpp
/// Runs independent pieces of work on a few threads.
#include <cstddef>
#include <functional>

namespace pliant::host::learn {

/// Calls work(k, thread) once for each k below `count`, from up to `threads` threads, in no particular order; `thread` is below
/// `threads`, for memory of its own. The work of one k must not depend on that of another.
/// The first exception of `work` is thrown again when all threads have stopped; some of the work is then not done.
void run_parallel(int threads, std::size_t count,
                  const std::function<void(std::size_t k, std::size_t thread)>& work);

}  // namespace pliant::host::learn
