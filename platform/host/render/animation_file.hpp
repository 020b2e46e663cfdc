#pragma once
/// \file animation_file.hpp
/// A retargeted track as files that other programs play.
#include <functional>
#include <string>

#include "host/io/mesh_files.hpp"
#include "host/render/morph.hpp"
#include "host/render/retarget.hpp"

namespace pliant::host {

/// glTF: one mesh with a morph target a row of `morphs.targets` (named in the mesh's extras), its weights animated
/// over time_s, and the head as its node's translation and rotation where the track has one. The scene's axes are the
/// camera's with y up: x right, z towards the viewer, metres, so that the camera stands in the origin and looks along -z.
/// \param picture, is_lit  as of glb_bytes.
std::string animation_glb(const MeshData& mesh, const Morphs& morphs, const Model& model,
                          const Retargeted& track, const std::string& picture, bool is_lit);

/// FOLDER/frame_00000.obj and so on, in model axes and millimetres, without the head's motion, which stands in a
/// comment. \param progress  called with the number of files written.
void write_obj_frames(const std::string& folder, MeshData mesh, MorphSurface& surface,
                      const Retargeted& track, const std::function<void(std::size_t)>& progress);

}  // namespace pliant::host
