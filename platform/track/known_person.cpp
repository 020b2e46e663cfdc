#include "track/known_person.hpp"

#include "base/arrays.hpp"

namespace pliant {

void IdentityReference::lay_out(Arena& arena, const Model& model) {
  parameters_ = model.parameters();
  q_ = arena.take<float>(parameters_.count);
}

void IdentityReference::set(const AlignedFace& face, const float* q) {
  copy(q, parameters_.count, q_);
  is_frontal_ = is_frontal(view_of(face.pose, face.camera));
}

bool IdentityReference::may_be(const AlignedFace& face, const float* q) const {
  if (!is_frontal(view_of(face.pose, face.camera))) return true;
  float sum = 0, count = 0;
  for (std::size_t k = 0; k < parameters_.count; ++k) {
    if (parameters_[k].group == Group::expression) continue;
    const float off = (q[k] - q_[k]) / parameters_[k].sd;
    sum += off * off;
    ++count;
  }
  return sum <= count * kKnownPersonTuning.most_identity_distance * kKnownPersonTuning.most_identity_distance;
}

}  // namespace pliant
