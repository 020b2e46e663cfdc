#pragma once
/// \file learnt_file.hpp
/// The file of the learnt tables (`learnt.bin`), which `pliant learn` writes and `pliant bake` puts into model tables.
#include <cstdint>
#include <string>
#include <vector>

namespace pliant::host {

/// The learnt tables as bytes. Each has a format of its own, which is checked where it is used; an empty one is missing.
struct LearntTables {
  std::vector<std::uint8_t> detector;  ///< of FaceDetector
  std::vector<std::uint8_t> aligner;   ///< of FaceAligner
  std::vector<std::uint8_t> parts;     ///< of PartTable
};

/// The bytes of a learnt file (docs/model-format.md, section Learnt file).
std::string format_learnt(const LearntTables& tables);

/// Reads a learnt file. Bad input, with the name of the file: another kind of file, another version, a file that is cut
/// or longer than it says, or a wrong checksum.
LearntTables read_learnt(const std::string& path);

}  // namespace pliant::host
