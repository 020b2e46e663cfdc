#pragma once
/// \file moves.hpp
/// Deformations of a cage as rows of a table: which points move, how far the motion reaches around them, and by how much.
#include <map>
#include <string>
#include <vector>

#include "host/bake/cage.hpp"

namespace pliant::host::bake {

/// How a row acts on a point p, with f its falloff there.
enum class MoveKind {
  shift,    ///< p + f (x, y, z), millimetres
  stretch,  ///< p + f (x (p - c).x, y (p - c).y, z (p - c).z) / 100, per cent, c the first of its points
  hinge,  ///< p turns about the parameter's axis with the weight x; the last row that names a point counts; y and z are 0
};

struct Move {
  std::string parameter;
  MoveKind kind;
  std::vector<int> centres;  ///< points of the cage
  float
      radius;  ///< millimetres: f = (1 - (d / radius)^2)^2 at the distance d from the nearest centre. If zero, f = 1 at
      ///< the centres and 0 elsewhere.
  std::vector<char> group;  ///< the points that may move
  Vec3 amount;
};

/// Named sets of points, the same on both sides. "all" and "surface" (all points but those inside holes) need no row.
using Groups = std::map<std::string, std::vector<char>>;
Groups read_groups(const std::string& folder, const Cage& cage);

/// A point behind an opening (the eyeball's edge, the inside of the lips) that moves by a fraction of another point's motion
/// wherever a row moves that one only.
struct Follower {
  int point, leader;
  float fraction;
};
std::vector<Follower> read_followers(const std::string& folder, const Cage& cage);

/// Reads a file of the folder. Every row must name one of `parameters`. Throws SourceError.
std::vector<Move> read_moves(const std::string& folder, const std::string& file, const Cage& cage,
                             const Groups& groups, const std::vector<std::string>& parameters);

/// Displacement of every cage point by one parameter, millimetres: the sum of its rows. Without `sided`, the displacement of
/// the left half is mirrored to the right. With it, the rows act on the whole cage as they are.
std::vector<Vec3> displacement_of(const std::vector<Move>& moves, const std::string& parameter, bool sided,
                                  const Cage& cage, const std::vector<Follower>& followers);

/// For each cage point, how strongly it turns about the parameter's axis (0 to 1), from the rows of kind `hinge`. Empty if
/// there are none.
std::vector<float> hinge_of(const std::vector<Move>& moves, const std::string& parameter, const Cage& cage,
                            const std::vector<Follower>& followers);

}  // namespace pliant::host::bake
