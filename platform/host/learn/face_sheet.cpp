#include "host/learn/face_sheet.hpp"

#include <set>
#include <utility>

#include "host/io/ibug_names.hpp"
#include "host/render/shown_mesh.hpp"

namespace pliant::host::learn {

namespace {

/// A vector that moves a point by less at the limits of its parameter is left out. Far below a pixel.
constexpr float kSlackMm = 0.01f;

/// Whether the chart position lies nearer to the inner lips than to the eyes.
bool is_mouth(const Model& model, Vec2 uv) {
  float nearest[2] = {1e9f, 1e9f};  // to the mouth, to an eye
  const auto landmarks = model.landmarks();
  for (const Landmark& l : landmarks) {
    const int k = ibug_number(l.name);
    const bool is_lip = k >= 48 && k < kIbugCount, is_lid = k >= 36 && k <= 47;
    if (!is_lip && !is_lid) continue;
    float& distance = nearest[is_lip ? 0 : 1];
    distance = min(distance, length(uv - l.uv()));
  }
  return nearest[0] < nearest[1];
}

std::vector<Vec3> sampled(Cascade& cascade, const std::vector<Vec2>& uv) {
  const std::size_t size = cascade.samples_per_point();
  const std::vector<float> rest(cascade.parameter_count(), 0.0f);
  std::vector<Vec3> out(uv.size() * size);
  for (std::size_t k = 0; k < uv.size(); ++k)
    cascade.sample_point(uv[k], rest.data(), out.data() + k * size, kSlackMm);
  return out;
}

std::vector<Vec3> evaluated(Cascade& cascade, const std::vector<Vec3>& samples, const float* q) {
  const std::size_t size = cascade.samples_per_point();
  std::vector<Vec3> out;
  for (std::size_t k = 0; k < samples.size(); k += size)
    out.push_back(cascade.evaluate(samples.data() + k, q));
  return out;
}

/// Distance of each vertex to the nearest vertex of an edge that only one triangle has.
std::vector<float> distances_to_edge(const std::vector<FaceTriangle>& triangles,
                                     const std::vector<Vec3>& position) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const FaceTriangle& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) edges.emplace(t.corner[k], t.corner[(k + 1) % 3]);
  std::set<std::uint32_t> outer;
  for (const auto& [a, b] : edges)
    if (edges.count({b, a}) == 0) outer.insert(a), outer.insert(b);
  std::vector<float> out(position.size(), 1e9f);
  for (std::size_t k = 0; k < position.size(); ++k)
    for (const std::uint32_t v : outer) out[k] = min(out[k], length(position[k] - position[v]));
  return out;
}

}  // namespace

FaceSheet::FaceSheet(const Model& model, int depth) {
  ModelSurface surface(model, std::vector<float>(model.parameters().count, 0.0f));
  MeshRequest request;
  request.criterion = MeshCriterion::uniform;
  request.depth = depth;
  const ModelMesh adapted(model, surface, request);
  const std::size_t skin = mesh_data(adapted).faces.size();
  const MeshData mesh = closed_mesh(adapted);
  uv = mesh.uv;
  for (std::size_t k = 0; k < mesh.faces.size(); ++k) {
    const auto& f = mesh.faces[k];
    const Vec2 middle = (1.0f / 3) * (uv[f[0]] + uv[f[1]] + uv[f[2]]);
    const FacePart opening = is_mouth(model, middle) ? FacePart::mouth : FacePart::eye;
    triangles.push_back({{f[0], f[1], f[2]}, k < skin ? FacePart::skin : opening});
  }
  edge_mm = distances_to_edge(triangles, mesh.position);
  Owned<Cascade> cascade(model);
  samples_ = sampled(*cascade, uv);
  std::vector<Vec2> landmark_uv;
  for (const Landmark& l : model.landmarks()) landmark_uv.push_back(l.uv());
  landmark_samples_ = sampled(*cascade, landmark_uv);
}

std::vector<Vec3> FaceSheet::positions(Cascade& cascade, const float* q) const {
  return evaluated(cascade, samples_, q);
}

std::vector<Vec3> FaceSheet::landmarks(Cascade& cascade, const float* q) const {
  return evaluated(cascade, landmark_samples_, q);
}

std::vector<Vec3> FaceSheet::normals(const std::vector<Vec3>& positions) const {
  std::vector<Vec3> out(positions.size());
  for (const FaceTriangle& t : triangles) {
    const Vec3 a = positions[t.corner[0]];
    const Vec3 n = cross(positions[t.corner[1]] - a, positions[t.corner[2]] - a);
    for (const std::uint32_t v : t.corner) out[v] = out[v] + n;
  }
  for (Vec3& n : out) n = normalised(n);
  return out;
}

}  // namespace pliant::host::learn
