#pragma once
// Choice among overlapping hits of a detector.
#include "pliant/arena.hpp"
#include "pliant/face_box.hpp"

namespace pliant {

/// A window that a detector takes for a face.
struct BoxHit {
  FaceBox box;
  int sum;  ///< of the trees
};

/// The area that two boxes share as a fraction of the area that they cover together.
float overlap(const FaceBox& a, const FaceBox& b);

/// Whether one box has not become another.
/// \param most_shift  of the middle, as a fraction of the side. \param most_ratio  of the sides.
inline bool is_same(const FaceBox& a, const FaceBox& b, float most_shift, float most_ratio) {
  return length(a.center - b.center) <= most_shift * a.side && a.side <= most_ratio * b.side &&
         b.side <= most_ratio * a.side;
}

/// Collects the hits with the highest sums.
class BoxHits {
 public:
  /// \param capacity  hits, at least 1; a face gives 3 to 40.
  void lay_out(Arena& arena, int capacity);
  void clear() { count_ = 0; }
  /// Adds a hit; if all places are taken, in place of the one with the lowest sum, if that is lower.
  void add(const BoxHit& hit);
  /// Takes out the hit with the highest sum and all that are largely within its box, or it in theirs, and
  /// returns the mean of those that overlap it much, weighted by their sums above `least_sum` and their
  /// sides. Of equal sums the first one counts. \pre !empty().
  BoxHit take_best(int least_sum);
  bool empty() const { return count_ == 0; }

 private:
  BoxHit* hits_ = nullptr;
  int count_ = 0, capacity_ = 0;
};

}  // namespace pliant
