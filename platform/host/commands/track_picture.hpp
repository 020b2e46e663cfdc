#pragma once
/// \file track_picture.hpp
/// A frame of a track, on which mesh, points and state are drawn when someone asks for it.
#include <optional>
#include <string>
#include <vector>

#include "host/render/overlay.hpp"

namespace pliant::host {

struct TrackPicture {
  Image frame;
  WireMesh mesh;                                        ///< empty while the state is lost
  std::vector<std::optional<Vec2>> landmarks, markers;  ///< none while the state is lost
  std::string caption;
  TrackState state = TrackState::lost;

  /// Draws it; cost: some milliseconds a frame of 400 x 300 px.
  Image drawn() const {
    Overlay overlay(frame);
    overlay.draw_mesh(mesh);
    for (const auto& x : landmarks)
      if (x) overlay.draw_landmark(*x);
    for (const auto& x : markers)
      if (x) overlay.draw_marker(*x);
    overlay.draw_caption(caption);
    overlay.draw_state(state);
    return overlay.image();
  }
};

}  // namespace pliant::host
