#pragma once
/// \file obj_source.hpp
/// The source of a model as a folder of OBJ files with one topology.
#include <functional>
#include <string>
#include <vector>

#include "host/bake/source.hpp"

namespace pliant::host::bake {

struct ObjOptions {
  float unit_mm = 1;  ///< of the files' coordinates
  int components =
      0;  ///< more than 0: all files are registered scans, of which so many principal components are kept
  bool relaxes_chart = false;  ///< chart_relaxation.hpp: (u,v) are then no longer those of the files
  /// Called with "files" for each one read; may be empty.
  std::function<void(const char* stage, std::size_t done, std::size_t of)> progress;
};

/// Reads neutral.obj (with texture coordinates, v upwards), identity*.obj, and every other NAME.obj as an
/// expression; an ending _L or _R becomes Left or Right. With `components`, reads every file as a scan
/// instead. landmarks.csv (landmark,vertex; vertices from 0), if there, names landmarks; with those of the
/// outer eye corners (ibug36, ibug45) the origin is moved between them, and lids, lips, brows and outline
/// become curves. Throws SourceError.
Source read_obj_folder(const std::string& folder, const ObjOptions& options);

/// True where the folder holds OBJ files.
bool is_obj_folder(const std::string& folder);

}  // namespace pliant::host::bake
