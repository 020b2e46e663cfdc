#include "host/bake/cage.hpp"

#include <algorithm>
#include <cstdlib>
#include <deque>
#include <map>
#include <stdexcept>

#include "host/bake/boundary_loops.hpp"
#include "host/bake/source_error.hpp"
#include "host/bake/text_table.hpp"

namespace pliant::host::bake {

namespace {

constexpr float kFarthestPointMm = 10000;

int add_point(Cage& cage, const std::string& name, Vec3 position, Vec2 uv) {
  const int i = static_cast<int>(cage.size());
  cage.index[name] = i;
  cage.names.push_back(name);
  cage.position.push_back(position);
  cage.uv.push_back(uv);
  cage.mirror.push_back(i);
  return i;
}

void read_points(Cage& cage, const std::string& folder) {
  const TextTable table(folder + "/points.txt", {"point", "x", "y", "z", "u", "v"});
  for (const TextRow& row : table.rows()) {
    const std::string& name = row.cells[0];
    const Vec3 p = table.vector(row, 1);
    const Vec2 uv{table.number(row, 4), table.number(row, 5)};
    if (name[0] == '-' || cage.index.count(name)) table.fail(row, "point '" + name + "' appears twice");
    if (p.x < 0 || uv.x < 0.5f || uv.x > 1 || uv.y < 0 || uv.y > 1 || (p.x == 0) != (uv.x == 0.5f))
      table.fail(row, "point '" + name + "' is not in the left half (x >= 0, u from 0.5 to 1)");
    const int left = add_point(cage, name, p, uv);
    if (!(length(p) <= kFarthestPointMm))
      table.fail(row, "point '" + name + "' is more than 10 m from the origin");
    if (p.x == 0) continue;
    const int right = add_point(cage, "-" + name, {-p.x, p.y, p.z}, {1 - uv.x, uv.y});
    cage.mirror[static_cast<std::size_t>(left)] = right;
    cage.mirror[static_cast<std::size_t>(right)] = left;
  }
}

/// A name or a range.
std::vector<int> points_of_word(const Cage& cage, const std::string& word) {
  const auto find = [&cage](const std::string& name) {
    const auto found = cage.index.find(name);
    if (found != cage.index.end()) return found->second;
    // A point in the middle is its own mirror image.
    const auto middle = name[0] == '-' ? cage.index.find(name.substr(1)) : cage.index.end();
    if (middle == cage.index.end()) throw std::invalid_argument("unknown point '" + name + "'");
    return middle->second;
  };
  const std::size_t dot = word.rfind('.'), dash = dot == std::string::npos ? dot : word.find('-', dot);
  if (dash == std::string::npos) return {find(word)};
  const std::string stem = word.substr(0, dot + 1);
  char* end = nullptr;
  const long first = std::strtol(word.c_str() + dot + 1, &end, 10);
  const bool has_first = end == word.c_str() + dash;
  const long last = std::strtol(word.c_str() + dash + 1, &end, 10);
  if (!has_first || *end != 0 || end == word.c_str() + dash + 1 || first < 0 || last < 0 || first > 999 ||
      last > 999)
    throw std::invalid_argument("'" + word + "' is not a range of points");
  std::vector<int> points;
  for (long k = first;; k += first <= last ? 1 : -1) {
    points.push_back(find(stem + std::to_string(k)));
    if (k == last) break;
  }
  return points;
}

std::vector<int> row_points(const Cage& cage, const TextTable& table, const TextRow& row, std::size_t first) {
  std::vector<int> points;
  for (const std::string& word : table.words(row, first)) {
    try {
      for (int p : points_of(cage, word)) points.push_back(p);
    } catch (const std::invalid_argument& error) {
      table.fail(row, error.what());
    }
  }
  return points;
}

void add_face(Cage& cage, std::vector<int> corners, bool is_hole, const std::string& patch) {
  std::vector<int> mirrored;
  for (int c : corners) mirrored.push_back(cage.mirror[static_cast<std::size_t>(c)]);
  cage.faces.push_back({std::move(corners), is_hole, patch});
  cage.faces.push_back({std::move(mirrored), is_hole, patch});
}

/// Adds the quads between two consecutive rows of a patch; a triangle where two corners are the same point.
void add_strip(Cage& cage, const std::vector<int>& a, const std::vector<int>& b, bool is_hole,
               const std::string& patch) {
  for (std::size_t i = 0; i + 1 < a.size(); ++i) {
    std::vector<int> corners;
    for (int c : {a[i], a[i + 1], b[i + 1], b[i]})
      if (corners.empty() || (corners.back() != c && corners.front() != c)) corners.push_back(c);
    add_face(cage, corners, is_hole, patch);
  }
}

void read_patches(Cage& cage, const std::string& folder) {
  const TextTable table(folder + "/patches.txt", {"patch", "part", "points..."});
  std::vector<int> above;
  std::string patch;
  for (const TextRow& row : table.rows()) {
    const std::string& part = row.cells[1];
    if (part != "surface" && part != "hole")
      table.fail(row, "part '" + part + "' is neither surface nor hole");
    std::vector<int> points = row_points(cage, table, row, 2);
    if (row.cells[0] == patch) {
      if (points.size() != above.size())
        table.fail(row, "this row of patch '" + patch + "' is not as long as the last");
      add_strip(cage, above, points, part == "hole", patch);
    }
    patch = row.cells[0];
    above = std::move(points);
  }
}

void check_uses(const Cage& cage, const std::string& file) {
  std::vector<char> is_used(cage.size(), 0);
  for (const CageFace& face : cage.faces)
    for (const int c : face.corners) is_used[static_cast<std::size_t>(c)] = 1;
  for (std::size_t i = 0; i < is_used.size(); ++i)
    if (!is_used[i]) throw SourceError(file, 0, "point '" + cage.names[i] + "' belongs to no patch");
}

/// A face beside another one. flips: one of the two has to be reversed, so that both are wound alike.
struct Neighbour {
  std::size_t face;
  bool flips;
};

/// Of each face, those with which it shares an edge.
std::vector<std::vector<Neighbour>> neighbours_of(const Cage& cage, const std::string& file) {
  std::map<std::pair<int, int>, std::vector<std::pair<std::size_t, bool>>> edges;
  for (std::size_t f = 0; f < cage.faces.size(); ++f) {
    const auto& c = cage.faces[f].corners;
    for (std::size_t k = 0; k < c.size(); ++k) {
      const int a = c[k], b = c[(k + 1) % c.size()];
      auto& sides = edges[{std::min(a, b), std::max(a, b)}];
      sides.push_back({f, a < b});
      if (sides.size() > 2)
        throw SourceError(file, 0,
                          "more than two faces share the edge " + cage.names[static_cast<std::size_t>(a)] +
                              " " + cage.names[static_cast<std::size_t>(b)]);
    }
  }
  std::vector<std::vector<Neighbour>> neighbours(cage.faces.size());
  for (const auto& [edge, sides] : edges) {
    if (sides.size() < 2) continue;
    const bool flips = sides[0].second == sides[1].second;
    neighbours[sides[0].first].push_back({sides[1].first, flips});
    neighbours[sides[1].first].push_back({sides[0].first, flips});
  }
  return neighbours;
}

void reverse(CageFace& face) {
  face.corners = {face.corners.rbegin(), face.corners.rend()};
}

/// Winds all faces like the first one.
void wind_alike(Cage& cage, const std::string& file) {
  const auto neighbours = neighbours_of(cage, file);
  std::vector<int> turn(cage.faces.size(), 0);  // 1: keep, -1: reverse, 0: not reached
  turn[0] = 1;
  std::deque<std::size_t> open{0};
  while (!open.empty()) {
    const std::size_t f = open.front();
    open.pop_front();
    for (const auto& [g, flips] : neighbours[f]) {
      const int wanted = flips ? -turn[f] : turn[f];
      if (turn[g] == 0) {
        turn[g] = wanted;
        open.push_back(g);
      } else if (turn[g] != wanted) {
        throw SourceError(file, 0, "the patches have no consistent winding");
      }
    }
  }
  for (std::size_t f = 0; f < cage.faces.size(); ++f) {
    if (turn[f] == 0) throw SourceError(file, 0, "the patches are not connected");
    if (turn[f] < 0) reverse(cage.faces[f]);
  }
}

/// Winds all faces alike, and so that seen from outside u points right and v points down.
void wind_faces(Cage& cage, const std::string& file) {
  wind_alike(cage, file);
  // Twice the area over (u,v). Counter-clockwise seen from outside is negative, as v points down.
  double area = 0;
  for (const CageFace& face : cage.faces) area += doubled_loop_area(cage.uv, face.corners);
  if (area > 0)
    for (CageFace& face : cage.faces) reverse(face);
}

}  // namespace

std::vector<int> points_of(const Cage& cage, const std::string& words) {
  std::vector<int> points;
  for (std::size_t first = 0; first <= words.size();) {
    const std::size_t comma = std::min(words.find(',', first), words.size());
    for (int p : points_of_word(cage, words.substr(first, comma - first))) points.push_back(p);
    first = comma + 1;
  }
  return points;
}

Cage read_cage(const std::string& folder) {
  Cage cage;
  read_points(cage, folder);
  read_patches(cage, folder);
  if (cage.faces.empty()) throw SourceError(folder + "/patches.txt", 0, "joins no points");
  check_uses(cage, folder + "/points.txt");
  wind_faces(cage, folder + "/patches.txt");
  return cage;
}

}  // namespace pliant::host::bake
