// klt_bench DATA [SEQUENCE...]: corner selection and patch tracking, timed and measured against known
// motions.
//
// DATA holds, for SIZE 320x240 and 640x480, A_SIZE.pgm, B_CASE_SIZE.pgm, points_SIZE_N.csv (x,y) and
// truth.csv: size,case,m00,m01,m10,m11,tx,ty,gain,bias,noise,occluder with a point x of A at c + M (x - c) +
// t in B, c the middle of the picture. A SEQUENCE is a folder 00001.pgm ... with motion.csv:
// frame,a,b,c,d,tx,ty, a point (x,y) of the first frame at (a x + b y + tx, c x + d y + ty). Prints
// topic,peer,variant,metric,value.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "frames/pnm.hpp"
#include "pliant/corners.hpp"
#include "pliant/patch.hpp"

using namespace pliant;

namespace {

using Row = std::vector<double>;

void print(const std::string& variant, const char* metric, double value) {
  std::printf("klt,pliant,%s,%s,%.6g\n", variant.c_str(), metric, value);
  std::fflush(stdout);
}

double quantile(std::vector<double> v, double q) {
  if (v.empty()) return std::nan("");
  std::sort(v.begin(), v.end());
  const double at = q * static_cast<double>(v.size() - 1);
  const auto i = static_cast<std::size_t>(at);
  const double f = at - static_cast<double>(i);
  return v[i] * (1 - f) + v[std::min(i + 1, v.size() - 1)] * f;
}

// Median time of a call, of at least `runs` calls and 0.4 s.
template <class F>
double microseconds(F&& call, int runs) {
  using Clock = std::chrono::steady_clock;
  const auto since = [](Clock::time_point t) {
    return std::chrono::duration<double, std::micro>(Clock::now() - t).count();
  };
  for (int i = 0; i < 3; ++i) call();
  std::vector<double> times;
  const auto start = Clock::now();
  while (static_cast<int>(times.size()) < runs || since(start) < 4e5) {
    const auto t = Clock::now();
    call();
    times.push_back(since(t));
  }
  return quantile(times, 0.5);
}

LumaPicture read_picture(const std::string& path) {
  LumaPicture p;
  std::string message;
  if (read_pnm(path, p, message) != Status::ok) {
    std::fprintf(stderr, "%s\n", message.c_str());
    std::exit(1);
  }
  return p;
}

FrameView view_of(const LumaPicture& p) {
  FrameView f;
  f.data = p.pixels.data();
  f.width = p.width;
  f.height = p.height;
  f.stride_bytes = static_cast<std::size_t>(p.width);
  return f;
}

// A file of numbers; `key`, if asked for, is how many leading columns are text, joined by a comma.
std::map<std::string, Row> read_table(const std::string& path, int text_columns) {
  std::map<std::string, Row> table;
  std::ifstream file(path);
  int number = 0;
  for (std::string line; std::getline(file, line);) {
    std::stringstream cells(line);
    std::string key = text_columns == 0 ? std::to_string(1000000 + number++) : "", cell;
    for (int k = 0; k < text_columns && std::getline(cells, cell, ','); ++k) key += (k > 0 ? "," : "") + cell;
    Row row;
    while (std::getline(cells, cell, ',')) row.push_back(std::atof(cell.c_str()));
    table[key] = row;
  }
  return table;
}

// x -> (a x + b y + tx, c x + d y + ty).
struct Affinity {
  double a = 1, b = 0, c = 0, d = 1, tx = 0, ty = 0;
  Vec2 operator()(Vec2 p) const {
    return {static_cast<float>(a * double(p.x) + b * double(p.y) + tx),
            static_cast<float>(c * double(p.x) + d * double(p.y) + ty)};
  }
  Mat2 matrix() const {
    return {static_cast<float>(a), static_cast<float>(b), static_cast<float>(c), static_cast<float>(d)};
  }
};

Affinity about_middle(const Row& m, int width, int height) {
  const double cx = 0.5 * (width - 1), cy = 0.5 * (height - 1);
  return {m[0], m[1], m[2], m[3], cx + m[4] - m[0] * cx - m[1] * cy, cy + m[5] - m[2] * cx - m[3] * cy};
}

struct Outcome {
  std::vector<double> errors;
  int tried = 0, lost = 0, wrong = 0, hidden = 0, hidden_kept = 0;

  void add(bool is_kept, Vec2 found, Vec2 truth) {
    ++tried;
    if (!is_kept) {
      ++lost;
      return;
    }
    const double e = double(length(found - truth));
    errors.push_back(e);
    wrong += e > 1;
  }
  void print_as(const std::string& variant) const {
    print(variant, "points", tried);
    print(variant, "err_median_px", quantile(errors, 0.5));
    print(variant, "err_p95_px", quantile(errors, 0.95));
    print(variant, "lost_fraction", double(lost) / tried);
    print(variant, "kept_but_over_1px_fraction", double(wrong) / tried);
    if (hidden > 0) print(variant, "hidden_but_kept_fraction", double(hidden_kept) / hidden);
  }
};

// Two pyramids and a tracker.
struct Rig {
  std::vector<std::uint8_t> block = std::vector<std::uint8_t>(std::size_t{1} << 25);
  Arena arena{block.data(), block.size()};
  Pyramid before, after;
  PatchTracker tracker;

