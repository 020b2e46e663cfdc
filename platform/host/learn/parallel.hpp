#pragma once
/// \file parallel.hpp
/// Runs independent pieces of work on a few threads.
#include <cstddef>
#include <functional>

namespace pliant::host::learn {

/// Calls work(k) once for each k below `count`, from up to `threads` threads, in no particular order. The work of one k must not
/// depend on that of another. An exception of `work` ends the program.
void run_parallel(int threads, std::size_t count, const std::function<void(std::size_t)>& work);

}  // namespace pliant::host::learn
