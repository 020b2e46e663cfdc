#pragma once
/// \file track_picture.hpp
/// A frame of a track, on which mesh, points and state are drawn when someone asks for it.
#include <optional>
#include <string>
#include <vector>

#include "host/render/overlay.hpp"

namespace pliant::host {

/// What is drawn on a frame, px of it. Empty while the state is lost.
struct TrackMarks {
  WireMesh mesh;
  std::vector<std::optional<Vec2>> landmarks, markers;
};

struct TrackPicture {
  Image frame;
  TrackMarks marks;
  std::string caption;
  TrackState state = TrackState::lost;

  /// Draws it; cost: some milliseconds a frame of 400 x 300 px.
  Image drawn() const {
    Overlay overlay(frame);
    overlay.draw_mesh(marks.mesh);
    for (const auto& x : marks.landmarks)
      if (x) overlay.draw_landmark(*x);
    for (const auto& x : marks.markers)
      if (x) overlay.draw_marker(*x);
    overlay.draw_caption(caption);
    overlay.draw_state(state);
    return overlay.image();
  }
};

}  // namespace pliant::host
