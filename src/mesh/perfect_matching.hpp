#pragma once
// Pairs the faces of a mesh with neighbours. Faces with an edge on the boundary may stay single. Edmonds' blossom algorithm,
// one augmenting path at a time, in memory of the caller.
#include "pliant/mesh.hpp"

namespace pliant {

/// Arrays of one entry a face.
struct MatchingMemory {
  std::uint16_t *mate, *parent, *base, *queue, *visited;
  std::uint8_t* flags;
};

class FaceMatching {
 public:
  /// Faces are 0 ... face_count - 1. `memory.mate` holds a matching to start from (kNone: single).
  FaceMatching(const Mesh& mesh, std::size_t face_count, const MatchingMemory& memory);

  /// Changes the matching until only faces with an edge on the boundary are single. False where that is
  /// impossible.
  bool complete();

 private:
  enum : std::uint8_t { kOuter = 1, kOnPath = 2, kInBlossom = 4 };

  bool may_stay_single(FaceId f) const;
  FaceId neighbour(FaceId f, int k) const;
  bool augment_from(FaceId root);
  bool grow(FaceId v);
  void make_outer(FaceId f);
  void label(FaceId f);
  FaceId common_base(FaceId a, FaceId b);
  void mark_path(FaceId v, FaceId base, FaceId child);
  void contract(FaceId v, FaceId to);
  void flip_path(FaceId end);
  void forget();

  const Mesh& mesh_;
  MatchingMemory m_;
  std::size_t face_count_;
  FaceId root_ = kNone, found_ = kNone;
  std::size_t head_ = 0, tail_ = 0, visited_count_ = 0;
};

}  // namespace pliant
