#include "host/render/model_mesh.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace pliant::host {

namespace {

MeshLimits limits_of(const MeshRequest& request) {
  MeshLimits limits;
  limits.faces = limits.vertices = MeshLimits::kMostFaces;
  limits.max_level = static_cast<std::uint8_t>(std::min<int>(request.depth, MeshLimits::kDeepest));
  return limits;
}

ContourOptions contour_options(const MeshRequest& request) {
  ContourOptions options;
  options.mean_mm = request.threshold;
  options.max_mm =
      3 * request.threshold;  // bounds peaks and troughs, which the mean of a triangle averages out
  // With a budget alone the rank is the triangle's contribution to the mean error of the whole.
  options.volume_mm3 = request.threshold > 0 ? 0 : 1e-6f;
  return options;
}

NormalsOptions normals_options(const MeshRequest& request) {
  constexpr float kRadian = 0.0174532925f;
  NormalsOptions options;
  options.cos_angle = std::cos(std::max(request.threshold, 0.1f) * kRadian);
  return options;
}

}  // namespace

Vec3 ModelSurface::normal(Vec2 uv) {
  constexpr float kStep = 1.0f / 200;
  const Vec3 du = sample({uv.x + kStep, uv.y}) - sample({uv.x - kStep, uv.y});
  const Vec3 dv = sample({uv.x, uv.y + kStep}) - sample({uv.x, uv.y - kStep});
  return normalised(cross(dv, du));  // u points right and v points down
}

Surface ModelSurface::surface() {
  return {this, [](void* self, Vec2 uv) { return static_cast<ModelSurface*>(self)->sample(uv); }};
}

ModelMesh::ModelMesh(const Model& model, ModelSurface& surface, const MeshRequest& request)
    : surface_(surface), mesh_(limits_of(request)), adapter_(limits_of(request)) {
  require(mesh_->set_base(model.base_uv(), model.base_corners()), "base mesh");
  const auto start = std::chrono::steady_clock::now();
  adapt(request);
  milliseconds_ = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

void ModelMesh::adapt(const MeshRequest& request) {
  const Unconditional uniform{request.criterion == MeshCriterion::none ? 0 : request.depth};
  const NormalsOptions normals = normals_options(request);
  const ContourOptions contour = contour_options(request);
  Criterion criterion = criterion_of(uniform);
  if (request.criterion == MeshCriterion::normals) criterion = criterion_of(normals);
  if (request.criterion == MeshCriterion::contour) criterion = criterion_of(contour);
  AdaptOptions options;
  options.vertex_budget = request.budget;
  require(adapter_->start(*mesh_, surface_.surface(), criterion), "base mesh");
  report_ = adapter_->adapt(options);
  for (const FaceId f : mesh_->faces())
    is_within_tolerance_ =
        is_within_tolerance_ && !(criterion.refine_rank(criterion.context, shape(), f) > 1);
}

ContourError ModelMesh::measure() const {
  const int faces = std::max(mesh().face_count(), 1);
  const int cells = std::clamp(static_cast<int>(std::sqrt(200000.0 / faces)), 4, 32);
  return compute_contour_error(shape(), cells);
}

}  // namespace pliant::host
