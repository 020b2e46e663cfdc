#pragma once
/// \file bake.hpp
/// Makes a model table (`.plm`) from readable files.
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "host/bake/parameter_choice.hpp"
#include "host/bake/reconstruction.hpp"
#include "host/bake/source.hpp"

namespace pliant::host::bake {

/// Standard deviation of lengths on a surface with bending modes, a fraction. Chosen on the film of tests/bench/sheet_film.py with
/// motion A.
constexpr float kBendingStretch = 0.03f;
/// Smallest standard deviation of the springs' lengths, as a fraction.
constexpr float kLeastStretch = 1e-4f;

/// Range of the unit of OBJ files, mm: a nanometre to a kilometre. What a unit makes of a surface is checked with the surface.
constexpr float kLeastUnitMm = 1e-6f, kMostUnitMm = 1e6f;

struct BakeOptions {
  std::string source;  ///< folder of the source; errors name it
  int size =
      128;  ///< samples on each side of a field over the whole chart, 16 to 512; the rest shape has twice that
  int bits = 16;               ///< bits of a sample: 16 or 8; the rest shape always has 16
  float unit_mm = 1;           ///< of the OBJ files, kLeastUnitMm to kMostUnitMm
  bool relaxes_chart = false;  ///< moves the (u,v) of OBJ files (chart_relaxation.hpp)
  int components = 0;   ///< if positive, the OBJ files are scans, and this many principal components are kept
  int modes = 0;        ///< bending modes that are added to an OBJ source (bending_modes.hpp), 0 to 64
  float stiffness = 1;  ///< of the bending modes, 1e-4 to 1e4
  /// Standard deviation of the lengths of springs over the surface, a fraction, 1e-4 to 1; 0: no springs. Negative: as
  /// kBendingStretch where there are bending modes, and no springs elsewhere.
  float stretch = -1;
  /// Picture of the albedo of an OBJ source over its u,v, or `none`. Empty: the pictures of the materials, if there are some. The
  /// albedo has at most four pixels a sample of `size`.
  std::string texture;
  ParameterChoice choice;  ///< which of the source's parameters are kept
  /// File of learnt tables (docs/model-format.md, section Learnt file), or `none`. Empty: `learnt.bin` of the source's
  /// folder, if there is one.
  std::string learnt;
  /// Called after each OBJ file ("files") and each baked shape ("shapes"); may be empty.
  std::function<void(const char* stage, std::size_t done, std::size_t of)> progress;
  int base_vertices = 480;  ///< approximate number of vertices of the base mesh, 60 to 5000
  /// A field gets the coarsest grid whose error at the vertices is at most this, on a surface 100 to 1000 mm across; on others
  /// in proportion, by powers of ten.
  float tolerance_mm = 0.05f;
};

struct BakeReport {
  Reconstruction errors;
  std::vector<std::string> unmatched;  ///< a face's expressions whose names ARKit does not have
  std::size_t field_count = 0, base_vertices = 0, table_bytes = 0;
  bool has_texture = false;     ///< of an OBJ source
  std::size_t print_bytes = 0;  ///< 0: the surface cannot be found by its texture
  /// Why the surface will probably not be tracked, and what to do; that its chart was mirrored; landmarks whose names are nearly
  /// those that the library asks for. One line each.
  std::vector<std::string> warnings;
};

/// Bakes a folder with the tables of a surface (cage_source.hpp) or with OBJ files (obj_source.hpp). On any defect returns
/// false, sets `error` to one line that names the file and what is wrong, and leaves `table` unchanged. `report` may be
/// null.
bool bake(const BakeOptions& options, std::vector<std::uint8_t>& table, std::string& error,
          BakeReport* report = nullptr);

/// Reads the folder `options.source` and keeps the chosen parameters. Throws SourceError.
Source read_source(const BakeOptions& options);

/// Pixels on a side of the albedo of an OBJ source, count, at most.
constexpr int most_texture_side(int size) {
  return 4 * size;
}

/// Bakes a source that is in memory, and opens the table to check it. A source without a base mesh gets one. Throws
/// SourceError when no base mesh of at most 9000 vertices follows the surface's boundary, when the source's own has triangles whose
/// corners do not run counter-clockwise seen from outside, when the table cannot be opened (two
/// parameters with one name, more of something than a table may hold), or when its rest shape is no copy of the surface.
std::vector<std::uint8_t> bake_source(const Source& source, const BakeOptions& options,
                                      BakeReport* report = nullptr);

}  // namespace pliant::host::bake
