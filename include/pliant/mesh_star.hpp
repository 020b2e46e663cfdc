#pragma once
/// \file mesh_star.hpp
/// A walk over the half-edges that leave a vertex.
#include "pliant/mesh.hpp"

namespace pliant {

/// The half-edges that leave a vertex, counter-clockwise: for (HalfEdgeId h : star(mesh, v)).
class Star {
 public:
  /// Walks the half-edges.
  class Iterator {
   public:
    /// At `first`.
    Iterator(const Mesh& mesh, HalfEdgeId first) : mesh_(&mesh), first_(first), at_(first) {}
    HalfEdgeId operator*() const { return at_; }  ///< The half-edge.
    /// The next one counter-clockwise.
    Iterator& operator++() {
      at_ = mesh_->next_in_star(at_);
      if (at_ == first_) at_ = kNone;
      return *this;
    }
    /// Whether two are at different half-edges.
    bool operator!=(const Iterator& other) const { return at_ != other.at_; }

   private:
    const Mesh* mesh_;
    HalfEdgeId first_, at_;
  };

  Star(const Mesh& mesh, VertexId v) : mesh_(mesh), first_(mesh.out(v)) {}  ///< Of a live vertex.
  Iterator begin() const { return {mesh_, first_}; }                        ///< At out(v).
  Iterator end() const { return {mesh_, kNone}; }                           ///< One behind the last.

 private:
  const Mesh& mesh_;
  HalfEdgeId first_;
};

/// The half-edges that leave v.
inline Star star(const Mesh& mesh, VertexId v) {
  return {mesh, v};
}

}  // namespace pliant
