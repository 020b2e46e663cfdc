#pragma once
/// \file mesh_star.hpp
/// A walk over the half-edges that leave a vertex.
#include "pliant/mesh.hpp"

namespace pliant {

/// The half-edges that leave a vertex, counter-clockwise: for (HalfEdgeId h : star(mesh, v)).
class Star {
 public:
  class Iterator {
   public:
    Iterator(const Mesh& mesh, HalfEdgeId first) : mesh_(&mesh), first_(first), at_(first) {}
    HalfEdgeId operator*() const { return at_; }
    Iterator& operator++() {
      at_ = mesh_->next_in_star(at_);
      if (at_ == first_) at_ = kNone;
      return *this;
    }
    bool operator!=(const Iterator& other) const { return at_ != other.at_; }

   private:
    const Mesh* mesh_;
    HalfEdgeId first_, at_;
  };

  Star(const Mesh& mesh, VertexId v) : mesh_(mesh), first_(mesh.out(v)) {}
  Iterator begin() const { return {mesh_, first_}; }
  Iterator end() const { return {mesh_, kNone}; }

 private:
  const Mesh& mesh_;
  HalfEdgeId first_;
};

inline Star star(const Mesh& mesh, VertexId v) {
  return {mesh, v};
}

}  // namespace pliant
