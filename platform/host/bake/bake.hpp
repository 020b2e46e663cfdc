#pragma once
/// \file bake.hpp
/// Makes a model table (`.plm`) from a readable source on a host.
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "host/bake/parameter_choice.hpp"
#include "host/bake/reconstruction.hpp"
#include "host/bake/source.hpp"

namespace pliant::host::bake {

struct BakeOptions {
  std::string source;  ///< the folder of the source
  int size =
      128;  ///< samples a side of a field over the whole chart, 16 to 512; the rest shape has twice that
  int bits = 16;               ///< a sample: 16 or 8; the rest shape always has 16
  float unit_mm = 1;           ///< of OBJ files
  bool relaxes_chart = false;  ///< of OBJ files (chart_relaxation.hpp)
  int components = 0;  ///< above 0: the OBJ files are scans, of which so many principal components are kept
  ParameterChoice choice;  ///< of what the source has
  /// Called for each OBJ file read and each shape baked, with which of the two it is; may be empty.
  std::function<void(const char* stage, std::size_t done, std::size_t of)> progress;
  int base_vertices = 480;     ///< of the base mesh, about; 60 to 5000
  float tolerance_mm = 0.05f;  ///< fields are sampled more coarsely where that costs no more than this
};

struct BakeReport {
  Reconstruction errors;
  std::vector<std::string> unmatched;  ///< expressions that bear none of ARKit's names
  std::size_t field_count = 0, base_vertices = 0, table_bytes = 0;
};

/// Bakes a folder with the tables of a face (points.txt and others), or with OBJ files (obj_source.hpp).
/// False, with one line that names the file and line, when anything is wrong with them; `table` is untouched
/// then. `report` may be null.
bool bake(const BakeOptions& options, std::vector<std::uint8_t>& table, std::string& error,
          BakeReport* report = nullptr);

/// Reads what `options.source` holds and keeps the parameters chosen. Throws SourceError.
Source read_source(const BakeOptions& options);

/// Bakes a source that is in memory, and opens the table to check it. A source without a base mesh gets one. Throws
/// SourceError when the surface's boundary intersects itself in the chart, so that there is no base mesh, or when the
/// table cannot be opened (two parameters with one name, more of something than a table may hold).
std::vector<std::uint8_t> bake_source(const Source& source, const BakeOptions& options,
                                      BakeReport* report = nullptr);

/// The table as a C++ source file: a 4-byte aligned constant array `name` and its size `name`_bytes.
std::string embedded(const std::vector<std::uint8_t>& table, const std::string& name);

}  // namespace pliant::host::bake
