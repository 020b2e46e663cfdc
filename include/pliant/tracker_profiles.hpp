#pragma once
/// \file tracker_profiles.hpp
/// Limits of a Tracker for three sizes of devices, and limits without one of its parts.
#include "pliant/tracker_limits.hpp"

namespace pliant {

/// The same limits with another detection, such as kFaceDetection.
constexpr TrackerLimits with_detection(TrackerLimits limits, const Detection& detection) {
  limits.detection = &detection;
  return limits;
}

/// The same limits without detection, and so without second looks.
constexpr TrackerLimits without_detection(TrackerLimits limits) {
  limits.detection = nullptr;
  limits.second_look = nullptr;
  return limits;
}

/// The same limits without estimation of the person.
constexpr TrackerLimits without_person(TrackerLimits limits) {
  limits.person = nullptr;
  return limits;
}

/// The same limits without second looks.
constexpr TrackerLimits without_second_look(TrackerLimits limits) {
  limits.second_look = nullptr;
  return limits;
}

/// The same limits without smoothing of noisy frames.
constexpr TrackerLimits without_noise_smoothing(TrackerLimits limits) {
  limits.noise = nullptr;
  return limits;
}

/// The same limits without edges.
constexpr TrackerLimits without_edges(TrackerLimits limits) {
  limits.edges = nullptr;
  return limits;
}

/// Profile M, the default: 320 x 240, 128 + 64 templates, edges, 512 vertices.
constexpr TrackerLimits profile_m() {
  return {};
}

/// Profile S, for a microcontroller: 320 x 240 frames, matched in a moving region of 192 x 192 that is read
/// from the caller's frame during `update`; 48 + 16 templates; no edges, no rejection of image forces, no
/// springs, no estimation of the person, no second looks, no smoothing of noisy frames; only upright faces are found. With the
/// built-in face and its expressions free the block, the object and the stack fit into 256 KiB.
constexpr TrackerLimits profile_s() {
  TrackerLimits l;
  l.region_width = l.region_height = 192;
  l.patches = 48;
  l.key_patches = 16;
  l.key_frames = 2;
  l.patch_margin = 2;
  l.keeps_previous = l.copies_frame = l.keeps_templates = false;
  l.thumbnail_width = 48;
  l.search_work = 4000;
  l.detection = &kUprightDetection;
  l.free_parameters = 40;
  l.samples_per_point = 44;
  l.samples_vertices = false;
  return without_noise_smoothing(without_second_look(without_person(
      without_edges(without_stretch(without_rejection(without_personal_field(without_mesh_following(l))))))));
}

/// Profile L, for a desktop or a fast board: 640 x 480, 220 + 80 templates, edges, 2,048 vertices.
constexpr TrackerLimits profile_l() {
  TrackerLimits l;
  l.width = 640;
  l.height = 480;
  l.patches = 220;
  l.key_patches = 80;
  l.vertices = 2048;
  return l;
}

}  // namespace pliant
