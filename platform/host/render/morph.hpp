#pragma once
/// \file morph.hpp
/// A model's expressions as morph targets: displacements of a fixed mesh that a viewer adds with weights.
///
/// A surface is not linear in its parameters, because rotations and products are not. Around rest it is, to second order,
///   p(w) = p_0 + sum_i w_i D_i + sum_i w_i (1 - w_i) D_ii + sum_{i<j} w_i w_j D_ij
/// where w is the fraction of a parameter's range, and each D is taken from the exact surface at w = 1, at w = 1/2 and for
/// pairs at w = 1. The terms of second order become targets too ("correctives"), if the animation needs them.
#include <array>
#include <string>
#include <vector>

#include "host/io/owned.hpp"
#include "pliant/cascade.hpp"

namespace pliant::host {

struct MorphTarget {
  /// "jawOpen"; for a corrective the formula of its weight: "jawOpen*(1-jawOpen)", "jawOpen*mouthSmileLeft".
  std::string name;
  std::vector<Vec3> position,
      normal;  ///< displacements at weight 1, one a vertex: of the position, mm, and of the unit normal
  std::size_t first = 0, second = 0;  ///< indices into `parameters`; equal for a target of one expression
  bool is_corrective = false;
};

struct MorphError {
  double mean_mm = 0, max_mm = 0;
};

/// The targets that an animation needs, and their errors.
struct Morphs {
  std::vector<std::uint16_t> parameters;  ///< expressions that have a target, ascending
  std::vector<Vec3> position, normal;     ///< of the person at rest
  std::vector<MorphTarget> targets;       ///< those of `parameters` first, in order
  MorphError linear;                      ///< error over frames and vertices without correctives
  MorphError all;                         ///< with correctives
};

/// One person's surface at the vertices of a mesh.
class MorphSurface {
 public:
  /// \param q  all parameters; only the identities are read.
  MorphSurface(const Model& model, const std::vector<Vec2>& uv, const std::vector<float>& q);
  std::vector<Vec3> positions(const std::vector<float>& q);
  const Model& model() const { return cascade_->model(); }

 private:
  Owned<Cascade> cascade_;
  std::vector<Vec3> baked_;
  std::size_t count_;
};

using Faces = std::vector<std::array<std::uint16_t, 3>>;

/// \param frames        all parameters in each frame of the animation; at least one.
/// \param driven        the expressions that may move; those that never do get no target.
/// \param tolerance_mm  a corrective that moves no vertex further than this in any frame is left out.
Morphs make_morphs(MorphSurface& surface, const Faces& faces, const std::vector<std::vector<float>>& frames,
                   const std::vector<std::uint16_t>& driven, float tolerance_mm);

/// The weight of each target at q.
std::vector<float> morph_weights(const Model& model, const Morphs& morphs, const std::vector<float>& q);

}  // namespace pliant::host
