#pragma once
/// \file obj_source.hpp
/// Reads a source from an OBJ file, or from a folder of OBJ files with one topology.
#include <functional>
#include <string>

#include "host/bake/source.hpp"

namespace pliant::host::bake {

struct ObjOptions {
  float unit_mm = 1;  ///< unit of the files' coordinates, millimetres
  int components =
      0;  ///< if positive, all files are registered scans, and this many principal components are kept
  bool relaxes_chart =
      false;      ///< evens out the chart (chart_relaxation.hpp); (u,v) are then not those of the files
  int modes = 0;  ///< number of bending modes to add (bending_modes.hpp), as expressions mode00, mode01, ...
  float stiffness = 1;  ///< of the bending modes
  /// Picture of the surface's albedo over the files' u,v, or `none`. Empty: the pictures (map_Kd) of the file's materials.
  std::string texture;
  int most_texture_side = 512;  ///< pixels on a side of the albedo, at most
  /// Called with "files" after each file; may be empty.
  std::function<void(const char* stage, std::size_t done, std::size_t of)> progress;
};

/// Reads a folder: neutral.obj (with texture coordinates, v upwards), identity*.obj as identities, and every other NAME.obj as
/// an expression. A suffix _L or _R of a name becomes Left or Right. With `components`, every file is a scan instead. Or reads
/// one OBJ file, which is a surface without parameters. The only OBJ file of a folder is the rest shape, whatever its name.
/// With `modes`, the vertices of faces in an OBJ group "fixed" do not move by them.
/// parameters.txt (columns parameter, group, minimum, maximum, sd; text_table.hpp) is optional and changes parameters.
/// landmarks.csv (columns landmark,vertex; vertices from 0) is optional. If it names the outer eye corners (ibug36, ibug45),
/// the origin is moved midway between them. If it names iBUG landmarks of lids, lips, brows or the jaw, they become curves.
/// Throws SourceError, also for a mesh that is no surface over a chart (surface_check.hpp), for one of more than 250,000
/// vertices, and for a vertex of a face that is more than 100 m from the origin.
Source read_obj_source(const std::string& source, const ObjOptions& options);

/// True for the name of an OBJ file, and for a folder that holds some.
bool is_obj_source(const std::string& source);

}  // namespace pliant::host::bake
