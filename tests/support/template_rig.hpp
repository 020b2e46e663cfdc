#pragma once
// Templates of a rendered head, with what they are captured and matched with.
#include <doctest/doctest.h>

#include <vector>

#include "face_film.hpp"
#include "model_builder.hpp"
#include "track/markers.hpp"
#include "track/template_placement.hpp"
#include "track/template_store.hpp"
#include "track/tracker_sizes.hpp"

namespace template_rig {

using namespace pliant;

/// A head that turns a little.
inline const FaceFilm& film() {
  static const FaceFilm* one = new FaceFilm(320, 240, 4, [](float s, Pose& pose, auto&) {
    pose.q = exp_rotation({0, 0.12f * s, 0});
  });
  return *one;
}

struct Rig {
  TrackerLimits limits;
  InArena<Estimator> estimator;
  InArena<FrameRegion> region;
  InArena<TemplateStore> templates;
  InArena<Markers> markers{std::size_t{1}};

  explicit Rig(std::uint16_t patches = 40, std::uint16_t region_px = 0)
      : Rig(limits_of(patches, region_px)) {}
  explicit Rig(const TrackerLimits& of)
      : limits(of),
        estimator(baked_face().model, estimator_limits(limits)),
        region(limits),
        templates(limits) {
    templates->clear();
    see(0);
    REQUIRE(estimator->start(film().camera, 320, 240, film().poses[0], film().parameters[0].data(), nullptr,
                             {}) == Status::ok);
  }
  static EstimatorLimits estimator_limits(const TrackerLimits& of) {
    EstimatorLimits l;
    l.points = static_cast<std::uint16_t>(all_points(of));
    return l;
  }
  static TrackerLimits limits_of(std::uint16_t patches, std::uint16_t region_px = 0) {
    TrackerLimits l;
    l.region_width = l.region_height = region_px;
    l.patches = patches;
    l.key_patches = 8;
    l.key_frames = 1;
    l.curve_points = 0;
    return l;
  }
  /// The region of frame k. The estimator stays at the truth of frame 0.
  void see(std::size_t k, Vec2 centre = {160, 120}) {
    region->advance();
    REQUIRE(region->build(film().view(k), centre) == Status::ok);
  }
  std::size_t place(std::size_t first, std::size_t end, std::size_t tries = TemplatePlacement::kAllCorners) {
    InArena<TemplatePlacement> placement(limits);
    std::vector<std::uint64_t> scratch(TemplatePlacement::scratch_bytes(limits) / 8 + 4);
    auto* block = reinterpret_cast<unsigned char*>(scratch.data());
    block += (16 - reinterpret_cast<std::uintptr_t>(block) % 16) % 16;
    placement->set_scratch({block, TemplatePlacement::scratch_bytes(limits)});
    return placement->place(templates.object, estimator.object, region.object, markers.object, first, end,
                            tries);
  }
  std::size_t used(std::size_t first, std::size_t end) const {
    std::size_t n = 0;
    for (std::size_t k = first; k < end; ++k) n += templates.object[k].is_used;
    return n;
  }
};

}  // namespace template_rig
