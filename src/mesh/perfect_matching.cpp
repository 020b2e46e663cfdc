// Edmonds' search for an augmenting path (1965), which may also end at an outer face that may stay single. Outer
// faces are those that an alternating path of even length connects with the unmatched root. If one of them may stay single,
// shifting all pairs along its path gives the root a partner and leaves that face single.
#include "mesh/perfect_matching.hpp"

namespace pliant {

FaceMatching::FaceMatching(const Mesh& mesh, std::size_t face_count, const MatchingMemory& memory)
    : mesh_(mesh), m_(memory), face_count_(face_count) {
  for (std::size_t f = 0; f < face_count; ++f) {
    m_.parent[f] = kNone;
    m_.base[f] = static_cast<FaceId>(f);
    m_.flags[f] = 0;
  }
}

bool FaceMatching::may_stay_single(FaceId f) const {
  for (int k = 0; k < 3; ++k)
    if (neighbour(f, k) == kNone) return true;
  return false;
}

FaceId FaceMatching::neighbour(FaceId f, int k) const {
  const HalfEdgeId t = mesh_.twin(Mesh::half_edge(f, k));
  return t == kNone ? kNone : Mesh::face_of(t);
}

// Only the labels of the last search have to be cleared before the next: a short search stays cheap.
void FaceMatching::label(FaceId f) {
  m_.visited[visited_count_++] = f;
}

void FaceMatching::forget() {
  for (std::size_t i = 0; i < visited_count_; ++i) {
    const FaceId f = m_.visited[i];
    m_.parent[f] = kNone;
    m_.base[f] = f;
    m_.flags[f] = 0;
  }
  visited_count_ = head_ = tail_ = 0;
}

void FaceMatching::make_outer(FaceId f) {
  m_.flags[f] |= kOuter;
  m_.queue[tail_++] = f;
}

// The first outer face, as base of a blossom, that the paths from a and from b to the root share.
FaceId FaceMatching::common_base(FaceId a, FaceId b) {
  for (FaceId x = m_.base[a];; x = m_.base[m_.parent[m_.mate[x]]]) {
    m_.flags[x] |= kOnPath;
    if (x == root_) break;
  }
  FaceId meet = m_.base[b];
  while ((m_.flags[meet] & kOnPath) == 0) meet = m_.base[m_.parent[m_.mate[meet]]];
  for (FaceId x = m_.base[a];; x = m_.base[m_.parent[m_.mate[x]]]) {
    m_.flags[x] &= static_cast<std::uint8_t>(~kOnPath);
    if (x == root_) break;
  }
  return meet;
}

void FaceMatching::mark_path(FaceId v, FaceId base, FaceId child) {
  while (m_.base[v] != base) {
    m_.flags[m_.base[v]] |= kInBlossom;
    m_.flags[m_.base[m_.mate[v]]] |= kInBlossom;
    m_.parent[v] = child;
    child = m_.mate[v];
    v = m_.parent[child];
  }
}

// Two outer faces are neighbours: the odd cycle through them becomes one outer node.
void FaceMatching::contract(FaceId v, FaceId to) {
  const FaceId base = common_base(v, to);
  mark_path(v, base, to);
  mark_path(to, base, v);
  for (std::size_t i = 0; i < visited_count_; ++i) {
    const FaceId f = m_.visited[i];
    if ((m_.flags[m_.base[f]] & kInBlossom) == 0) continue;
    // Bases are cleared below, not here: whether f is in the cycle must not depend on the order of the faces.
    m_.flags[f] |= kOnPath;
  }
  for (std::size_t i = 0; i < visited_count_; ++i) {
    const FaceId f = m_.visited[i];
    const bool inside = (m_.flags[f] & kOnPath) != 0;
    m_.flags[f] &= static_cast<std::uint8_t>(~(kOnPath | kInBlossom));
    if (!inside) continue;
    m_.base[f] = base;
    if ((m_.flags[f] & kOuter) == 0) make_outer(f);
  }
}

// Visits the neighbours of outer face v. True when a path was found: it ends at found_.
bool FaceMatching::grow(FaceId v) {
  if (v != root_ && may_stay_single(v)) {
    found_ = m_.mate[v];
    m_.mate[v] = kNone;
    return true;
  }
  for (int k = 0; k < 3; ++k) {
    const FaceId to = neighbour(v, k);
    if (to == kNone || m_.base[v] == m_.base[to] || m_.mate[v] == to) continue;
    if ((m_.flags[to] & kOuter) != 0) {
      contract(v, to);
    } else if (m_.parent[to] == kNone) {
      m_.parent[to] = v;
      label(to);
      if (m_.mate[to] == kNone) {
        found_ = to;
        return true;
      }
      label(m_.mate[to]);
      make_outer(m_.mate[to]);
    }
  }
  return false;
}

// Shifts the pairs along the path from `end`, a face without partner, back to the root.
void FaceMatching::flip_path(FaceId end) {
  while (end != kNone) {
    const FaceId outer = m_.parent[end], next = m_.mate[outer];
    m_.mate[end] = outer;
    m_.mate[outer] = end;
    end = next;
  }
}

bool FaceMatching::augment_from(FaceId root) {
  root_ = root;
  label(root);
  make_outer(root);
  bool found = false;
  while (!found && head_ < tail_) found = grow(m_.queue[head_++]);
  if (found) flip_path(found_);
  forget();
  return found;
}

bool FaceMatching::complete() {
  for (std::size_t f = 0; f < face_count_; ++f) {
    const auto face = static_cast<FaceId>(f);
    if (m_.mate[f] == kNone && !may_stay_single(face) && !augment_from(face)) return false;
  }
  return true;
}

}  // namespace pliant
