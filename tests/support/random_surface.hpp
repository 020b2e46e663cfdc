#pragma once
// Random meshes over a chart as OBJ files: grids, discs, annuli, meshes with holes, closed surfaces with a cut, islands; and
// the same with one defect.
#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "host/bake/triangulation.hpp"
#include "pliant/geometry.hpp"
#include "random.hpp"

/// A mesh as an OBJ file has it: u to the right, v upwards, corners counter-clockwise in the chart.
struct RandomSurface {
  std::string kind;
  std::vector<pliant::Vec3> position;
  std::vector<pliant::Vec2> uv;                                             // one for each position
  std::vector<std::vector<int>> faces;                                      // polygons
  std::string defect;                                                       // empty: none
  static constexpr const char* kPerhaps = "a vertex moved over the chart";  // which may leave it a surface
  std::string extra;                                                        // further lines of the file

  std::string obj() const {
    std::string text = "# a random surface\nmtllib none.mtl\n";
    char line[160];
    for (const pliant::Vec3 p : position) {
      std::snprintf(line, sizeof line, "v %.9g %.9g %.9g\n", static_cast<double>(p.x),
                    static_cast<double>(p.y), static_cast<double>(p.z));
      text += line;
    }
    for (const pliant::Vec2 t : uv) {
      std::snprintf(line, sizeof line, "vt %.9g %.9g\n", static_cast<double>(t.x), static_cast<double>(t.y));
      text += line;
    }
    for (std::size_t f = 0; f < faces.size(); ++f) {
      if (f % 50 == 0) text += "g part" + std::to_string(f) + "\nusemtl paint" + std::to_string(f % 3) + "\n";
      text += "f";
      for (const int v : faces[f]) text += " " + std::to_string(v + 1) + "/" + std::to_string(v + 1);
      text += "\n";
    }
    return text + extra;
  }

  /// Vertices minus edges plus faces, of the faces' vertices.
  int euler() const {
    std::map<std::pair<int, int>, int> edges;
    std::map<int, int> vertices;
    for (const auto& f : faces)
      for (std::size_t k = 0; k < f.size(); ++k) {
        ++edges[std::minmax(f[k], f[(k + 1) % f.size()])];
        ++vertices[f[k]];
      }
    return static_cast<int>(vertices.size()) - static_cast<int>(edges.size()) +
           static_cast<int>(faces.size());
  }

  /// True if faces meet in a vertex without sharing an edge there.
  bool has_pinch() const {
    std::map<int, int> balance;  // boundary edges that leave a vertex
    std::map<std::pair<int, int>, int> directed;
    for (const auto& f : faces)
      for (std::size_t k = 0; k < f.size(); ++k) ++directed[{f[k], f[(k + 1) % f.size()]}];
    for (const auto& [e, count] : directed)
      if (directed.count({e.second, e.first}) == 0 && ++balance[e.first] > 1) return true;
    return false;
  }

  double chart_area() const {
    double sum = 0;
    for (const auto& f : faces)
      for (std::size_t k = 0; k < f.size(); ++k) {
        const pliant::Vec2 a = uv[static_cast<std::size_t>(f[k])],
                           b = uv[static_cast<std::size_t>(f[(k + 1) % f.size()])];
        sum += 0.5 * (static_cast<double>(a.x) * static_cast<double>(b.y) -
                      static_cast<double>(a.y) * static_cast<double>(b.x));
      }
    return sum;
  }

  float diagonal() const {
    pliant::Vec3 low = position[0], high = low;
    for (const auto& f : faces)
      for (const int v : f) {
        const pliant::Vec3 p = position[static_cast<std::size_t>(v)];
        low = min(low, p);
        high = max(high, p);
      }
    return length(high - low);
  }
};

class SurfaceMaker {
 public:
  explicit SurfaceMaker(std::uint64_t seed) : random_(seed) {}

  /// One surface in five has a defect.
  RandomSurface make() {
    RandomSurface s;
    const int kind = random_.below(7);
    if (kind == 0) grid(s, {0, 0}, {1, 1});
    if (kind == 1) rings(s, true);
    if (kind == 2) rings(s, false);
    if (kind == 3) punched(s);
    if (kind == 4) delaunay(s);
    if (kind == 5) closed(s);
    if (kind == 6) islands(s);
    if (kind != 5) bend(s);
    if (random_.below(3) == 0) inset(s);
    if (s.has_pinch()) s.defect = "pinch";
    if (random_.below(5) == 0) spoil(s);
    return s;
  }

 private:
  static constexpr float kPi = 3.14159265f;
  using Vec2 = pliant::Vec2;
  using Vec3 = pliant::Vec3;

  int add(RandomSurface& s, Vec2 uv) {
    s.uv.push_back(uv);
    s.position.push_back({uv.x, uv.y, 0});
    return static_cast<int>(s.uv.size()) - 1;
  }

