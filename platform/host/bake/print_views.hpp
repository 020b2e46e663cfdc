#pragma once
/// \file print_views.hpp
/// The directions from which a surface's print is learnt, and its picture from one of them.
#include <vector>

#include "host/io/image.hpp"
#include "host/render/surface_sheet.hpp"

namespace pliant::host::bake {

/// Rotations (View::q) that show the surface from all its sides, the largest first, and where it has few sides also tilted.
std::vector<Quat> choose_print_views(const SurfaceSheet& sheet);

/// An orthographic picture of a surface.
struct PrintPicture {
  Image grey;            ///< medium grey where there is no surface
  std::vector<Vec2> uv;  ///< of the surface in each pixel; negative where there is none
};

/// \param px_per_mm  scale. Details smaller than a pixel are averaged.
PrintPicture draw_print(const SurfaceSheet& sheet, const ChartTexture& texture, Quat view, float px_per_mm,
                        float albedo_px_per_mm);

}  // namespace pliant::host::bake
