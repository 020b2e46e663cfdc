// `pliant plan`: what it says beforehand is what a run takes.
#include "host/commands/plan.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "baked_face.hpp"
#include "cli_run.hpp"
#include "host/io/fit_file.hpp"
#include "host/io/frame_source.hpp"
#include "host/io/image.hpp"
#include "host/io/owned.hpp"
#include "print/print_finder.hpp"
#include "print/print_tuning.hpp"
#include "print_film.hpp"
#include "random.hpp"

namespace plan_test {

using namespace pliant;
using namespace cli_run;

namespace {

/// The number behind a name in the printed plan.
std::size_t printed(const std::string& plan, const std::string& name) {
  const std::size_t at = plan.find("\n  " + name + " ");
  REQUIRE(at != std::string::npos);
  return std::stoul(plan.substr(at + 3 + name.size()));
}

/// The bound of a load; of a plan: of a frame with a track.
double most_of(const std::vector<Load>& loads, const std::string& what) {
  for (const Load& load : loads)
    if (load.what == what) return load.most;
  FAIL("no load " << what);
  return 0;
}
double most_of(const Plan& plan, const std::string& what) {
  return most_of(plan.loads, what);
}

std::size_t sum_of(const Plan& plan) {
  std::size_t sum = 0;
  for (const std::size_t bytes : plan.bytes) sum += bytes;
  return sum;
}

}  // namespace

TEST_CASE("the bytes of all purposes add up to the bytes of a tracker, for any limits") {
  const Folder folder;
  const ModelFile file(folder.put("m.plm", model_bytes()));
  Random random(4);
  for (int k = 0; k < 60; ++k) {
    TrackerLimits limits = k % 3 == 0 ? profile_s() : k % 3 == 1 ? profile_l() : TrackerLimits{};
    if (k > 2) {
      const auto among = [&random](int low, int high) {
        return static_cast<std::uint16_t>(random.uniform(static_cast<float>(low), static_cast<float>(high)));
      };
      limits.width = among(64, 900);
      limits.height = among(64, 700);
      limits.patches = among(8, 300);
      limits.key_frames = static_cast<std::uint8_t>(among(0, 8));
      limits.key_patches = k % 4 == 0 ? std::uint16_t{0} : among(limits.key_frames, 100);
      limits.vertices = among(200, 3000);
      limits.markers = among(0, 50);
      limits.keeps_previous = k % 2 == 0;
      limits.samples_vertices = k % 5 != 0;
      if (k % 2 == 0) limits.personal_field = {among(4, 80), among(4, 80)};
    }
    const Plan plan = make_plan(file.model(), limits);
    CHECK(sum_of(plan) == plan.arena_bytes);
    CHECK(plan.bytes[static_cast<std::size_t>(Purpose::other)] == 0);
    CHECK(plan.arena_bytes == measured_bytes<Tracker>(file.model(), limits));
    const Owned<Tracker> tracker(file.model(), limits);
    CHECK(tracker.used_bytes() == plan.arena_bytes);
  }
}

TEST_CASE("the printed plan has the arena size that a run reports, and its parts add up") {
  const Sequence s;
  const Ran run = run_words(s.track_words());
  REQUIRE(run.code == 0);
  const Ran plan = run_words({"plan", s.model, "--width", "200", "--height", "160"});
  CAPTURE(plan.err);
  REQUIRE(plan.code == 0);
  CHECK(static_cast<float>(printed(plan.out, "arena")) == value_after(run.out, "arena_bytes"));
  CHECK(printed(plan.out, "picture pyramid") > 2u * 200u * 160u);
  CHECK(contains(plan.out, "the model's table"));
  const Ran small = run_words({"plan", s.model, "--profile", "s"});
  CHECK(printed(small.out, "arena") == measured_bytes<Tracker>(ModelFile(s.model).model(), profile_s()));
  const std::size_t base = ModelFile(s.model).model().base_uv().count;
  REQUIRE(base > 4);
  CHECK(run_words({"plan", s.model, "--vertices", std::to_string(base)}).code == 0);
  const Ran too_few = run_words({"plan", s.model, "--vertices", std::to_string(base - 1)});
  CHECK(too_few.code == 2);
  CHECK(contains(too_few.err, "base mesh"));
}

TEST_CASE(
    "a model that is too large for a profile is refused before its film is read, and its plan says so") {
  const Folder f;
  for (const char* modes : {"6", "12"}) {
    CAPTURE(modes);
    const std::string model = f / "sheet.plm";
    REQUIRE(
        run_words({"bake", PLIANT_FIXTURES "/sheet", "--modes", modes, "--size", "64", "-o", model}).code ==
        0);
    const auto is_refused = [&](const char* profile) {
      const Ran r =
          run_words({"track", model, "--frames", f / "none.y4m", "--out", f / "t.csv", "--profile", profile});
      CHECK(r.code == 1);
      CHECK(contains(r.err, "none.y4m") != contains(r.err, model + ": the model has "));
      return contains(r.err, "corrective ones included, and the profile memory for 44");
    };
    const bool is_large = modes[0] == '1';
    CHECK(is_refused("s") == is_large);
    CHECK_FALSE(is_refused("m"));
    const Ran plan = run_words({"plan", model, "--profile", "s"});
    CHECK(plan.code == 0);
    CHECK(contains(plan.err, "corrective ones included, and the profile memory for 44") == is_large);
    CHECK(run_words({"plan", model, "--profile", "m"}).err.empty());
  }
}

TEST_CASE("a larger limit needs more bytes, and without a model one record a parameter is assumed") {
  const auto arena = [](std::vector<std::string> more) {
    std::vector<std::string> words = {"plan"};
    words.insert(words.end(), more.begin(), more.end());
    const Ran r = run_words(words);
    CAPTURE(r.err);
    REQUIRE(r.code == 0);
    return printed(r.out, "arena");
  };
  const std::size_t base = arena({"--parameters", "30"});
  CHECK(arena({"--parameters", "40"}) > base);
  CHECK(arena({"--parameters", "30", "--width", "640"}) > base);
  CHECK(arena({"--parameters", "30", "--height", "480"}) > base);
  CHECK(arena({"--parameters", "30", "--vertices", "600"}) > base);
  CHECK(arena({"--parameters", "30", "--points", "300"}) > base);
  CHECK(arena({"--parameters", "30", "--markers", "20"}) > base);
  CHECK(arena({"--parameters", "30", "--profile", "s"}) < base);
  CHECK(arena({"--parameters", "30", "--profile", "l"}) > base);
  CHECK(arena({"--parameters", "30", "--profile", "m"}) == base);
  CHECK(run_words({"plan", "--profile", "x"}).code == 2);
  CHECK(run_words({"plan", "--width", "20"}).code == 2);
  CHECK(run_words({"plan", "--parameters", "192"}).code == 0);
  CHECK(run_words({"plan", "--parameters", "193"}).code == 2);
  CHECK(run_words({"plan", "nothing.plm"}).code == 1);
}

TEST_CASE("no frame takes more steps than the bound of the plan, even on noise") {
  const Sequence s;
  REQUIRE(run_words({"fit", s.model, "--points", s.points, "--size", "200x160", "--focal", "330", "-o",
                     s / "f.json"})
              .code == 0);
  const ModelFile file(s.model);
  const FitFile fit = parse_fit("f", read_file(s / "f.json"));
  std::vector<float> q(file.model().parameters().count, 0.0f);
  apply(fit.parameters, "f", file.model(), q.data());
  TrackerLimits limits;
  limits.width = 200;
  limits.height = 160;
  const Plan plan = make_plan(file.model(), limits);
  Owned<Tracker> tracker(file.model(), limits);
  const OpenedFrames video = open_frames(s.video);
  REQUIRE(video.source != nullptr);
  Random random(8);
  FrameView frame;
  int most = 0, key = 0;
  for (int k = 0; video.source->next(frame) == Status::ok; ++k) {
    if (k == 0) {
      REQUIRE(tracker->start_from_pose(frame, fit.camera, fit.pose, q.data()) == Status::ok);
      continue;
    }
    // Some frames are half covered with noise, so that rejection has to work.
    Image picture = image_of(frame);
    for (int i = 0; k % 3 == 0 && i < 200 * 80; ++i)
      picture.pixels[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(random.uniform(0, 255));
    frame.data = picture.pixels.data();
    frame.stride_bytes = 200;
    FrameResult result;
    REQUIRE(tracker->update(frame, &result) == Status::ok);
    most = std::max<int>(most, result.iterations);
    CHECK(result.iterations <= plan.most_iterations);
    const FrameWork& work = tracker->work();
    CHECK(work.searches > 0);
    CHECK(work.search_steps <= most_of(plan, "steps of template searches"));
    CHECK(work.rows <= most_of(plan, "observations in passes over them") +
                           most_of(plan, "observations in the last pass of a solve"));
    CHECK(work.measured_rows <= most_of(plan, "observations measured for a step"));
    CHECK(work.factorisations <= most_of(plan, "factorisations"));
    CHECK(work.captures <= most_of(plan, "places tried for a key frame's templates"));
    CHECK(work.coarse_pixels <= most_of(plan, "pixels of thumbnails compared"));
    CHECK(work.forces <= most_of(plan, "image forces compared"));
    CHECK(result.vertices <= limits.vertices);
    CHECK(result.tracked <= limits.patches + limits.key_patches);
    ++key;
  }
  CHECK(most > 0);
  CHECK(key == 11);
  for (const Load& load : plan.loads) {
    CAPTURE(load.what);
    CHECK(load.usual <= load.most);
    CHECK(load.most > 0);
    CHECK(load.instructions > 0);
  }
  CHECK(usual_instructions(plan.loads) < most_instructions(plan.loads));
}

TEST_CASE(
    "the coarse translation of a lost track is within the plan, also where it takes more than the budget") {
  const Sequence s;
  const ModelFile file(s.model);
  TrackerLimits limits = without_detection(TrackerLimits{});
  limits.width = limits.thumbnail_width = 200;
  limits.height = 160;
  limits.patches = 20;
  limits.key_patches = 0;
  const Plan plan = make_plan(file.model(), limits);
  Owned<Tracker> tracker(file.model(), limits);
  const OpenedFrames video = open_frames(s.video);
  REQUIRE(video.source != nullptr);
  FrameView frame;
  REQUIRE(video.source->next(frame) == Status::ok);
  REQUIRE(tracker->start_from_box(frame, {50, 30}, {100, 100}) == Status::ok);
  const std::vector<std::uint8_t> black(200 * 160);
  frame.data = black.data();
  frame.stride_bytes = 200;
  for (int k = 0; k < 4; ++k) {
    ++frame.sequence;
    FrameResult result;
    REQUIRE(tracker->update(frame, &result) == Status::ok);
    CHECK(tracker->work().coarse_pixels <= most_of(plan, "pixels of thumbnails compared"));
    const WorkCosts costs = tracker->estimator().work_costs(limits.patch_window);
    CHECK(static_cast<double>(costs.of(tracker->work())) <= most_counted_instructions(plan.loads));
  }
}

TEST_CASE("with a clock the plan says ms, and what shares the budget of a frame has one bound together") {
  const Sequence s;
  const Ran plan = run_words({"plan", s.model, "--mhz", "480"});
  REQUIRE(plan.code == 0);
  CHECK(contains(plan.out, "ms, Cortex-M7"));
  CHECK_FALSE(contains(run_words({"plan", s.model}).out, "ms, Cortex-M7"));
  CHECK(most_instructions(
            {{"a", 1, 2, 10}, {"b", 1, 5, 20, Bound::shared}, {"c", 0, 50, 2, Bound::shared}}) == 120);
  CHECK(most_counted_instructions(
            {{"a", 1, 2, 10}, {"b", 1, 5, 20, Bound::shared}, {"d", 0, 3, 4, Bound::beside}}) == 112);
  CHECK(most_instructions({{"a", 1, 2, 10}, {"b", 1, 5, 20, Bound::shared}, {"d", 0, 3, 4, Bound::beside}}) ==
        132);
}

TEST_CASE("the bound of a frame is at most 4 times its usual work, with all profiles") {
  const Folder folder;
  const ModelFile file(folder.put("m.plm", model_bytes()));
  for (const TrackerLimits& limits : {profile_s(), profile_m(), profile_l()}) {
    const Plan plan = make_plan(file.model(), limits);
    CHECK(most_instructions(plan.loads) < 4 * usual_instructions(plan.loads));
  }
}

TEST_CASE(
    "the smoothing of noisy frames is in the plan of a face, and not in that of profile S or of a sheet") {
  const auto smoothed = [](const std::vector<Load>& loads) {
    double most = 0;
    for (const Load& load : loads)
      if (load.what == std::string("pixels smoothed")) most += load.most;
    return most;
  };
  const Plan plan = make_plan(baked_face().model, {});
  CHECK(smoothed(plan.loads) == 320 * 240);
  CHECK(smoothed(plan.start_loads) == 320 * 240);
  CHECK(smoothed(make_plan(baked_face().model, profile_s()).loads) == 0);
  CHECK(smoothed(make_plan(host::sheet(), {}).loads) == 0);
}

TEST_CASE("edges are work of the frame after a start where the frame before is kept, else of the start") {
  const auto usual = [](const std::vector<Load>& loads) {
    double edges = 0;
    for (const Load& load : loads)
      if (load.what == std::string("points of curves")) edges += load.usual;
    return edges;
  };
  for (const bool keeps_previous : {true, false}) {
    TrackerLimits limits;
    limits.keeps_previous = keeps_previous;
    const Plan plan = make_plan(baked_face().model, limits);
    const double edges = limits.curve_points + limits.silhouette_points;
    CHECK(usual(plan.edge_loads) == (keeps_previous ? edges : 0));
    CHECK(usual(plan.start_loads) == (keeps_previous ? 0 : edges));
  }
}

TEST_CASE(
    "two frames share the templates of a track that begins while another one ends, where pictures last") {
  const auto most = [](const std::vector<Load>& loads, const char* what) {
    double sum = 0;
    for (const Load& load : loads)
      if (load.what == std::string(what)) sum += load.most;
    return sum;
  };
  constexpr const char* kTemplates = "templates captured";
  const host::ModelFile file{PLIANT_DETECTING_FACE};
  const Model& model = file.model();
  const Plan plan = make_plan(model, {});
  const double first = most(plan.anew_loads[0], kTemplates), second = most(plan.anew_loads[1], kTemplates);
  CHECK(first > 0);
  CHECK(second > first);
  CHECK(first + second == most(plan.start_loads, kTemplates));
  TrackerLimits limits;
  limits.keeps_previous = false;
  CHECK(make_plan(model, limits).anew_loads[0].empty());
  CHECK(make_plan(model, profile_s()).anew_loads[0].empty());
}

TEST_CASE(
    "the plan of a printed sheet has its checks, its search and its springs, and bounds what a track "
    "counts") {
  const TrackerLimits limits;
  const Model& model = host::sheet();
  const Plan plan = make_plan(model, limits),
             bare = make_plan(model, without_detection(without_stretch(limits)));
  CHECK(most_of(plan, "blocks of the print compared") == 48);
  CHECK(most_instructions(plan.loads) > most_instructions(bare.loads));
  CHECK(most_counted_instructions(plan.loads) > most_counted_instructions(bare.loads));
  CHECK(most_instructions(plan.search_loads) > 0);
  CHECK(bare.search_loads.empty());
  // A search of one frame carries nothing to a later one, and has all fits in it.
  TrackerLimits slow, whole;
  slow.search_work = 1000;
  whole.search_work = std::numeric_limits<std::uint32_t>::max();
  const Plan spread = make_plan(model, slow), at_once = make_plan(model, whole);
  const char *const kPlaces = "places found in small pictures", *const kFits = "fits of the print";
  for (const Load& load : at_once.start_loads) CHECK(load.what != std::string(kPlaces));
  CHECK(most_of(spread.start_loads, kPlaces) == 3 * 48);
  const std::size_t of_solution = kPrintTuning.fits_of_solution();
  CHECK(most_of(spread.search_loads, kFits) <= static_cast<double>(1 + of_solution));
  CHECK(most_of(at_once.search_loads, kFits) ==
        static_cast<double>(kPrintTuning.most_views * kPrintTuning.solutions * of_solution) +
            kPrintTuning.settling_passes);
  CHECK(at_once.print_search_frames == 1);
  InArena<Tracker> tracker(model, limits);
  const std::vector<float> rest(model.parameters().count, 0);
  for (std::uint32_t n = 0; n < 12; ++n) {
    const float turn = 0.02f * static_cast<float>(n);
    const Image picture = host::picture_of(host::posed(turn, turn, 0, 1), rest, n + 1);
    const FrameView view{picture.pixels.data(), host::kWidth, host::kHeight, host::kWidth, 1, 0, n + 1};
    FrameResult result;
    if (n == 0)
      REQUIRE(tracker->start_from_pose(view, host::kCamera, host::posed(0, 0, 0, 1), nullptr) == Status::ok);
    else
      REQUIRE(tracker->update(view, &result) == Status::ok);
    const WorkCosts costs = tracker->estimator().work_costs(limits.patch_window);
    CHECK(static_cast<double>(costs.of(tracker->work())) <= most_counted_instructions(plan.loads));
  }
}

TEST_CASE(
    "the plan bounds the cells of a search for a print: at least a level of the frame, or what is begun, is "
    "done") {
  const auto cells_of = [](std::uint16_t width, std::uint16_t height, std::uint32_t work) {
    TrackerLimits limits = profile_s();
    limits.width = width;
    limits.height = height;
    limits.search_work = work;
    const auto& loads = make_plan(host::sheet(), limits).search_loads;
    REQUIRE(std::string(loads.front().what) == "cells of the search");
    CHECK(loads.front().usual <= loads.front().most);
    return loads.front().most;
  };
  const double of_level = 320 * 240 / kPrintTuning.pixels_per_cell +
                          static_cast<double>(kPrintTuning.cells_per_descriptor * kPrintTuning.corners);
  CHECK(cells_of(320, 240, 0) == of_level);
  CHECK(cells_of(320, 240, static_cast<std::uint32_t>(of_level) + 1) > 1.2 * of_level);  // with the next one
  CHECK(cells_of(640, 480, 4000) > 640 * 480 / kPrintTuning.pixels_per_cell);
  CHECK(cells_of(320, 240, 1000000) <
        60000);  // a whole search, where all corners match and all matches suggest one scale
}

TEST_CASE("a frame may search as much as can be said, and its bounds do not overflow") {
  const host::ModelFile file{PLIANT_DETECTING_FACE};
  TrackerLimits limits;
  limits.search_work = 0xFFFFFFFF;
  const SearchPlan all = make_plan(file.model(), limits).search;
  CHECK(all.cells == all.all_cells);
  CHECK(all.search_frames == 1);
  limits.detection = &kFaceDetection;
  limits.width = limits.height = 8192;
  SearchPlan less;
  for (const std::uint32_t work : {1'000'000u, 3'000'000u, 9'000'000u}) {
    limits.search_work = work;
    const SearchPlan plan = make_plan(file.model(), limits).search;
    CAPTURE(plan.all_cells);
    REQUIRE(plan.search_frames > 1);
    CHECK(plan.turned_pixels > less.turned_pixels);
    CHECK(plan.near_cells > less.near_cells);
    less = plan;
  }
}

TEST_CASE(
    "a frame that searches or aligns has the bound of what takes more; one that does both has their sum") {
  const host::ModelFile file{PLIANT_DETECTING_FACE};
  // Whether a frame without a track counts cells of the search, and steps of alignments.
  const auto counts = [&](std::uint32_t work) {
    TrackerLimits limits = profile_s();
    limits.search_work = work;
    std::pair<bool, bool> counted;
    for (const Load& load : make_plan(file.model(), limits).search_loads) {
      counted.first |= std::string(load.what) == "cells of the search";
      counted.second |= std::string(load.what) == "steps of alignments";
    }
    return counted;
  };
  CHECK(counts(profile_s().search_work) == std::pair(true, false));
  CHECK(counts(11'000) == std::pair(false, true));
  CHECK(counts(24'000) == std::pair(true, true));
}

TEST_CASE("bad frames are aligned with any limits that find faces, with second looks the mean face, too") {
  const host::ModelFile file{PLIANT_DETECTING_FACE};
  const auto steps = [&](const TrackerLimits& limits) {
    const auto& loads = make_plan(file.model(), limits).alignment_loads;
    return loads.empty() ? 0.0 : loads.front().most;
  };
  CHECK(steps(without_detection(profile_s())) == 0);
  CHECK(steps(profile_s()) == 3);
  CHECK(steps({}) == 8);
}

/// Frames of a search for the sheet that looks at the same frame again and again; it shows the sheet, or noise.
int frames_of_search(const TrackerLimits& limits, bool shows_sheet) {
  Random random(1);
  const int width = limits.width, height = limits.height;
  host::Image picture(width, height, 1);
  for (auto& pixel : picture.pixels) pixel = static_cast<std::uint8_t>(random.below(256));
  const std::vector<float> rest(host::sheet().parameters().count, 0);
  const host::Image sheet = host::picture_of(host::posed(0.2f, 0.1f, 0.3f, 1), rest, 1);
  for (int y = 0; shows_sheet && y < std::min(height, host::kHeight); ++y)
    for (int x = 0; x < std::min(width, host::kWidth); ++x) *picture.at(x, y) = *sheet.at(x, y);
  const FrameView frame{picture.pixels.data(), width, height, static_cast<std::size_t>(width)};
  InArena<PrintFinder> finder(host::sheet(), width, height);
  std::vector<float> q(rest.size());
  FoundPrint found;
  for (int frames = 1;; ++frames) {
    const Status status = finder->search(frame, limits.search_work, host::kCamera, q.data(), &found);
    REQUIRE((status == Status::ok || status == Status::not_found));
    if (finder->is_idle()) return frames;
  }
}

TEST_CASE(
    "the plan bounds the frames of a search for a print: with the print, and in a picture full of corners") {
  TrackerLimits little = profile_s(), whole = profile_l();
  little.search_work = 100;
  whole.search_work = std::numeric_limits<std::uint32_t>::max();
  for (const TrackerLimits& limits : {TrackerLimits{}, profile_s(), profile_l(), little, whole})
    for (const bool shows_sheet : {true, false}) {
      CAPTURE(limits.search_work);
      CAPTURE(shows_sheet);
      const int frames = frames_of_search(limits, shows_sheet);
      CHECK(frames > 0);
      CHECK(frames <= make_plan(host::sheet(), limits).print_search_frames);
    }
  CHECK(make_plan(host::sheet(), whole).print_search_frames == 1);
  CHECK(make_plan(baked_face().model, {}).print_search_frames == 0);
}

}  // namespace plan_test
