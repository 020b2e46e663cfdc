// The patch tracker over many frames: its drift over a known motion, and its time on a recording. The folder of a motion
// holds 00001.pgm ... and motion.csv without a header: frame, a, b, c, d, tx, ty. A point (x, y) of the first frame is at
// (a x + b y + tx, c x + d y + ty).
#include <cstdio>

#include "host/bench/klt.hpp"
#include "host/io/csv.hpp"
#include "host/io/files.hpp"
#include "host/io/frame_source.hpp"

namespace pliant::host {

namespace {

// The least-squares similarity from `from` to `to`, over the points whose flag in `counts` is set.
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

// Corners in the middle of the picture.
std::vector<Vec2> middle_corners(const ImageView& image, std::size_t most) {
  CornerOptions o;
  o.min_distance_px = 5;
  o.cell_px = 4;
  std::vector<std::uint8_t> allowed;
  const int cells_x = corner_cells(image.width, o.cell_px), cells_y = corner_cells(image.height, o.cell_px);
  for (int y = 0; y < cells_y; ++y)
    for (int x = 0; x < cells_x; ++x)
      allowed.push_back(4 * x >= cells_x && 4 * x < 3 * cells_x && 6 * y >= cells_y && 6 * y < 5 * cells_y);
  return best_corners(image, most, o, allowed);
}

std::string frame_path(const std::string& folder, int k) {
  char name[32];
  std::snprintf(name, sizeof name, "/%05d.pgm", k);
  return folder + name;
}

// Tracks templates of the first frame. The similarity of each frame is the prediction of the next.
struct Drift {
  KltRig rig;
  std::vector<Vec2> start, now;
  std::vector<bool> is_kept;
  Affinity predicted;

  Drift(const LumaPicture& first, int window) : rig(first.width, first.height, window, 200) {
    require(rig.before->build(view_of(first)), "the first frame");
    start = now = middle_corners(rig.before->level(0), 200);
    is_kept.resize(start.size());
    for (std::size_t i = 0; i < start.size(); ++i)
      (void)rig.tracker->capture(static_cast<int>(i), *rig.before, start[i]);
  }
  void track(const LumaPicture& picture) {
    require(rig.after->build(view_of(picture)), "a frame");
    // The similarity of the first round is a better prediction for the second.
    for (int round = 0; round < 2; ++round) {
      for (std::size_t i = 0; i < start.size(); ++i) {
        const PatchResult r =
            rig.tracker->track(static_cast<int>(i), *rig.after, predicted(start[i]), predicted.matrix());
        is_kept[i] = r.status == PatchStatus::ok;
        now[i] = r.x;
      }
      predicted = similarity(start, now, is_kept);
    }
  }
};

void bench_drift(const BenchRows& row, const std::string& folder, int window) {
  const std::string path = folder + "/motion.csv";
  const CsvTable motions(path, "frame,a,b,c,d,tx,ty\n" + read_file(path));
  const int count = static_cast<int>(motions.row_count());
  const std::string name = folder.substr(folder.find_last_of('/') + 1);
  Drift drift(read_luma(frame_path(folder, 1)), window);
  for (int k = 2; k <= count; ++k) {
    drift.track(read_luma(frame_path(folder, k)));
    if (k != 2 && k != 26 && k != 51 && k != 101 && k != count) continue;
    const auto at = [&](const char* column) {
      return double(motions.number(static_cast<std::size_t>(k - 1), motions.column(column)));
    };
    const Affinity truth{at("a"), at("b"), at("c"), at("d"), at("tx"), at("ty")};
    KltOutcome o;
    for (std::size_t i = 0; i < drift.start.size(); ++i)
      o.add(drift.is_kept[i], drift.now[i], truth(drift.start[i]));
    o.print(row, "drift_" + name + "_win" + std::to_string(window) + "_age" + std::to_string(k - 1));
  }
}

// Tracks corners from frame to frame. Selects new ones when fewer than 70 % remain.
struct Recording {
  KltRig rig;
  std::size_t want;
  std::vector<Vec2> points;
  std::vector<double> us, returns;
  double kept = 0, tried = 0;
  int selections = 0;

  Recording(const FrameView& first, int window, std::size_t points_wanted)
      : rig(first.width, first.height, window, 0), want(points_wanted) {
    require(rig.before->build(first), "the first frame");
  }
  void track(const FrameView& frame) {
    CornerOptions corners;
    corners.min_distance_px = 5;
    corners.cell_px = 4;
    if (10 * points.size() < 7 * want) {
      points = best_corners(rig.before->level(0), want, corners);
      ++selections;
    }
    std::vector<PatchResult> found(points.size());
    const double start = wall_ms();
    require(rig.after->build(frame), "a frame");
    for (std::size_t i = 0; i < points.size(); ++i)
      found[i] = rig.tracker->track_between(*rig.before, points[i], *rig.after, points[i]);
    us.push_back(1e3 * (wall_ms() - start));
    std::vector<Vec2> next;
    for (std::size_t i = 0; i < points.size(); ++i) {
      ++tried;
      if (found[i].status != PatchStatus::ok) continue;
      const PatchResult back = rig.tracker->track_between(*rig.after, found[i].x, *rig.before, found[i].x);
      const double distance = double(length(back.x - points[i]));
      if (back.status != PatchStatus::ok || distance > 1) continue;
      ++kept;
      returns.push_back(distance);
      next.push_back(found[i].x);
    }
    points.swap(next);
    rig.before->swap(*rig.after);
  }
};

void bench_recording(const BenchRows& row, const std::string& frames, int count, int window,
                     std::size_t want) {
  const OpenedFrames opened = open_frames(frames);
  if (opened.source == nullptr) throw Failure(kBadInput, opened.message);
  FrameView frame;
  require(opened.source->next(frame), frames);
  Recording r(frame, window, want);
  int read = 1;
  while (read < count && opened.source->next(frame) == Status::ok) {
    r.track(frame);
    ++read;
  }
  const std::string v = "sequence_" + std::to_string(frame.width) + "x" + std::to_string(frame.height) +
                        "_win" + std::to_string(window) + "_lev" + std::to_string(kKltLevels) + "_n" +
                        std::to_string(want);
  row(v, "frames", read);
  row(v, "us_per_frame_median_pyramid_and_track", quantile(r.us, 0.5));
  row(v, "us_per_frame_p95", quantile(r.us, 0.95));
  row(v, "forward_backward_median_px", quantile(r.returns, 0.5));
  row(v, "kept_per_frame_fraction", r.kept / r.tried);
  row(v, "reselections", r.selections);
}

}  // namespace

void bench_klt_drift(const BenchRows& row, const std::string& folder) {
  for (const int window : {15, 21}) bench_drift(row, folder, window);
}

void bench_klt_sequence(const BenchRows& row, const std::string& frames, int count) {
  for (const std::size_t want : {100u, 500u})
    for (const int window : {15, 21}) bench_recording(row, frames, count, window, want);
}

}  // namespace pliant::host
