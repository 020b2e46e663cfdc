#include "track/start_fit.hpp"

#include <new>

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

std::size_t start_fit_bytes(const Model& model, std::size_t points) {
  if (points == 0) return 0;
  Arena trial;
  FitMemory(trial, points);
  LandmarkFit measured;
  measured.lay_out(trial, model, points);
  return trial.used_bytes();
}

Status fit_to_landmarks(Arena& arena, const Model& model, Span<const NamedPoint> points,
                        const FitOptions& options, float* q, StartPose* start, LandmarkOffsets* offsets) {
  const FitMemory memory(arena, points.count);
  if (arena.exhausted()) return Status::out_of_memory;
  LandmarkFit& fit = *new (memory.fit) LandmarkFit();
  Status status = create_in(arena, fit, model, points.count);
  if (status != Status::ok) return status;
  for (std::size_t k = 0; k < points.count; ++k) {
    const Landmark& l = model.landmarks()[model.find_landmark(points[k].name)];
    memory.points[k] = {{l.u, l.v}, points[k].x, 1, is_silhouette_landmark(l.name)};
  }
  for (std::size_t k = 0; k < model.parameters().count; ++k) q[k] = 0;
  status = fit.fit(memory.points, options, q);
  if (status != Status::ok) return status;
  start->camera = options.camera != nullptr ? *options.camera : camera_of(fit.report().view);
  start->pose = pose_of(fit.report().view);
  if (offsets != nullptr) offsets->set_pending(fit.personal_landmarks(memory.points), model);
  return status;
}

Status fit_to_box(Arena& arena, const Model& model, Vec2 corner, Vec2 size, const float* q,
                  StartPose* start) {
  Cascade* const room = arena.take<Cascade>(1);
  if (room == nullptr) return Status::out_of_memory;
  Cascade& cascade = *new (room) Cascade();
  Status status = create_in(arena, cascade, model);
  if (status != Status::ok) return status;
  View view;
  status = view_from_box(cascade, q, corner, size, start->camera, &view);
  if (status == Status::ok) start->pose = pose_of(view);
  return status;
}

}  // namespace pliant
