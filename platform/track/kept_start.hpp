#pragma once
/// \file kept_start.hpp
/// The options of a tracker's last start, for the starts that it makes by itself.
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/tracker.hpp"

namespace pliant {

/// Copies of the caller's options, with what they point to.
struct KeptStart {
  StartOptions start;      // what is known of the camera
  TrackerOptions options;  // of the last start

  void lay_out(Arena& arena, const Model& model);
  void keep(const StartOptions& from);
  void keep(const TrackerOptions& from);

 private:
  Camera camera_;               // the one that `start` names
  Span<std::uint8_t> is_free_;  // TrackerOptions::is_free
};

}  // namespace pliant