  Rig(int width, int height, int window, int slots) {
    const PyramidLimits limits{width, height, 3, true};
    if (before.create(arena, limits) != Status::ok || after.create(arena, limits) != Status::ok ||
        tracker.create(arena, {slots, window, 3, 5}) != Status::ok)
      std::exit(1);
  }
};

PatchOptions strict() {
  PatchOptions o;
  o.min_correlation = 0.9f;
  return o;
}

bool is_within(Vec2 p, double x0, double y0, double x1, double y1) {
  return double(p.x) >= x0 && double(p.y) >= y0 && double(p.x) < x1 && double(p.y) < y1;
}

// One case: from where the points were; or, predicted, from where the affinity says, with its warp.
Outcome run_case(Rig& rig, const std::vector<Vec2>& points, const Affinity& motion, bool is_occluded,
                 bool is_predicted) {
  constexpr double kMargin = 16;
  const double w = rig.before.level(0).width, h = rig.before.level(0).height;
  Outcome o;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec2 x = points[i], truth = motion(x);
    if (!is_within(x, kMargin, kMargin, w - kMargin, h - kMargin) ||
        !is_within(truth, kMargin, kMargin, w - kMargin, h - kMargin))
      continue;
    const PatchResult r =
        is_predicted ? rig.tracker.track(static_cast<int>(i), rig.after, truth, motion.matrix(), strict())
                     : rig.tracker.track_between(rig.before, x, rig.after, x, strict());
    const bool is_kept = r.status == PatchStatus::ok;
    const double x0 = 0.3 * w, y0 = 0.25 * h, x1 = 0.6 * w, y1 = 0.75 * h;
    if (is_occluded && is_within(truth, x0, y0, x1, y1)) {
      ++o.hidden;
      o.hidden_kept += is_kept;
      continue;
    }
    if (is_occluded && is_within(truth, x0 - kMargin, y0 - kMargin, x1 + kMargin, y1 + kMargin)) continue;
    o.add(is_kept, r.x, truth);
  }
  return o;
}

void bench_cases(const std::string& data, const std::string& size, const std::vector<Vec2>& points,
                 int window, Rig& rig) {
  for (std::size_t i = 0; i < points.size(); ++i)
    (void)rig.tracker.capture(static_cast<int>(i), rig.before, points[i]);
  for (const auto& [key, m] : read_table(data + "/truth.csv", 2)) {
    if (key.compare(0, size.size() + 1, size + ",") != 0) continue;
    const std::string name = key.substr(size.size() + 1);
    const LumaPicture b = read_picture(data + "/B_" + name + "_" + size + ".pgm");
    (void)rig.after.build(view_of(b));
    const Affinity motion = about_middle(m, b.width, b.height);
    const std::string v =
        size + "_win" + std::to_string(window) + "_lev3_n" + std::to_string(points.size()) + "_" + name;
    run_case(rig, points, motion, m[9] != 0, false).print_as(v);
    run_case(rig, points, motion, m[9] != 0, true).print_as(v + "_predicted");
  }
}

void bench_selection(const LumaPicture& a, const std::string& size, int count) {
  CornerOptions o;
  o.min_score = 0;
  o.min_ratio = 0;
  o.quality = 0.001f;
  o.min_distance_px = count < 2000 ? 7.0f : a.width == 320 ? 3.0f : 5.0f;
  o.cell_px = count < 2000 ? 4 : 2;
  std::vector<std::uint8_t> block(corner_scratch_bytes(a.width, a.height, o));
  Arena scratch(block.data(), block.size());
  std::vector<Corner> corners(static_cast<std::size_t>(count));
  const ImageView image{a.pixels.data(), a.width, a.height, a.width};
  int found = 0;
  const double t = microseconds(
      [&] {
        (void)find_corners(image, o, {}, scratch, {corners.data(), corners.size()}, found);
      },
      15);
  const std::string v = "select_" + size + "_n" + std::to_string(count) + "_mindist" +
                        std::to_string(static_cast<int>(o.min_distance_px));
  print(v, "us_per_frame", t);
  print(v, "points", found);
}

void bench_size(const std::string& data, const std::string& size) {
  const LumaPicture a = read_picture(data + "/A_" + size + ".pgm");
  const LumaPicture b = read_picture(data + "/B_affine_noise_" + size + ".pgm");
  for (const int n : {100, 500, 2000}) {
    bench_selection(a, size, n);
    std::vector<Vec2> points;
    for (const auto& entry : read_table(data + "/points_" + size + "_" + std::to_string(n) + ".csv", 0))
      points.push_back({static_cast<float>(entry.second[0]), static_cast<float>(entry.second[1])});
    for (const int window : {15, 21}) {
      Rig rig(a.width, a.height, window, static_cast<int>(points.size()));
      const double tp = microseconds([&] { (void)rig.before.build(view_of(a)); }, 51);
      (void)rig.after.build(view_of(b));
      const std::string w = "_win" + std::to_string(window) + "_lev3";
      if (n == 100) print("pyramid_" + size + w, "us_per_frame", tp);
      const PatchOptions o = strict();
      const double tt = microseconds(
          [&] {
            for (const Vec2 x : points) (void)rig.tracker.track_between(rig.before, x, rig.after, x, o);
          },
          31);
      const std::string v = "track_" + size + w + "_n" + std::to_string(points.size());
      print(v, "us_per_frame", tt);
      print(v, "us_per_point", tt / static_cast<double>(points.size()));
      if (n == 500) bench_cases(data, size, points, window, rig);
    }
  }
}