  void add_cell(RandomSurface& s, int a, int b, int c, int d) {
    switch (random_.below(3)) {
      case 0:
        s.faces.push_back({a, b, c, d});
        break;
      case 1:
        s.faces.push_back({a, b, c}), s.faces.push_back({a, c, d});
        break;
      default:
        s.faces.push_back({a, b, d}), s.faces.push_back({b, c, d});
    }
  }

  void grid(RandomSurface& s, Vec2 low, Vec2 high) {
    if (s.kind.empty()) s.kind = "grid";
    const int n = 1 + random_.below(40), m = 1 + random_.below(40), first = static_cast<int>(s.uv.size());
    const float jitter = random_.below(2) == 0 ? 0 : 0.22f;
    for (int j = 0; j <= m; ++j)
      for (int i = 0; i <= n; ++i) {
        const bool rim = i == 0 || j == 0 || i == n || j == m;
        const float x = (static_cast<float>(i) + (rim ? 0 : random_.uniform(-jitter, jitter))) /
                        static_cast<float>(n),
                    y = (static_cast<float>(j) + (rim ? 0 : random_.uniform(-jitter, jitter))) /
                        static_cast<float>(m);
        add(s, {low.x + x * (high.x - low.x), low.y + y * (high.y - low.y)});
      }
    for (int j = 0; j < m; ++j)
      for (int i = 0; i < n; ++i) {
        const int a = first + j * (n + 1) + i;
        add_cell(s, a, a + 1, a + n + 2, a + n + 1);
      }
  }

  void rings(RandomSurface& s, bool is_disc) {
    s.kind = is_disc ? "disc" : "annulus";
    const int n = 3 + random_.below(60), m = 1 + random_.below(20);
    const float inner = is_disc ? 0 : random_.uniform(0.01f, 0.45f), wobble = random_.uniform(0, 0.2f);
    const int waves = 1 + random_.below(5);
    const auto at = [&](int ring, int k) {
      const float a = 2 * kPi * static_cast<float>(k) / static_cast<float>(n);
      const float r = (inner + (0.5f - inner) * static_cast<float>(ring) / static_cast<float>(m)) *
                      (1 - wobble * (0.5f + 0.5f * std::sin(static_cast<float>(waves) * a)));
      return Vec2{0.5f + r * std::cos(a), 0.5f + r * std::sin(a)};
    };
    const int centre = is_disc ? add(s, {0.5f, 0.5f}) : -1;
    const int first_ring = is_disc ? 1 : 0, first = static_cast<int>(s.uv.size());
    for (int ring = first_ring; ring <= m; ++ring)
      for (int k = 0; k < n; ++k) add(s, at(ring, k));
    for (int k = 0; k < n && is_disc; ++k) s.faces.push_back({centre, first + k, first + (k + 1) % n});
    for (int ring = first_ring; ring < m; ++ring)
      for (int k = 0; k < n; ++k) {
        const int row = first + (ring - first_ring) * n, l = (k + 1) % n;
        add_cell(s, row + k, row + n + k, row + n + l, row + l);
      }
  }

  /// A grid without some of its cells: single ones, rectangles or strips.
  void punched(RandomSurface& s) {
    s.kind = "holes";
    const int n = 4 + random_.below(40), m = 4 + random_.below(40);
    std::vector<char> gone(static_cast<std::size_t>(n * m), 0);
    for (int hole = 1 + random_.below(12); hole > 0; --hole) {
      const int w = 1 + random_.below(1 + n / 3), h = 1 + random_.below(1 + m / 3), x = random_.below(n - 1),
                y = random_.below(m - 1);
      for (int j = y; j < std::min(m, y + h); ++j)
        for (int i = x; i < std::min(n, x + w); ++i) gone[static_cast<std::size_t>(j * n + i)] = 1;
    }
    gone[static_cast<std::size_t>(random_.below(n * m))] = 0;  // something is left
    std::map<std::pair<int, int>, int> ids;
    const auto vertex = [&](int i, int j) {
      const auto [entry, fresh] = ids.insert({{i, j}, static_cast<int>(s.uv.size())});
      if (fresh)
        add(s,
            {static_cast<float>(i) / static_cast<float>(n), static_cast<float>(j) / static_cast<float>(m)});
      return entry->second;
    };
    for (int j = 0; j < m; ++j)
      for (int i = 0; i < n; ++i)
        if (!gone[static_cast<std::size_t>(j * n + i)]) {
          const int a = vertex(i, j), b = vertex(i + 1, j), c = vertex(i + 1, j + 1), d = vertex(i, j + 1);
          add_cell(s, a, b, c, d);
        }
  }

