// Corner selection and patch tracking on pairs of pictures with known motion. The folder holds, for SIZE 320x240 and
// 640x480, A_SIZE.pgm, B_CASE_SIZE.pgm, points_SIZE_N.csv (x,y a line) and truth.csv: size, case, m00, m01, m10, m11, tx,
// ty, ..., occluder; a point x of A is at
// c + M (x - c) + t in B, where c is the centre of the picture.
#include "host/bench/klt.hpp"

#include "host/bench/bench.hpp"
#include "host/io/csv.hpp"
#include "host/io/files.hpp"

namespace pliant::host {

LumaPicture read_luma(const std::string& path) {
  LumaPicture picture;
  std::string message;
  if (const Status status = read_pnm(path, picture, message); status != Status::ok)
    throw Failure(kBadInput, message);
  return picture;
}

FrameView view_of(const LumaPicture& picture) {
  FrameView f;
  f.data = picture.pixels.data();
  f.width = picture.width;
  f.height = picture.height;
  f.stride_bytes = static_cast<std::size_t>(picture.width);
  return f;
}

void KltOutcome::add(bool is_kept, Vec2 found, Vec2 truth) {
  ++tried;
  if (!is_kept) {
    ++lost;
    return;
  }
  errors.push_back(double(length(found - truth)));
  wrong += errors.back() > 1;
}

void KltOutcome::print(const BenchRows& row, const std::string& variant) const {
  row(variant, "points", tried);
  row(variant, "err_median_px", quantile(errors, 0.5));
  row(variant, "err_p95_px", quantile(errors, 0.95));
  row(variant, "lost_fraction", double(lost) / tried);
  row(variant, "kept_but_over_1px_fraction", double(wrong) / tried);
  if (hidden > 0) row(variant, "hidden_but_kept_fraction", double(hidden_kept) / hidden);
}

std::vector<Vec2> best_corners(const ImageView& image, std::size_t most, const CornerOptions& options,
                               const std::vector<std::uint8_t>& allowed) {
  std::vector<ArenaLine> block(corner_scratch_bytes(image.width, image.height, options) / sizeof(ArenaLine) +
                               1);
  Arena scratch(block.data(), block.size() * sizeof(ArenaLine));
  std::vector<Corner> corners(most);
  int count = 0;
  require(
      find_corners(image, options, {allowed.data(), allowed.size()}, scratch, {corners.data(), most}, count),
      "corners");
  std::vector<Vec2> points;
  for (int i = 0; i < count; ++i) points.push_back(corners[static_cast<std::size_t>(i)].x);
  return points;
}

namespace {

PatchOptions strict() {
  PatchOptions o;
  o.min_correlation = 0.9f;
  return o;
}

// A match more than half a window from the prediction is rejected.
PatchOptions strict_near(int window) {
  PatchOptions o = strict();
  o.max_move_px = 0.5f * static_cast<float>(window);
  return o;
}

struct Region {
  double x0, y0, x1, y1;
  Region grown(double by) const { return {x0 - by, y0 - by, x1 + by, y1 + by}; }
  bool contains(Vec2 p) const {
    return double(p.x) >= x0 && double(p.y) >= y0 && double(p.x) < x1 && double(p.y) < y1;
  }
};

constexpr double kMargin = 16;  // px between both ends of a motion and the border or the occluder

struct KltCase {
  std::string name;
  Affinity motion;
  bool is_occluded;
};

std::vector<KltCase> read_cases(const std::string& folder, const std::string& size, int width, int height) {
  const std::string path = folder + "/truth.csv";
  const CsvTable table(path, read_file(path));
  std::vector<KltCase> cases;
  for (std::size_t r = 0; r < table.row_count(); ++r) {
    if (table.cell(r, table.column("size")) != size) continue;
    const auto at = [&](const char* name) { return double(table.number(r, table.column(name))); };
    const double cx = 0.5 * (width - 1), cy = 0.5 * (height - 1);
    const double a = at("m00"), b = at("m01"), c = at("m10"), d = at("m11");
    cases.push_back({table.cell(r, table.column("case")),
                     {a, b, c, d, cx + at("tx") - a * cx - b * cy, cy + at("ty") - c * cx - d * cy},
                     at("occluder") != 0});
  }
  return cases;
}

std::vector<Vec2> read_points(const std::string& path) {
  const CsvTable table(path, "x,y\n" + read_file(path));
  std::vector<Vec2> points;
  for (std::size_t r = 0; r < table.row_count(); ++r)
    points.push_back({table.number(r, 0), table.number(r, 1)});
  return points;
}

// Runs one case. The search starts at the old position or, if predicted, at the true motion with its warp.
KltOutcome run_case(KltRig& rig, const std::vector<Vec2>& points, const KltCase& c, bool is_predicted) {
  const double w = rig.before->level(0).width, h = rig.before->level(0).height;
  const Region inner = Region{0, 0, w, h}.grown(-kMargin), hidden{0.3 * w, 0.25 * h, 0.6 * w, 0.75 * h};
  KltOutcome o;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec2 x = points[i], truth = c.motion(x);
    if (!inner.contains(x) || !inner.contains(truth)) continue;
    const PatchResult r = is_predicted
                              ? rig.tracker->track(static_cast<int>(i), *rig.after, truth, c.motion.matrix(),
                                                   strict_near(rig.tracker->limits().window))
                              : rig.tracker->track_between(*rig.before, x, *rig.after, x, strict());
    const bool is_kept = r.status == PatchStatus::ok;
    if (c.is_occluded && hidden.contains(truth)) {
      ++o.hidden;
      o.hidden_kept += is_kept;
    } else if (!c.is_occluded || !hidden.grown(kMargin).contains(truth)) {
      o.add(is_kept, r.x, truth);
    }
  }
  return o;
}

void bench_cases(const BenchRows& row, const std::string& folder, const std::string& size,
                 const std::string& variant, const std::vector<Vec2>& points, KltRig& rig) {
  for (std::size_t i = 0; i < points.size(); ++i)
    (void)rig.tracker->capture(static_cast<int>(i), *rig.before, points[i]);
  const ImageView& image = rig.before->level(0);
  for (const KltCase& c : read_cases(folder, size, image.width, image.height)) {
    const LumaPicture b = read_luma(folder + "/B_" + c.name + "_" + size + ".pgm");
    require(rig.after->build(view_of(b)), c.name);
    run_case(rig, points, c, false).print(row, variant + "_" + c.name);
    run_case(rig, points, c, true).print(row, variant + "_" + c.name + "_predicted");
  }
}

void bench_selection(const BenchRows& row, const LumaPicture& a, const std::string& size, int count) {
  CornerOptions o;
  o.min_score = 0;
  o.min_ratio = 0;
  o.quality = 0.001f;
  o.min_distance_px = count < 2000 ? 7.0f : a.width == 320 ? 3.0f : 5.0f;
  o.cell_px = count < 2000 ? 4 : 2;
  const ImageView image{a.pixels.data(), a.width, a.height, a.width};
  std::size_t found = 0;
  const double t = median_microseconds(
      [&] { found = best_corners(image, static_cast<std::size_t>(count), o).size(); }, 15);
  const std::string v = "select_" + size + "_n" + std::to_string(count) + "_mindist" +
                        std::to_string(static_cast<int>(o.min_distance_px));
  row(v, "us_per_frame", t);
  row(v, "points", static_cast<double>(found));
}

void bench_tracking(const BenchRows& row, const std::string& variant, const std::vector<Vec2>& points,
                    KltRig& rig) {
  const PatchOptions o = strict();
  const double t = median_microseconds(
      [&] {
        for (const Vec2 x : points) (void)rig.tracker->track_between(*rig.before, x, *rig.after, x, o);
      },
      31);
  row("track_" + variant, "us_per_frame", t);
  row("track_" + variant, "us_per_point", t / static_cast<double>(points.size()));
}

void bench_size(const BenchRows& row, const std::string& folder, const std::string& size) {
  const LumaPicture a = read_luma(folder + "/A_" + size + ".pgm");
  const LumaPicture b = read_luma(folder + "/B_affine_noise_" + size + ".pgm");
  for (const int n : {100, 500, 2000}) {
    bench_selection(row, a, size, n);
    const std::vector<Vec2> points =
        read_points(folder + "/points_" + size + "_" + std::to_string(n) + ".csv");
    for (const int window : {15, 21}) {
      KltRig rig(a.width, a.height, window, static_cast<int>(points.size()));
      const double pyramid_us =
          median_microseconds([&] { require(rig.before->build(view_of(a)), size); }, 51);
      require(rig.after->build(view_of(b)), size);
      const std::string w = size + "_win" + std::to_string(window) + "_lev" + std::to_string(kKltLevels);
      if (n == 100) row("pyramid_" + w, "us_per_frame", pyramid_us);
      const std::string variant = w + "_n" + std::to_string(points.size());
      bench_tracking(row, variant, points, rig);
      if (n == 500) bench_cases(row, folder, size, variant, points, rig);
    }
  }
}

}  // namespace

void bench_klt(std::ostream& out, const KltInputs& inputs) {
  const BenchRows row(out, "klt");
  if (inputs.pairs)
    for (const char* size : {"320x240", "640x480"}) bench_size(row, *inputs.pairs, size);
  for (const std::string& folder : inputs.motions) bench_klt_drift(row, folder);
  if (inputs.frames) bench_klt_sequence(row, *inputs.frames, inputs.count);
}

}  // namespace pliant::host
