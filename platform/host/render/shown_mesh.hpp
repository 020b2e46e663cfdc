#pragma once
/// \file shown_mesh.hpp
/// A model's mesh as other programs are given it.
#include "host/io/mesh_files.hpp"
#include "host/render/model_mesh.hpp"

namespace pliant::host {

/// The mesh without the gaps that welds leave between ids.
MeshData mesh_data(const ModelMesh& adapted);

/// The same with its openings closed by further vertices and faces: a face with eyes and teeth, where the fields go on
/// there. The outline stays as it is.
MeshData closed_mesh(const ModelMesh& adapted);

/// Unit normals from the faces, weighted by area; zero for a vertex whose faces have none.
std::vector<Vec3> compute_normals(const std::vector<Vec3>& position,
                                  const std::vector<std::array<std::uint16_t, 3>>& faces);

/// The model's albedo as a PNG; empty for a model without one.
std::string albedo_png(const Model& model);

}  // namespace pliant::host
