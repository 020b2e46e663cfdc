#pragma once
/// \file shown_mesh.hpp
/// A model's mesh for files that other programs read.
#include <string>

#include "host/io/mesh_files.hpp"
#include "host/render/model_mesh.hpp"

namespace pliant::host {

/// The mesh with consecutive ids; welds leave gaps.
MeshData mesh_data(const ModelMesh& adapted);

/// The same mesh with its openings filled by further vertices and faces at the fields' positions there (of a face: eyes and
/// mouth). The outer boundary stays open, and so does an opening whose vertices would be more than `most_vertices` in all.
/// \param most_vertices  at most 65535: indices have 16 bits, and glTF reserves the last one.
MeshData closed_mesh(const ModelMesh& adapted, std::size_t most_vertices = 65535);

/// Unit normals of the vertices from the faces, weighted by area; zero if all faces of a vertex are degenerate.
std::vector<Vec3> compute_normals(const std::vector<Vec3>& position,
                                  const std::vector<std::array<std::uint16_t, 3>>& faces);

/// The model's albedo as a PNG file; empty if it has none. The albedo's first and last pixels lie at u = 0 and 1; those of the PNG
/// half a pixel inside, as glTF takes them.
std::string albedo_png(const Model& model);

}  // namespace pliant::host