  /// Random points between a star-shaped outline and star-shaped holes.
  void delaunay(RandomSurface& s) {
    s.kind = "delaunay";
    pliant::host::bake::Domain domain;
    const auto star = [&](Vec2 centre, float radius, float rough) {
      std::vector<int> loop;
      const int n = 5 + random_.below(40);
      for (int k = 0; k < n; ++k) {
        const float a = 2 * kPi * static_cast<float>(k) / static_cast<float>(n),
                    r = radius * random_.uniform(1 - rough, 1);
        loop.push_back(static_cast<int>(domain.points.size()));
        domain.points.push_back({centre.x + r * std::cos(a), centre.y + r * std::sin(a)});
      }
      domain.loops.push_back(loop);
    };
    star({0.5f, 0.5f}, 0.5f, 0.3f);
    for (int k = 0; k < 4; ++k)
      if (random_.below(2) == 0)
        star({0.4f + 0.2f * static_cast<float>(k % 2), 0.4f + 0.2f * static_cast<float>(k / 2)},
             random_.uniform(0.005f, 0.09f), 0.6f);
    for (int k = random_.below(300); k > 0; --k) {
      const float a = random_.uniform(0, 2 * kPi), r = 0.34f * std::sqrt(random_.uniform(0, 1));
      const Vec2 p{0.5f + r * std::cos(a), 0.5f + r * std::sin(a)};
      bool is_free = true;
      for (std::size_t l = 1; l < domain.loops.size(); ++l)
        for (const int v : domain.loops[l])
          is_free &= length(p - domain.points[static_cast<std::size_t>(v)]) > 0.01f;
      if (is_free) domain.points.push_back(p);
    }
    std::map<int, int> ids;
    for (const auto& t : pliant::host::bake::triangulate(domain)) {
      std::vector<int> face;
      for (const int v : t) {
        const auto [entry, fresh] = ids.insert({v, static_cast<int>(s.uv.size())});
        if (fresh) add(s, domain.points[static_cast<std::size_t>(v)]);
        face.push_back(entry->second);
      }
      s.faces.push_back(face);
    }
  }

  /// Sphere, torus or tube with the seams that its chart needs: all are a rectangle in the chart, a sphere a saw-toothed one.
  void closed(RandomSurface& s) {
    const int which = random_.below(3);
    s.kind = which == 0 ? "sphere" : which == 1 ? "torus" : "tube";
    const int n = 6 + random_.below(40), m = 4 + random_.below(30);
    const float r = std::pow(10.0f, random_.uniform(-1, 3)), thin = random_.uniform(0.1f, 0.6f);
    const auto at = [&](float x, float y) -> Vec3 {
      const float a = 2 * kPi * x, b = kPi * y;
      if (which == 0)
        return {r * std::sin(b) * std::cos(a), -r * std::cos(b), -r * std::sin(b) * std::sin(a)};
      if (which == 1) {
        const float q = r * (1 + thin * std::cos(2 * b));
        return {q * std::cos(a), r * thin * std::sin(2 * b), -q * std::sin(a)};
      }
      return {r * std::cos(a), 3 * r * y, -r * std::sin(a)};
    };
    const auto vertex = [&](float i, int j) {
      const Vec2 uv{i / static_cast<float>(n), static_cast<float>(j) / static_cast<float>(m)};
      s.uv.push_back(uv);
      s.position.push_back(at(uv.x, uv.y));
      return static_cast<int>(s.uv.size()) - 1;
    };
    std::map<std::pair<int, int>, int> ids;
    const auto shared = [&](int i, int j) {
      const auto [entry, fresh] = ids.insert({{i, j}, 0});
      if (fresh) entry->second = vertex(static_cast<float>(i), j);
      return entry->second;
    };
    for (int j = 0; j < m; ++j)
      for (int i = 0; i < n; ++i) {
        const bool south = which == 0 && j == 0, north = which == 0 && j + 1 == m;
        const int a = south ? vertex(static_cast<float>(i) + 0.5f, 0) : shared(i, j),
                  b = south ? a : shared(i + 1, j),
                  d = north ? vertex(static_cast<float>(i) + 0.5f, m) : shared(i, j + 1),
                  c = north ? d : shared(i + 1, j + 1);
        if (south)
          s.faces.push_back({a, c, d});
        else if (north)
          s.faces.push_back({a, b, d});
        else
          add_cell(s, a, b, c, d);
      }
  }

  void islands(RandomSurface& s) {
    s.kind = "islands";
    const int n = 1 + random_.below(3), m = 1 + random_.below(2);
    const float gap = random_.uniform(0.01f, 0.15f);
    for (int j = 0; j < m; ++j)
      for (int i = 0; i < n; ++i) {
        const float w = 1 / static_cast<float>(n), h = 1 / static_cast<float>(m);
        const Vec2 low{static_cast<float>(i) * w, static_cast<float>(j) * h};
        grid(s, low, low + Vec2{w * (i + 1 < n ? 1 - gap : 1), h * (j + 1 < m ? 1 - gap : 1)});
      }
  }

