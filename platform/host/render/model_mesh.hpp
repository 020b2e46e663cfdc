#pragma once
/// \file model_mesh.hpp
/// A model's mesh, adapted to the surface at given parameters.
#include <vector>

#include "host/io/owned.hpp"
#include "pliant/cascade.hpp"
#include "pliant/criteria.hpp"

namespace pliant::host {

enum class MeshCriterion { none, uniform, normals, contour };

/// How a mesh is adapted. With a threshold of 0 it is as good as the budget allows.
struct MeshRequest {
  MeshCriterion criterion = MeshCriterion::none;
  int depth = 12;  ///< bisections of the base mesh: exactly for `uniform`, at most for the other criteria
  float threshold = 0;  ///< normals: degrees between faces; contour: mean error of a triangle, mm
  int budget = 0;       ///< vertices, at most; 0: as many as a mesh can have
};

/// The surface of a model at fixed parameters.
class ModelSurface {
 public:
  /// \param q  all parameters.
  ModelSurface(const Model& model, std::vector<float> q) : cascade_(model), q_(std::move(q)) {
    cascade_->select(q_.data());
  }

  Vec3 sample(Vec2 uv) { return cascade_->selected_point(uv); }
  /// Outward unit normal, smoothed over a few cells of a field; zero where the surface is degenerate.
  Vec3 normal(Vec2 uv);
  /// The interface of the core; valid as long as this object.
  Surface surface();

 private:
  Owned<Cascade> cascade_;
  std::vector<float> q_;
};

/// The base mesh of a model, refined.
class ModelMesh {
 public:
  /// \param surface  of the same model; must outlive the mesh.
  ModelMesh(const Model& model, ModelSurface& surface, const MeshRequest& request);

  const Mesh& mesh() const { return *mesh_.operator->(); }
  Vec3 position(VertexId v) const { return adapter_->position(v); }
  Shape shape() const { return adapter_->shape(); }
  ModelSurface& surface() const { return surface_; }
  const AdaptReport& report() const { return report_; }
  /// True if no face asks to be refined, those included that are as deep as the request allows.
  bool is_within_tolerance() const { return is_within_tolerance_; }
  double milliseconds() const { return milliseconds_; }
  /// Error against the surface, weighted by area, from some 200,000 samples.
  ContourError measure() const;

 private:
  void adapt(const MeshRequest& request);

  ModelSurface& surface_;
  Owned<Mesh> mesh_;
  Owned<Adapter> adapter_;
  AdaptReport report_;
  double milliseconds_ = 0;
  bool is_within_tolerance_ = true;
};

}  // namespace pliant::host
