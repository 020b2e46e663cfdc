#include "track/start_fit.hpp"

#include <new>

#include "face/box_view.hpp"
#include "face/ibug_landmarks.hpp"
#include "pliant/lens.hpp"
#include "track/landmark_fit.hpp"

namespace pliant {

namespace {

struct FitMemory {
  Span<Correspondence> points;
  LandmarkFit* fit;

  FitMemory(Arena& arena, std::size_t count)
      : points(arena.take_span<Correspondence>(count)), fit(arena.take<LandmarkFit>(1)) {}
};

}  // namespace

std::size_t start_fit_bytes(const Model& model, std::size_t points, bool samples_base_mesh) {
  if (points == 0) return 0;
  Arena trial;
  FitMemory(trial, points);
  LandmarkFit measured;
  measured.lay_out(trial, model, points, samples_base_mesh);
  return trial.used_bytes();
}

Status fit_to_landmarks(Arena& arena, const Model& model, Span<const NamedPoint> points,
                        bool samples_base_mesh, const FitOptions& options, float* q, StartPose* start,
                        LandmarkOffsets* offsets) {
  const FitMemory memory(arena, points.count);
  if (arena.exhausted()) return Status::out_of_memory;
  LandmarkFit& fit = *new (memory.fit) LandmarkFit();
  Status status = create_in(arena, fit, model, points.count, samples_base_mesh);
  if (status != Status::ok) return status;
  for (std::size_t k = 0; k < points.count; ++k) {
    const Landmark& l = model.landmarks()[model.find_landmark(points[k].name)];
    memory.points[k] = {l.uv(), points[k].x, 1, is_silhouette_landmark(l.name)};
  }
  for (std::size_t k = 0; k < model.parameters().count; ++k) q[k] = 0;
  status = fit.fit(memory.points, options, q);
  if (status != Status::ok) return status;
  start->camera = options.camera != nullptr ? *options.camera : camera_of(fit.report().view);
  start->pose = pose_of(fit.report().view);
  offsets->set_pending(fit.offset_landmarks(memory.points), model);
  return status;
}

namespace {

/// The face box of a view; side 0 if the model lacks a landmark.
FaceBox box_of(Cascade& cascade, const float* q, const View& view) {
  const Projector projector(view, true);
  return box_at_landmarks(cascade.model(), view.s, [&](std::uint16_t k, Vec2* x) {
    const Landmark& l = cascade.model().landmarks()[k];
    return projector.project(cascade.surface_point(l.uv(), q), x);
  });
}

/// The box where the camera shows it.
FaceBox seen(const FaceBox& ideal, const Lens& lens) {
  if (lens.is_none()) return ideal;
  const Vec2 half{0.5f * ideal.side, 0};
  return {lens.distort(ideal.center),
          lens.distort(ideal.center + half).x - lens.distort(ideal.center - half).x};
}

}  // namespace

Status fit_to_box(Cascade& cascade, GivenBox given, int width, int height, const float* q, StartPose* start,
                  FaceBox* box) {
  Lens lens;
  Status status = Lens::make(start->camera, width, height, &lens);
  if (status != Status::ok) return status;
  if (given.convention == BoxConvention::opencv) {
    const float side = given.size.x;
    given.corner = given.corner + Vec2{kStartFitTuning.opencv_left * side, kStartFitTuning.opencv_top * side};
    given.size = {kStartFitTuning.opencv_size * side, kStartFitTuning.opencv_size * side};
  }
  const Vec2 corner = lens.undistort(given.corner), size = lens.undistort(given.corner + given.size) - corner;
  View view;
  status = view_from_box(cascade, q, corner, size, start->camera, &view);
  *box = status == Status::ok ? seen(box_of(cascade, q, view), lens) : FaceBox{};
  if (given.convention == BoxConvention::face_box && box->side > 0) {
    box->center = given.corner + 0.5f * given.size;
    box->side = size.x;
    (void)view_of_box(cascade, q, *box, 0, start->camera, lens, &view);  // the model has the corners
    box->side = given.size.x;
  }
  if (status == Status::ok) start->pose = pose_of(view);
  return status;
}

}  // namespace pliant
