#pragma once
/// \file animation_file.hpp
/// Writes a retargeted track to files that other programs play.
#include <functional>
#include <string>

#include "host/io/mesh_files.hpp"
#include "host/render/morph.hpp"
#include "host/render/retarget.hpp"

namespace pliant::host {

/// glTF: one mesh with a morph target for each of `morphs.targets` (names in the mesh's extras) and weights animated over
/// time_s. If the track has poses, they animate the node's translation and rotation. Axes of the scene: x right, y up, z to
/// the viewer, metres; the camera is at the origin and its view direction is -z.
/// \param picture, is_lit  as of glb_bytes.
std::string animation_glb(const MeshData& mesh, const Morphs& morphs, const Model& model,
                          const Retargeted& track, const std::string& picture, bool is_lit);

/// Writes FOLDER/frame_00000.obj and so on, in model axes and millimetres. The pose is not applied; a comment holds it.
/// \param progress  called with the number of files written.
void write_obj_frames(const std::string& folder, MeshData mesh, MorphSurface& surface,
                      const Retargeted& track, const std::function<void(std::size_t)>& progress);

}  // namespace pliant::host
