#pragma once
// The annotation of the Talking Face sequence in the folder of real data: 68 points a frame, of which 25 have an iBUG name.
#include <cstdio>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "host/io/csv.hpp"
#include "host/io/files.hpp"
#include "host/io/points_file.hpp"
#include "pliant/geometry.hpp"

struct TalkingFace {
  static constexpr int kWidth = 720, kHeight = 576;

  std::vector<std::vector<pliant::Vec2>> points;  // of a frame
  // iBUG name and number of the point, in the order of the file.
  std::vector<std::pair<std::string, std::size_t>> landmarks;

  /// Reads the first `frames` frames of the folder `franck`.
  TalkingFace(const std::string& folder, std::size_t frames) {
    using namespace pliant::host;
    const CsvTable table("points", read_file(folder + "/points_original.csv"));
    for (std::size_t row = 0; row < frames; ++row) {
      points.emplace_back();
      for (std::size_t i = 0; i < 68; ++i)
        points.back().push_back({table.number(row, 1 + 2 * i), table.number(row, 2 + 2 * i)});
    }
    std::istringstream lines(read_file(folder + "/fgnet68_to_ict.csv"));
    for (std::string line; std::getline(lines, line);) {
      unsigned point, ibug;
      if (std::sscanf(line.c_str(), "%u,%u", &point, &ibug) != 2) continue;
      char name[16];
      std::snprintf(name, sizeof name, "ibug%02u", ibug);
      landmarks.push_back({name, point});
    }
  }

  /// The landmarks of frame 0.
  std::vector<pliant::host::NamedPoint> initial_landmarks() const {
    std::vector<pliant::host::NamedPoint> out;
    for (const auto& [name, point] : landmarks) out.push_back({name, points[0][point], name});
    return out;
  }
};
