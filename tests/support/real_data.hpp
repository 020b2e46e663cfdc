#pragma once
// Real data, which the repository does not hold: a test that needs them reads them from the folder in PLIANT_DATA.
//
//   TEST_CASE("...") {
//     const char* data = require_data();
//     if (data == nullptr) return;  // the case is counted as skipped
//
// A program whose cases are all skipped so ends with kSkipped, which ctest shows as "Skipped" (support/main.cpp).
#include <doctest/doctest.h>

#include <cstdlib>

/// The exit code that ctest takes for a skipped test (SKIP_RETURN_CODE in tests/CMakeLists.txt).
constexpr int kSkipped = 77;

/// Cases that ended for want of data. Call `require_data` once a case: each failed call counts.
inline int cases_without_data = 0;

/// The folder of real data, or null where PLIANT_DATA names none: then the case must end.
inline const char* require_data() {
  const char* folder = std::getenv("PLIANT_DATA");
  if (folder != nullptr && *folder != 0) return folder;
  MESSAGE("skipped: PLIANT_DATA is not set");
  ++cases_without_data;
  return nullptr;
}
