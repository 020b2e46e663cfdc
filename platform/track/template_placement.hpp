#pragma once
/// \file template_placement.hpp
/// Chooses surface points for templates: corners of the image on the visible surface.
#include <cstddef>
#include <cstdint>

#include "pliant/corners.hpp"
#include "pliant/estimator.hpp"
#include "track/markers.hpp"
#include "track/template_store.hpp"
#include "vision/corner_grid.hpp"

namespace pliant {

/// Keeps nothing from call to call.
class TemplatePlacement {
 public:
  static constexpr std::size_t kAllCorners = static_cast<std::size_t>(-1);
  void lay_out(Arena& arena, const TrackerLimits& limits);
  /// Memory in which `place` works; its content is lost. At least scratch_bytes.
  void set_scratch(Span<unsigned char> scratch) { scratch_ = scratch; }
  static std::size_t scratch_bytes(const TrackerLimits& limits);

  /// Captures templates in the free slots [first, end) as far as the region shows texture: at first as far apart as the
  /// visible surface allows, then closer. Points keep apart from points found in this frame and from markers.
  /// \param tries  corners at which it tries to capture one, at most. \return at how many it did.
  std::size_t place(TemplateStore& templates, Estimator& estimator, const FrameRegion& region,
                    const Markers& markers, std::size_t first, std::size_t end,
                    std::size_t tries = kAllCorners);

 private:
  std::size_t mark_free_cells(const TemplateStore& templates, const Estimator& estimator,
                              const FrameRegion& region);
  void mark_visible_cells(const Estimator& estimator, const FrameRegion& region);
  /// What lies under the corner of a cell.
  struct Under {
    Vec2 uv;      // of the mesh
    float depth;  // of the nearest face, mm; kNoFace: none
  };
  void find_mesh_under_corners(const Estimator& estimator, const FrameRegion& region,
                               const corners::Grid& grid, Under* under) const;
  struct CellBox {
    int i0, j0, i1, j1;  // the last ones included
  };
  CellBox cells_of(const Estimator& estimator, const FrameRegion& region, FaceId face, float margin_px) const;
  void clear_cells_in_use(const TemplateStore& templates, const FrameRegion& region);
  int cell_of(Vec2 x) const {  // px of the region
    return static_cast<int>(x.y) / options_.cell_px * across_ + static_cast<int>(x.x) / options_.cell_px;
  }

  CornerOptions options_;
  int across_ = 0, down_ = 0;  // cells
  std::uint8_t* cells_ = nullptr;
  Span<Corner> corners_;
  Span<unsigned char> scratch_;
};

}  // namespace pliant
