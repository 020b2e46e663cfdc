#include "adapted_mesh.hpp"

#include <algorithm>

namespace pliant::figure9 {

namespace {

constexpr int kOperationsPerFrame = 64, kParts = 4;

MeshLimits mesh_limits() {
  MeshLimits limits;
  limits.vertices = kMostVertices;
  limits.faces = MeshLimits::kMostFaces;
  limits.max_level = MeshLimits::kDeepest;
  return limits;
}

constexpr ContourOptions kUnderBudget{0, 0, 1e-6f};

}  // namespace

float compute_rank(const SeenError& options, const Shape& shape, const Triangle& t) {
  const Vec3 a = shape.position[t.corner[0]], b = shape.position[t.corner[1]],
             c = shape.position[t.corner[2]];
  const Vec3 normal = normalised(cross(b - a, c - a));
  const float seen = dot(normal, options.to_camera) > -0.1f ? 1.0f : options.hidden_gain;
  const Vec2 middle =
      (1.0f / 3) * (shape.mesh.uv(t.corner[0]) + (shape.mesh.uv(t.corner[1]) + shape.mesh.uv(t.corner[2])));
  return seen * (1 + options.texture_gain * options.score->at(middle)) *
         compute_rank(options.contour, shape, t);
}

std::size_t ChartScore::index(Vec2 uv) {
  const auto cell = [](float t) { return static_cast<std::size_t>(clamp(t * kCells, 0, kCells - 1)); };
  return cell(uv.y) * kCells + cell(uv.x);
}

void ChartScore::normalise() {
  std::vector<float> seen;
  std::copy_if(score_.begin(), score_.end(), std::back_inserter(seen), [](float s) { return s > 0; });
  if (seen.empty()) return;
  std::nth_element(seen.begin(), seen.begin() + static_cast<std::ptrdiff_t>(seen.size() / 2), seen.end());
  const float middle = max(seen[seen.size() / 2], 1e-6f);
  for (float& s : score_) s = min(s / middle, 4);
}

AdaptedMesh::AdaptedMesh(const Model& model, const std::vector<float>& q, const MeshSetting& setting,
                         const Pose& pose, const ChartScore& score)
    : setting_(setting), surface_(model, q), mesh_(mesh_limits()), adapter_(mesh_limits()) {
  contour_.mean_mm = 0.2f;
  contour_.max_mm = 0.6f;
  // What a triangle adds to the mean error of the whole is what counts under a budget.
  if (setting.kind == MeshKind::budgeted) contour_ = kUnderBudget;
  seen_.contour = kUnderBudget;
  seen_.score = &score;
  set_view(pose);
  uniform_.levels = setting.kind == MeshKind::unconditional ? 3 : 0;
  host::require(mesh_->set_base(model.base_uv(), model.base_corners()), "base mesh");
  host::require(adapter_->start(*mesh_, surface_.surface(), criterion()), "base mesh");
  AdaptOptions options;
  options.vertex_budget = setting.vertices;
  adapter_->adapt(options);
}

void AdaptedMesh::set_view(const Pose& pose) {
  const Vec3 camera = rotation_matrix(conjugate(pose.q)) * (-1.0f * normalised(pose.t));
  seen_.to_camera = {camera.x, -camera.y, -camera.z};
}

Criterion AdaptedMesh::criterion() {
  switch (setting_.kind) {
    case MeshKind::normals:
      return criterion_of(normals_);
    case MeshKind::contour:
    case MeshKind::budgeted:
      return criterion_of(contour_);
    case MeshKind::adaptive:
      return criterion_of<SeenError, compute_rank>(seen_);
    case MeshKind::base:
    case MeshKind::unconditional:
      break;
  }
  return criterion_of(uniform_);
}

bool AdaptedMesh::update(const Pose& pose, int frame) {
  if (setting_.kind != MeshKind::adaptive) return false;
  set_view(pose);
  adapter_->rerank(frame % kParts, kParts);
  AdaptOptions options;
  options.vertex_budget = setting_.vertices;
  options.max_operations = kOperationsPerFrame;
  const AdaptReport report = adapter_->adapt(options);
  return report.splits + report.welds > 0;
}

}  // namespace pliant::figure9