  /// Scales the sheet and lifts it by two waves.
  void bend(RandomSurface& s) {
    const float width = std::pow(10.0f, random_.uniform(-1, 4)),
                aspect = std::pow(10.0f, random_.uniform(-0.7f, 0.7f)),
                lift = random_.below(3) == 0 ? 0 : width * random_.uniform(0, 0.2f);
    const float a = random_.uniform(0, 5), b = random_.uniform(0, 5), c = random_.uniform(0, 6),
                d = random_.uniform(0, 6);
    for (std::size_t k = 0; k < s.uv.size(); ++k)
      s.position[k] = {width * s.uv[k].x, width * aspect * s.uv[k].y,
                       lift * std::sin(a * s.uv[k].x + c) * std::cos(b * s.uv[k].y + d)};
  }

  void inset(RandomSurface& s) {
    const Vec2 low{random_.uniform(0, 0.3f), random_.uniform(0, 0.3f)};
    const Vec2 size{random_.uniform(0.3f, 0.7f), random_.uniform(0.3f, 0.7f)};
    for (Vec2& p : s.uv) p = {low.x + size.x * p.x, low.y + size.y * p.y};
  }

  std::size_t any_face(const RandomSurface& s) {
    return static_cast<std::size_t>(random_.below(static_cast<int>(s.faces.size())));
  }

  /// Adds a second copy, which has the same place in the chart.
  static void add_copy(RandomSurface& s) {
    const int n = static_cast<int>(s.uv.size());
    const auto uv = s.uv;
    const auto position = s.position;
    const auto faces = s.faces;
    s.uv.insert(s.uv.end(), uv.begin(), uv.end());
    for (const Vec3 p : position) s.position.push_back(p + Vec3{0, 0, 5});
    for (auto copy : faces) {
      for (int& w : copy) w += n;
      s.faces.push_back(copy);
    }
  }

  /// Adds lines to the file that are wrong, or isolated vertices, which are no defect. \return false for other kinds.
  static bool spoil_lines(RandomSurface& s, int kind) {
    static constexpr struct {
      int kind;
      const char *defect, *lines;
    } kLines[] = {{4, "", "v 1e9 -1e9 0\nv 0 0 0\n"}, {5, "not a number", "v nan 0 0\n"},
                  {8, "no u,v", "f 1 2 3\n"},         {9, "index", "f 1/1 2/2 9999999/1\n"},
                  {14, "infinite", "v 1e99 0 0\n"},   {15, "half a line", "f 1/1 2"}};
    for (const auto& l : kLines)
      if (l.kind == kind) {
        s.defect = l.defect, s.extra = l.lines;
        return true;
      }
    return false;
  }

  /// Moves vertices. \return false for other kinds.
  static bool spoil_vertices(RandomSurface& s, int kind, std::size_t v) {
    switch (kind) {
      case 0:
        s.defect = RandomSurface::kPerhaps, s.uv[v] = {1 - s.uv[v].x, 1 - s.uv[v].y};
        return true;
      case 6:
        s.defect = "far away", s.position[v].x = 1e9f;
        return true;
      case 7:
        s.defect = "u outside", s.uv[v].x = 1.5f;
        return true;
      case 11:
        s.defect = "all u,v alike";
        for (Vec2& p : s.uv) p = {0.5f, 0.5f};
        return true;
      case 12:
        s.defect = "u,v on a line";
        for (Vec2& p : s.uv) p.y = 0.5f;
        return true;
      default:
        return false;
    }
  }

  static void spoil_faces(RandomSurface& s, int kind, std::vector<int>& face) {
    switch (kind) {
      case 1:
        s.defect = "a face given twice", s.faces.push_back(face);
        break;
      case 2:
        s.defect = "a face turned over", std::swap(face[0], face[1]);
        break;
      case 3:
        s.defect = "a third face at an edge", s.position.push_back({0, 0, 1}), s.uv.push_back({0.5f, 0.5f});
        s.faces.push_back({face[0], face[1], static_cast<int>(s.uv.size()) - 1});
        break;
      case 10:
        s.defect = "a corner twice", face[1] = face[0];
        break;
      default:
        s.defect = "a part upon another", add_copy(s);
        break;
    }
  }

  void spoil(RandomSurface& s) {
    std::vector<int>& face = s.faces[any_face(s)];
    const int kind = random_.below(16);
    if (!spoil_lines(s, kind) && !spoil_vertices(s, kind, static_cast<std::size_t>(face[0])))
      spoil_faces(s, kind, face);
  }

  Random random_;
};
