#pragma once
/// \file error_plot.hpp
/// Error over time of several trackers as an SVG picture.
#include <cstdint>
#include <string>
#include <vector>

namespace pliant::figure9 {

struct Curve {
  std::string name;
  std::vector<double> error;  ///< px, a frame
};

/// Curves are smoothed over a second; frames in which something passes before the face are shaded.
std::string error_plot(const std::string& title, const std::vector<Curve>& curves,
                       const std::vector<std::uint8_t>& is_hidden, double frames_per_second);

}  // namespace pliant::figure9
