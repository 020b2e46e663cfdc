#include "host/bake/moves.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "host/bake/at.hpp"
#include "host/bake/text_table.hpp"

namespace pliant::host::bake {

namespace {

std::vector<int> points_in(const Cage& cage, const TextTable& table, const TextRow& row,
                           const std::string& word) {
  try {
    return points_of(cage, word);
  } catch (const std::invalid_argument& error) {
    table.fail(row, error.what());
  }
}

float falloff(const Move& move, const Cage& cage, std::size_t point) {
  if (!move.group[point]) return 0;
  if (move.radius == 0)
    return std::count(move.centres.begin(), move.centres.end(), static_cast<int>(point)) > 0 ? 1.0f : 0.0f;
  float nearest = move.radius;
  for (int c : move.centres) nearest = std::min(nearest, length(cage.position[point] - cage.position[at(c)]));
  const float t = nearest / move.radius, f = 1 - t * t;
  return f * f;
}

Vec3 effect(const Move& move, const Cage& cage, std::size_t point) {
  const float f = falloff(move, cage, point);
  if (f == 0) return {};
  if (move.kind == MoveKind::shift) return f * move.amount;
  const Vec3 d = cage.position[point] - cage.position[at(move.centres[0])];
  return 0.01f * f * Vec3{move.amount.x * d.x, move.amount.y * d.y, move.amount.z * d.z};
}

MoveKind kind_of(const TextTable& table, const TextRow& row) {
  if (row.cells[1] == "shift") return MoveKind::shift;
  if (row.cells[1] == "stretch") return MoveKind::stretch;
  if (row.cells[1] == "hinge") return MoveKind::hinge;
  table.fail(row, "kind '" + row.cells[1] + "' is none of shift, stretch, hinge");
}

}  // namespace

Groups read_groups(const std::string& folder, const Cage& cage) {
  Groups groups;
  groups["all"].assign(cage.size(), 1);
  std::vector<char>& surface = groups["surface"];
  surface.assign(cage.size(), 0);
  for (const CageFace& face : cage.faces)
    if (!face.is_hole)
      for (int c : face.corners) surface[at(c)] = 1;
  const TextTable table(folder + "/groups.txt", {"group", "points..."});
  for (const TextRow& row : table.rows()) {
    std::vector<char>& group = groups[row.cells[0]];
    group.resize(cage.size(), 0);
    for (const std::string& word : table.words(row, 1))
      for (int p : points_in(cage, table, row, word)) group[at(p)] = group[at(cage.mirror[at(p)])] = 1;
  }
  return groups;
}

std::vector<Follower> read_followers(const std::string& folder, const Cage& cage) {
  std::vector<Follower> followers;
  const TextTable table(folder + "/followers.txt", {"points", "leaders", "fraction"});
  for (const TextRow& row : table.rows()) {
    const auto points = points_in(cage, table, row, row.cells[0]),
               leaders = points_in(cage, table, row, row.cells[1]);
    if (points.size() != leaders.size()) table.fail(row, "there are not as many leaders as points");
    const float fraction = table.number(row, 2);
    if (!(magnitude(fraction) <= 10)) table.fail(row, "the fraction is not from -10 to 10");
    for (std::size_t k = 0; k < points.size(); ++k) {
      followers.push_back({points[k], leaders[k], fraction});
      const int mirrored = cage.mirror[at(points[k])];
      if (mirrored != points[k]) followers.push_back({mirrored, cage.mirror[at(leaders[k])], fraction});
    }
  }
  return followers;
}

std::vector<Move> read_moves(const std::string& folder, const std::string& file, const Cage& cage,
                             const Groups& groups, const std::vector<std::string>& parameters) {
  std::vector<Move> moves;
  const TextTable table(folder + "/" + file,
                        {"parameter", "kind", "where", "radius", "group", "x", "y", "z"});
  for (const TextRow& row : table.rows()) {
    if (std::find(parameters.begin(), parameters.end(), row.cells[0]) == parameters.end())
      table.fail(row, "unknown parameter '" + row.cells[0] + "'");
    const auto group = groups.find(row.cells[4]);
    if (group == groups.end()) table.fail(row, "unknown group '" + row.cells[4] + "'");
    Move move{row.cells[0],         kind_of(table, row), points_in(cage, table, row, row.cells[2]),
              table.number(row, 3), group->second,       table.vector(row, 5)};
    if (move.radius < 0) table.fail(row, "a radius is not negative");
    moves.push_back(std::move(move));
  }
  return moves;
}

std::vector<Vec3> displacement_of(const std::vector<Move>& moves, const std::string& parameter, bool sided,
                                  const Cage& cage, const std::vector<Follower>& followers) {
  std::vector<Vec3> total(cage.size());
  std::vector<Vec3> part(cage.size());
  for (const Move& move : moves) {
    if (move.parameter != parameter || move.kind == MoveKind::hinge) continue;
    for (std::size_t i = 0; i < cage.size(); ++i) part[i] = effect(move, cage, i);
    for (const Follower& f : followers)
      if (!move.group[at(f.point)]) part[at(f.point)] = f.fraction * part[at(f.leader)];
    for (std::size_t i = 0; i < cage.size(); ++i) total[i] = total[i] + part[i];
  }
  if (sided) return total;
  for (std::size_t i = 0; i < cage.size(); ++i) {
    if (!cage.is_left(static_cast<int>(i))) continue;
    const std::size_t m = at(cage.mirror[i]);
    if (m == i)
      total[i].x = 0;
    else
      total[m] = {-total[i].x, total[i].y, total[i].z};
  }
  return total;
}

std::vector<float> hinge_of(const std::vector<Move>& moves, const std::string& parameter, const Cage& cage,
                            const std::vector<Follower>& followers) {
  std::vector<float> weight(cage.size(), 0.0f);
  bool any = false;
  for (const Move& move : moves) {
    if (move.parameter != parameter || move.kind != MoveKind::hinge) continue;
    any = true;
    for (std::size_t i = 0; i < cage.size(); ++i)
      if (falloff(move, cage, i) > 0) weight[i] = weight[at(cage.mirror[i])] = move.amount.x;
  }
  if (!any) return {};
  for (const Follower& f : followers) weight[at(f.point)] = f.fraction * weight[at(f.leader)];
  return weight;
}

}  // namespace pliant::host::bake
