// The camera manager, of which libcamera allows one in a process. No camera is needed.
#include <doctest/doctest.h>

#include <atomic>
#include <thread>
#include <vector>

#include "pliant/libcamera.hpp"

namespace camera_manager_test {

using namespace pliant;

TEST_CASE("several threads may list the cameras: one that has just finished does not end the process of another") {
  std::atomic<int> listed{0};
  const auto list = [&listed] {
    for (int k = 0; k < 40; ++k) {
      std::vector<CameraInfo> cameras;
      if (list_cameras(&cameras) == Status::ok) ++listed;
    }
  };
  std::vector<std::thread> threads;
  for (int k = 0; k < 4; ++k) threads.emplace_back(list);
  for (std::thread& thread : threads) thread.join();
  CHECK(listed == 4 * 40);
}

}  // namespace camera_manager_test
