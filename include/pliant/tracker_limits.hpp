#pragma once
/// \file tracker_limits.hpp
/// Capacities of a Tracker, which fix its memory. tracker_profiles.hpp has the profiles.
#include <cstdint>

#include "pliant/estimator.hpp"
#include "pliant/field.hpp"
#include "pliant/status.hpp"

namespace pliant {

struct Detection;
/// Starts that a tracker makes by itself, by name, so that programs that do not use them do not link them.
/// This one: detection, alignment and verification of faces from learnt tables. Faces are found that are turned in the picture by
/// up to about 30 degrees, and with a Camera::aspect of 0.67 to 1.5: the frame is searched as if its pixels were square. With an
/// aspect of 2 or 0.5 a quarter or more of the faces is not found. 34 kB of code on a Cortex-M7.
extern const Detection kUprightFaceDetection;
/// The same of faces at any roll, and with any Camera::aspect: a third of the searches is of the turned frame. A face that is
/// turned by an odd number of eighths of a turn must be 1.4 times as large as an upright one. A search takes width x height bytes
/// more, which are the track's afterwards: of 320 x 240 no profile's block grows. 36 kB of code on a Cortex-M7.
extern const Detection kFaceDetection;
/// The search for a printed surface and its verification, from the keypoints of its albedo. 35 kB of code on a Cortex-M7.
extern const Detection kPrintDetection;
/// Whichever the model has tables for: upright faces, or a print. 71 kB of code on a Cortex-M7.
extern const Detection kUprightDetection;
/// The same with faces at any roll. 73 kB.
extern const Detection kDetection;

struct PersonRefinement;
/// Estimation of the person's identity while the head turns, by name, for the same reason.
extern const PersonRefinement kPersonRefinement;
struct TextureNoting;
/// The texture that the image shows on the surface. A program that does not name it does not link it.
extern const TextureNoting kSurfaceTexture;

struct EdgeMatching;
/// Matching of the model's curves and silhouette, by name, for the same reason.
extern const EdgeMatching kEdgeMatching;
struct NoiseSmoothing;
/// Smoothing of frames with much noise, by name, for the same reason.
extern const NoiseSmoothing kNoiseSmoothing;
struct SecondLook;
/// Second alignments while a track runs, by name, for the same reason.
extern const SecondLook kSecondLook;

/// Capacities of a Tracker. The defaults are profile M. With them, and the size of the frames, the README's figures for frames
/// of up to 360 px in width were measured.
/// `measured_bytes<Tracker>(model, limits)` gives the bytes that they cost.
struct TrackerLimits {
  /// Size of the frames, px. Every frame has exactly this size.
  std::uint16_t width = 320, height = 240;
  /// Size of the part of the frame in which templates are matched, px; it moves with the face. 0: the whole
  /// frame. Else at least 64 a side, of which no more counts than the frame has. A smaller region costs less
  /// memory; points outside it are not observed.
  std::uint16_t region_width = 0, region_height = 0;
  std::uint16_t patches = 128;  ///< templates captured in frame 0, at least 8
  /// Templates captured in all later key frames together: at least one in each, or 0, and there are none.
  std::uint16_t key_patches = 64;
  std::uint8_t key_frames = 4;      ///< later key frames kept at a time
  std::uint16_t markers = 0;        ///< image points that are tracked with the surface and never observed
  std::uint16_t curve_points = 96;  ///< edge points on lids, lips and brows; 0: edges are not matched there
  /// Edge points on the silhouette. 1.2 kB each with the built-in face, and 16 bytes a vertex if there are any.
  std::uint16_t silhouette_points = 0;
  /// If null, edges are not matched: there are no edge points, and their code, 4 kB on a Cortex-M, is not linked.
  const EdgeMatching* edges = &kEdgeMatching;
  std::uint16_t vertices = 512;     ///< of the mesh, at least those of the model's base mesh
  std::uint8_t pyramid_levels = 3;  ///< of the image pyramid, level 0 included
  std::uint8_t patch_window = 11;   ///< side of a template, px, odd
  std::uint8_t patch_margin = 4;    ///< pixels kept around a template, so that a turned window stays inside
  /// Keeps each template as last warped (PatchLimits::keeps_templates): 1.7 kB a template for a shorter search.
  bool keeps_templates = true;
  /// Keeps the previous frame. Frame-to-frame tracking needs it.
  bool keeps_previous = true;
  /// Keeps a copy of the frame. False, and keeps_previous false: the frame is read during `update` only, and
  /// must be planar.
  bool copies_frame = true;
  /// Smooths frames of a face with much noise, as in low light, before anything else reads them: where the standard
  /// deviation of the noise is 2 grey levels or more and above 0.42 of that of the grey levels, measured in each frame. width x
  /// (height + 10) bytes. If null, frames are used as they are, and the code is left out of the program; only the pictures in
  /// which a face is aligned or its eyes are read are smoothed, in place.
  const NoiseSmoothing* noise = &kNoiseSmoothing;
  std::uint16_t thumbnail_width = 96;    ///< widest thumbnail for coarse search, px
  std::uint16_t free_parameters = 0;     ///< as EstimatorLimits::free_parameters
  std::uint16_t samples_per_point = 0;   ///< as EstimatorLimits::samples_per_point
  bool samples_vertices = true;          ///< as EstimatorLimits, and as FitLimits::samples_base_mesh
  std::uint16_t rejection_sample = 256;  ///< as EstimatorLimits::rejection_sample
  const ForceRejection* rejection = &kForceRejection;  ///< as EstimatorLimits::rejection
  const StretchPrior* stretch = &kStretchPrior;        ///< as EstimatorLimits::stretch
  /// As EstimatorLimits::personal_field. 128 x 128 is the grid on which tables are baked: the person loses nothing.
  PersonalFieldLimits personal_field = {128, 128};
  Status (Cascade::*personalise)(const float* q) = &Cascade::personalise;  ///< as EstimatorLimits
  /// If it is kSurfaceTexture, image texture is noted for an adaptive mesh (EstimatorOptions::mesh_operations) in a grid over
  /// (u,v). If null, the mesh adapts to the view alone, and 1 kB of code is not linked.
  const TextureNoting* surface_texture = nullptr;
  /// Side of that grid, cells, at least 1; a byte a cell. Round value, not tuned.
  std::uint8_t texture_cells = 32;
  /// As EstimatorLimits::mesh_following. If null, the memory of mesh adaptation, 48 bytes a vertex, is used by other parts between
  /// starts.
  const MeshFollowing* mesh_following = &kMeshFollowing;
  /// Landmarks that `start_from_landmarks` takes at most. The fit uses the memory of the tracking, before it; where it
  /// needs more, the block grows.
  std::uint16_t start_points = 68;
  /// If null, or if the model has no tables for it, or for frames above 8,192 px a side, the tracker neither finds its model nor
  /// verifies tracks. Null also keeps the code out of the program, but only where the limits are `constexpr`: a variable links
  /// what it was initialised with, even if it is changed later. The same holds for the other pointers.
  const Detection* detection = &kDetection;
  /// Aligns the face now and then while it is tracked, to begin anew where more of it is seen than at a start by alignment; and
  /// aligns it with care in frames in which the templates fail: as the mean face, too, as another person where it may be one, and
  /// with a new track where light has changed for good (docs/algorithms.md, 7.15). 48 kB with the built-in face and the default
  /// limits or those of profile L, which share memory with it, 63 kB with those of profile S. If null, frames whose templates fail
  /// are aligned once, from the last good pose, and the code of the rest is left out of the program.
  const SecondLook* second_look = &kSecondLook;
  /// Estimates the identity parameters while the head turns far (docs/algorithms.md, section 7.20). Identity
  /// that a start gives, with a pose or a saved state, stays. If null, it always stays, and the code is left
  /// out of the program.
  const PersonRefinement* person = &kPersonRefinement;
  /// Side of the smallest face that is searched for, px (FaceBox). Below 48 counts as 48.
  std::uint16_t smallest_face_px = 48;
  /// Work of one frame without a track, cells of the search (FaceDetector::search). The default searches a
  /// frame of 320 x 240 at once, in the time of a few updates, and aligns what it finds. Below 12,000 a frame has either a part of
  /// the search or steps of an alignment, one for each 660 cells; the track then starts some frames later, with the model's base
  /// mesh. The built-in face's alignments take six steps, and one more in the frame that starts the track: with 3,960 and more
  /// light and face change less between them (docs/experiments.md, Searches and first checks).
  /// A search for a print is divided into corners, matches and fits of about this work, at least one part in a frame: by default it
  /// takes two to six frames of 640 x 480, with 4,000 cells some twelve. The surface is looked for in the first of them, followed
  /// meanwhile, and verified in the last. `pliant plan` has the frames of both searches, at most.
  std::uint32_t search_work = 24000;
};

/// `ok`, or `bad_argument` for limits of which no tracker can be made: frames outside 64 to 16,384 px a side,
/// a region below 64 px a side, thumbnails above 256 px, 0 or more than 6 pyramid levels, a template's side that
/// is even or outside 7 to 21 px, a margin above 16 px, fewer than 8 templates in frame 0 or more than 16,384 in
/// all, fewer templates of key frames than key frames (but for none), a personal field of 1 sample or more than 256 a side, a
/// start from 1 to 3 landmarks, a texture without cells, or more points than ids.
constexpr Status check(const TrackerLimits& l) {
  const auto is_between = [](int low, int value, int high) { return low <= value && value <= high; };
  const bool has_region = l.region_width != 0 || l.region_height != 0;
  const bool region_fits = l.region_width >= 64 && l.region_height >= 64;
  const int templates = l.patches + l.key_patches;
  const int points = templates + l.markers + l.curve_points + l.silhouette_points;
  const PersonalFieldLimits& person = l.personal_field;
  const bool has_person = person.width != 0 || person.height != 0;
  const bool person_fits = is_between(2, person.width, 256) && is_between(2, person.height, 256);
  const bool is_possible =
      is_between(64, l.width, 16384) && is_between(64, l.height, 16384) && (!has_region || region_fits) &&
      l.thumbnail_width <= 256 && is_between(1, l.pyramid_levels, 6) && is_between(7, l.patch_window, 21) &&
      l.patch_window % 2 == 1 && l.patch_margin <= 16 && l.patches >= 8 && templates <= 16384 &&
      (!has_person || person_fits) && (l.start_points == 0 || l.start_points >= 4) && points < 0xFFFF &&
      (l.key_patches == 0 || l.key_patches >= l.key_frames) &&
      (l.surface_texture == nullptr || l.texture_cells > 0);
  return is_possible ? Status::ok : Status::bad_argument;
}

/// create_in refuses limits that `check` refuses (arena.hpp).
constexpr bool is_usable(const TrackerLimits& limits) {
  return check(limits) == Status::ok;
}

}  // namespace pliant
