#pragma once
// ICT-FaceKit's narrow face from the folder in PLIANT_DATA, as the baker reads it from OBJ files.
#include <doctest/doctest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <string>
#include <vector>

#include "host/bake/bake.hpp"
#include "host/io/files.hpp"
#include "sanitized.hpp"
#include "scratch_folder.hpp"

/// Identities that are read, of 100. Under the sanitizers each file takes a second, and all are read and baked alike.
constexpr std::size_t kIctIdentities = kSanitized ? 40 : 100;
constexpr std::size_t kIctExpressions = 55;

/// The narrow face (no ears, neck, scalp) of ict_face.bin; README.txt beside it tells the format.
struct IctFace {
  std::string bytes;
  std::array<std::uint32_t, 8>
      n;  // vertices, quads, triangles, identities, expressions, landmarks, narrow v. and q.
  std::vector<std::string> modes;

  explicit IctFace(const std::string& folder) : bytes(pliant::host::read_file(folder + "/ict_face.bin")) {
    std::memcpy(n.data(), bytes.data() + 8, sizeof n);
    std::istringstream lines(pliant::host::read_file(folder + "/modes.txt"));
    for (std::string line; std::getline(lines, line);)
      if (!line.empty() && line[0] != '#') modes.push_back(line.substr(0, line.find_first_of(" \t")));
    REQUIRE(modes.size() == n[3] + n[4]);
  }

  template <class T>
  T at(std::size_t offset, std::size_t k) const {
    T value;
    std::memcpy(&value, bytes.data() + offset + sizeof(T) * k, sizeof(T));
    return value;
  }
  std::size_t uv() const { return 40 + 12u * n[0]; }
  std::size_t quads() const { return uv() + 8u * n[0]; }
  std::size_t landmarks() const { return quads() + 16u * n[1] + 12u * n[2]; }
  std::size_t deltas(std::size_t mode) const { return landmarks() + 4u * n[5] + 12u * n[0] * mode; }

  /// Everything of an OBJ file behind its positions: the same in each.
  std::string topology() const {
    std::string text;
    char line[96];
    for (std::size_t v = 0; v < n[6]; ++v) {
      std::snprintf(line, sizeof line, "vt %.6f %.6f\n", static_cast<double>(at<float>(uv(), 2 * v)),
                    static_cast<double>(at<float>(uv(), 2 * v + 1)));
      text += line;
    }
    for (std::size_t f = 0; f < n[7]; ++f) {
      text += "f";
      for (std::size_t k = 0; k < 4; ++k) {
        const std::string id = std::to_string(at<std::uint32_t>(quads(), 4 * f + k) + 1);
        text += " " + id + "/" + id;
      }
      text += "\n";
    }
    return text;
  }

  std::string positions(int mode) const {
    std::string text;
    char line[96];
    for (std::size_t v = 0; v < n[6]; ++v) {
      double p[3];
      for (std::size_t c = 0; c < 3; ++c)
        p[c] = static_cast<double>(at<float>(40, 3 * v + c)) +
               (mode < 0 ? 0.0
                         : static_cast<double>(at<float>(deltas(static_cast<std::size_t>(mode)), 3 * v + c)));
      std::snprintf(line, sizeof line, "v %.5f %.5f %.5f\n", p[0], p[1], p[2]);
      text += line;
    }
    return text;
  }

  void write(const Folder& folder) const {
    const std::string rest = topology();
    folder.put("neutral.obj", positions(-1) + rest);
    std::string csv = "landmark,vertex\n";
    for (std::size_t k = 0; k < n[5]; ++k) {
      char line[40];
      std::snprintf(line, sizeof line, "ibug%02zu,%u\n", k, at<std::uint32_t>(landmarks(), k));
      csv += line;
    }
    folder.put("landmarks.csv", csv);
    for (std::size_t m = 0; m < modes.size(); ++m) {
      if (m >= kIctIdentities && m < n[3]) continue;
      const std::string digits = std::to_string(m);
      const std::string identity =
          "identity" + std::string(3 - std::min<std::size_t>(3, digits.size()), '0') + digits;
      folder.put((m < n[3] ? identity : modes[m]) + ".obj", positions(static_cast<int>(m)) + rest);
    }
  }
};

inline pliant::host::bake::Source read_narrow_face(bool relaxed) {
  const Folder folder("ict_face_" +
                      std::to_string(getpid()));  // two programs read it, perhaps at the same time
  IctFace(std::string(std::getenv("PLIANT_DATA")) + "/ict").write(folder);
  pliant::host::bake::BakeOptions options;
  options.source = folder.path.string();
  options.unit_mm = 10;
  options.relaxes_chart = relaxed;
  return read_source(options);
}

/// Read from its OBJ files once, with the chart as it is or relaxed.
inline const pliant::host::bake::Source& narrow_face(bool relaxed = false) {
  static const pliant::host::bake::Source as_it_is = read_narrow_face(false);
  if (!relaxed) return as_it_is;
  static const pliant::host::bake::Source with_relaxed_chart = read_narrow_face(true);
  return with_relaxed_chart;
}
