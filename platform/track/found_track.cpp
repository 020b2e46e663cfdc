// Tracks that begin while another one of the face ends.
#include "track/found_track.hpp"

namespace pliant {

namespace {

/// The mesh stays: the face has nearly the same shape.
TrackerOptions with_present_mesh(const TrackerOptions& kept) {
  TrackerOptions options = kept;
  options.estimator.mesh_error_mm = -1;
  return options;
}

}  // namespace

void FaceDetectionState::begin_anew(TrackerParts& t, const FrameView& view, const AlignedFace& face) {
  StartPose found;
  face_search.set_new_person(face, &person_of(t), &found);
  landmark_error = face.landmark_error;
  (void)start_found(t, view, found, with_present_mesh(kept.options));  // a track that cannot begin is lost
}

void FaceDetectionState::renew(TrackerParts& t, const FrameView& view, float error) {
  const StartPose found{t.estimator.camera(), pose_of(t.estimator.view())};
  keep_parameters(t);
  note_person(found.camera);
  marker_count = t.markers.save(t.estimator, markers);
  landmark_error = error;
  (void)start(t, view, found, with_present_mesh(kept.options));  // a track that cannot begin is lost
}

}  // namespace pliant
