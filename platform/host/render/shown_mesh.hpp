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
/// mouth). The outer boundary stays open.
MeshData closed_mesh(const ModelMesh& adapted);

/// Unit normals of the vertices from the faces, weighted by area; zero if all faces of a vertex are degenerate.
std::vector<Vec3> compute_normals(const std::vector<Vec3>& position,
                                  const std::vector<std::array<std::uint16_t, 3>>& faces);

/// The model's albedo as a PNG file; empty if it has none.
std::string albedo_png(const Model& model);

}  // namespace pliant::host
