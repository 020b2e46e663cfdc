#pragma once
/// \file mesh_figure.hpp
/// A figure like the paper's Figure 3: base mesh, basic blocks and refinement by three criteria, each over the chart, as a
/// surface and with its texture.
#include "host/io/image.hpp"
#include "host/render/model_mesh.hpp"

namespace pliant::host {

Image draw_mesh_figure(const Model& model, ModelSurface& surface);

}  // namespace pliant::host
