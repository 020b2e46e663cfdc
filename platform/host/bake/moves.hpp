#pragma once
/// \file moves.hpp
/// Deformations of a cage as rows of a table: what moves, how far around it the motion reaches, and by how
/// much.
#include <map>
#include <string>
#include <vector>

#include "host/bake/cage.hpp"

namespace pliant::host::bake {

/// How a row acts on a point p, with f its falloff there.
enum class MoveKind {
  shift,    ///< p + f (x, y, z), millimetres
  stretch,  ///< p + f (x (p - c).x, y (p - c).y, z (p - c).z) / 100, per cent, c the first of its points
  hinge,    ///< turns with the weight x (the last row that names a point holds); y and z are 0
};

struct Move {
  std::string parameter;
  MoveKind kind;
  std::vector<int> centres;  ///< points of the cage
  float radius;  ///< millimetres; f = (1 - (d / radius)^2)^2 at distance d from the nearest centre; 0: f = 1
                 ///< at the centres and 0 elsewhere
  std::vector<char> group;  ///< the points that may move
  Vec3 amount;
};

/// Named sets of points, the same on both sides; "all" and "skin" (what is no hole) need no row.
using Groups = std::map<std::string, std::vector<char>>;
Groups read_groups(const std::string& folder, const Cage& cage);

/// Points behind an opening (the eyeball's rim, the inside of the lips) that go along with a point of the
/// skin wherever a row moves that but not them.
struct Follower {
  int point, leader;
  float share;
};
std::vector<Follower> read_followers(const std::string& folder, const Cage& cage);

/// Reads `file` of `folder`, of which every row must name one of `parameters`.
std::vector<Move> read_moves(const std::string& folder, const std::string& file, const Cage& cage,
                             const Groups& groups, const std::vector<std::string>& parameters);

/// Sum of the rows of one parameter at every cage point, in millimetres. Without `sided`, what the rows do to
/// the left half is mirrored to the right; with it, they act on the whole cage.
std::vector<Vec3> displacement_of(const std::vector<Move>& moves, const std::string& parameter, bool sided,
                                  const Cage& cage, const std::vector<Follower>& followers);

/// The weights of the parameter's hinge rows at every cage point; empty when it has none.
std::vector<float> hinge_of(const std::vector<Move>& moves, const std::string& parameter, const Cage& cage,
                            const std::vector<Follower>& followers);

}  // namespace pliant::host::bake