// The similarity that takes `from` to `to` in the least-squares sense, where `counts` says so.
Affinity similarity(const std::vector<Vec2>& from, const std::vector<Vec2>& to,
                    const std::vector<bool>& counts) {
  double n = 0, fx = 0, fy = 0, gx = 0, gy = 0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    if (!counts[i]) continue;
    n += 1, fx += double(from[i].x), fy += double(from[i].y), gx += double(to[i].x), gy += double(to[i].y);
  }
  if (n < 3) return {};
  fx /= n, fy /= n, gx /= n, gy /= n;
  double square = 0, along = 0, across = 0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    if (!counts[i]) continue;
    const double x = double(from[i].x) - fx, y = double(from[i].y) - fy, u = double(to[i].x) - gx,
                 v = double(to[i].y) - gy;
    square += x * x + y * y, along += x * u + y * v, across += x * v - y * u;
  }
  const double a = along / square, b = across / square;
  return {a, -b, b, a, gx - a * fx + b * fy, gy - b * fx - a * fy};
}

std::vector<Vec2> middle_corners(const Rig& rig, std::size_t most) {
  const ImageView& image = rig.before.level(0);
  CornerOptions o;
  o.min_distance_px = 5;
  o.cell_px = 4;
  std::vector<std::uint8_t> block(corner_scratch_bytes(image.width, image.height, o)), allowed;
  const int cells_x = corner_cells(image.width, o.cell_px), cells_y = corner_cells(image.height, o.cell_px);
  for (int y = 0; y < cells_y; ++y)
    for (int x = 0; x < cells_x; ++x)
      allowed.push_back(4 * x >= cells_x && 4 * x < 3 * cells_x && 6 * y >= cells_y && 6 * y < 5 * cells_y);
  Arena scratch(block.data(), block.size());
  std::vector<Corner> corners(most);
  int count = 0;
  (void)find_corners(image, o, {allowed.data(), allowed.size()}, scratch, {corners.data(), most}, count);
  std::vector<Vec2> points;
  for (int i = 0; i < count; ++i) points.push_back(corners[static_cast<std::size_t>(i)].x);
  return points;
}

// Anchors of the first frame, followed by their own motion: each frame's similarity is the prediction of the
// next.
void bench_drift(const std::string& folder, int window) {
  const auto motions = read_table(folder + "/motion.csv", 1);
  const auto path = [&](int k) {
    char name[32];
    std::snprintf(name, sizeof name, "/%05d.pgm", k);
    return folder + name;
  };
  const LumaPicture first = read_picture(path(1));
  Rig rig(first.width, first.height, window, 200);
  (void)rig.before.build(view_of(first));
  std::vector<Vec2> start = middle_corners(rig, 200);
  std::vector<Vec2> now = start;
  for (std::size_t i = 0; i < start.size(); ++i)
    (void)rig.tracker.capture(static_cast<int>(i), rig.before, start[i]);
  Affinity predicted;
  const int count = static_cast<int>(motions.size());
  const std::string name = folder.substr(folder.find_last_of('/') + 1);
  for (int k = 2; k <= count; ++k) {
    const LumaPicture p = read_picture(path(k));
    (void)rig.after.build(view_of(p));
    std::vector<bool> is_kept(start.size());
    // Twice: the first similarity of a frame is the better prediction for its second look.
    for (int look = 0; look < 2; ++look) {
      for (std::size_t i = 0; i < start.size(); ++i) {
        const PatchResult r =
            rig.tracker.track(static_cast<int>(i), rig.after, predicted(start[i]), predicted.matrix());
        is_kept[i] = r.status == PatchStatus::ok;
        now[i] = r.x;
      }
      predicted = similarity(start, now, is_kept);
    }
    if (k != 2 && k != 26 && k != 51 && k != 101 && k != count) continue;
    const Row& m = motions.at(std::to_string(k));
    const Affinity truth{m[0], m[1], m[2], m[3], m[4], m[5]};
    Outcome o;
    for (std::size_t i = 0; i < start.size(); ++i) o.add(is_kept[i], now[i], truth(start[i]));
    o.print_as("drift_" + name + "_win" + std::to_string(window) + "_age" + std::to_string(k - 1));
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: %s DATA [SEQUENCE...]\n", argv[0]);
    return 2;
  }
  for (const char* size : {"320x240", "640x480"}) bench_size(argv[1], size);
  for (int i = 2; i < argc; ++i)
    for (const int window : {15, 21}) bench_drift(argv[i], window);
}
