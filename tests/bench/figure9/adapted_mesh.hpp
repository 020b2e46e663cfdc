#pragma once
/// \file adapted_mesh.hpp
/// The mesh that a run tracks with: the model's base mesh adapted to the person by one of the criteria, once or frame by
/// frame.
#include <cstdint>
#include <vector>

#include "host/render/model_mesh.hpp"
#include "pliant/camera.hpp"
#include "pliant/corners.hpp"

namespace pliant::figure9 {

/// Vertices of a mesh, at most. A slot of the matcher is kept for each.
constexpr std::uint16_t kMostVertices = 12000;

enum class MeshKind { base, normals, contour, unconditional, budgeted, adaptive };

struct MeshSetting {
  MeshKind kind = MeshKind::base;
  int vertices = 0;  ///< budget; 0: none
};

/// Texture over the chart, as frame 0 shows it: 1 at the median, at most 4.
class ChartScore {
 public:
  /// Takes one sample; (u,v) in [0,1].
  void set(Vec2 uv, float lambda_min) { score_[index(uv)] = lambda_min; }
  void normalise();
  float at(Vec2 uv) const { return score_[index(uv)]; }
  static constexpr int kCells = 64;

 private:
  static std::size_t index(Vec2 uv);
  std::vector<float> score_ = std::vector<float>(std::size_t{kCells} * kCells, 0.0f);
};

/// Weighted contour error of a triangle. The weight is small where the triangle is turned away from the camera, and larger
/// where there is texture.
struct SeenError {
  ContourOptions contour;
  Vec3 to_camera;  ///< direction from the model to the camera, model axes
  float hidden_gain = 0.05f;
  float texture_gain = 0.25f;
  const ChartScore* score = nullptr;
};
float compute_rank(const SeenError& options, const Shape& shape, const Triangle& triangle);

class AdaptedMesh {
 public:
  /// \param q  all parameters of the person, in frame 0.
  AdaptedMesh(const Model& model, const std::vector<float>& q, const MeshSetting& setting, const Pose& pose,
              const ChartScore& score);

  const Mesh& mesh() const { return *mesh_.operator->(); }
  /// `adaptive` is adapted to the view: at most 64 operations, a quarter of the ranks made anew. Others stay as they are.
  /// \return whether the mesh may have changed.
  bool update(const Pose& pose, int frame);

 private:
  Criterion criterion();
  void set_view(const Pose& pose);

  MeshSetting setting_;
  host::ModelSurface surface_;
  host::Owned<Mesh> mesh_;
  host::Owned<Adapter> adapter_;
  Unconditional uniform_;
  NormalsOptions normals_;
  ContourOptions contour_;
  SeenError seen_;
};

}  // namespace pliant::figure9
