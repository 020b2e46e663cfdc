// A printed surface is found by its print: tables, descriptors, starts at many views, recovery, bounded work, and pictures that
// do not show it.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "host/bake/bake.hpp"
#include "host/bake/opened_table.hpp"
#include "host/io/aligned_table.hpp"
#include "host/io/image.hpp"
#include "model_builder.hpp"
#include "print/descriptor.hpp"
#include "print/match_consensus.hpp"
#include "print/print_finder.hpp"
#include "print/print_table.hpp"
#include "print/print_tuning.hpp"
#include "print_film.hpp"
#include "random.hpp"
#include "scratch_folder.hpp"

namespace print_start_test {

using namespace pliant;
using namespace pliant::host;

TEST_CASE("a sheet is found in its first frame, turned, tilted and bent") {
  struct {
    float x, y, roll, away;
    std::vector<float> q;
  } const cases[] = {{0.2f, 0.1f, 0, 1, kRest},
                     {-0.3f, 0.4f, 1, 0.8f, kRest},
                     {0.5f, -0.5f, 3, 0.8f, kRest},
                     {0.3f, 0, -2, 0.7f, {1, 0.5f, 0}},
                     {0, -0.4f, 0.5f, 0.9f, {-1, 0, 1}}};
  std::uint32_t seed = 1;
  for (const auto& c : cases) {
    CAPTURE(seed);
    Film film(sheet());
    const Pose pose = posed(c.x, c.y, c.roll, c.away);
    for (int k = 0; k < 4 && !film.tracker->is_started(); ++k)
      REQUIRE(film.show(picture_of(pose, c.q, seed++)) == Status::ok);
    REQUIRE(film.tracker->is_started());
    CHECK(film.turned_from(pose) < 0.05f);
    for (std::size_t k = 0; k < 3; ++k)
      CHECK(film.tracker->parameters()[k] == doctest::Approx(double(c.q[k])).epsilon(0.2));
  }
}

TEST_CASE("a sheet that leaves the picture is lost, and found within five frames of its return elsewhere") {
  Film film(sheet());
  const Pose before = posed(0.2f, 0.3f, 0, 0.9f), after = posed(-0.3f, 0.2f, 2.5f, 0.8f);
  for (std::uint32_t k = 0; k < 8; ++k) REQUIRE(film.show(picture_of(before, kRest, k)) == Status::ok);
  CHECK(film.result.state == TrackState::tracking);
  Image empty = make_background(kWidth, kHeight, 7);
  for (std::uint32_t k = 0; k < 12; ++k) REQUIRE(film.show(empty) == Status::ok);
  CHECK_FALSE(film.tracker->is_started());
  CHECK(film.result.is_searching);
  int frames = 0;
  for (; frames < 5 && !film.tracker->is_started(); ++frames)
    REQUIRE(film.show(picture_of(after, kRest, static_cast<std::uint32_t>(frames))) == Status::ok);
  REQUIRE(film.tracker->is_started());
  CHECK(film.turned_from(after) < 0.05f);
}

TEST_CASE("a search with little work a frame ends at the same place some frames later") {
  TrackerLimits limits;
  limits.search_work = 1000;
  Film film(sheet(), limits);
  const Pose pose = posed(0.2f, 0.3f, 0.4f, 0.9f);
  int frames = 0;
  for (; frames < 40 && !film.tracker->is_started(); ++frames) {
    REQUIRE(film.show(picture_of(pose, kRest, static_cast<std::uint32_t>(frames))) == Status::ok);
    CHECK((film.tracker->is_started() || film.result.is_searching));
  }
  CHECK(frames > 4);
  REQUIRE(film.tracker->is_started());
  CHECK(film.turned_from(pose) < 0.05f);
}

/// Frames until a search with little work a frame has found the sheet, of 40; 0: not found. \param shown  whether a frame shows it.
template <class Shown>
int frames_until_found(Film* film, float px_a_frame, const Shown& shown, Pose* last) {
  for (int k = 0; k < 40; ++k) {
    // Back and forth, 12 frames each way.
    const int phase = k % 24, way = phase < 12 ? phase : 24 - phase;
    *last = posed(0.2f, 0.3f, 0.4f + 0.01f * static_cast<float>(way), 0.9f);
    last->t.x = px_a_frame * static_cast<float>(way - 6) * last->t.z / kCamera.f;
    const auto seed = static_cast<std::uint32_t>(k);
    REQUIRE(film->show(shown(k) ? picture_of(*last, kRest, 3) : make_background(kWidth, kHeight, seed)) ==
            Status::ok);
    if (film->tracker->is_started()) return k + 1;
  }
  return 0;
}

TEST_CASE("a sheet that moves while its search takes several frames is found where it is now") {
  TrackerLimits limits;
  limits.search_work = profile_s().search_work;
  for (const float px_a_frame : {2.0f, 5.0f, 8.0f}) {
    CAPTURE(px_a_frame);
    Film film(sheet(), limits);
    Pose pose;
    const int frames = frames_until_found(
        &film, px_a_frame, [](int) { return true; }, &pose);
    REQUIRE(frames > 4);
    CHECK(frames <= 20);
    CHECK(film.turned_from(pose) < 0.05f);
    CHECK(length(film.result.pose.t - pose.t) < 0.01f * pose.t.z);
  }
}

TEST_CASE("a sheet that has left the picture when its search ends starts nothing") {
  TrackerLimits limits;
  limits.search_work = 1000;
  Film film(sheet(), limits);
  Pose pose;
  CHECK(frames_until_found(
            &film, 2, [](int k) { return k % 40 < 2; }, &pose) == 0);
}

TEST_CASE("pictures without the sheet start nothing: flat, noise, checkerboards, blotches, another print") {
  Random random(3);
  std::vector<Image> pictures;
  pictures.push_back(Image(kWidth, kHeight, 1));
  for (const int side : {4, 9, 20, 37}) {
    Image board(kWidth, kHeight, 1);
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) *board.at(x, y) = (x / side + y / side) % 2 == 0 ? 30 : 220;
    pictures.push_back(board);
  }
  for (int k = 0; k < 3; ++k) {
    Image noise(kWidth, kHeight, 1);
    for (std::uint8_t& p : noise.pixels) p = static_cast<std::uint8_t>(random.below(256));
    pictures.push_back(noise);
    pictures.push_back(make_background(kWidth, kHeight, static_cast<std::uint32_t>(k)));
  }
  for (const Image& picture : pictures) {
    Film film(sheet());
    for (int k = 0; k < 4; ++k) REQUIRE(film.show(picture) == Status::ok);
    CHECK_FALSE(film.tracker->is_started());
  }
}

TEST_CASE("a track that shows the print no longer is given up though its templates still match") {
  Film film(sheet());
  const Pose pose = posed(0.2f, 0.3f, 0, 0.9f);
  Image still = make_background(kWidth, kHeight, 9);
  Random random(5);
  for (std::uint8_t& p : still.pixels) p = static_cast<std::uint8_t>(random.below(256));
  FrameView view{still.pixels.data(), kWidth, kHeight, std::size_t{kWidth}, 1, 1, 1};
  film.count = 1;
  REQUIRE(film.tracker->start_from_pose(view, kCamera, pose, nullptr) == Status::ok);
  for (int k = 0; k < 6 && film.tracker->is_started(); ++k) REQUIRE(film.show(still) == Status::ok);
  CHECK_FALSE(film.tracker->is_started());
}

TEST_CASE("a track is given up after two bad checks in a row, not after two with a good one between them") {
  const Pose pose = posed(0.2f, 0.3f, 0, 0.9f);
  // Templates are in the noise alone, whatever is around it.
  Image print = picture_of(pose, kRest, 9), blank = print;
  std::fill(blank.pixels.begin(), blank.pixels.end(), std::uint8_t{128});
  Random random(5);
  for (int y = 90; y < 150; ++y)
    for (int x = 110; x < 210; ++x)
      *print.at(x, y) = *blank.at(x, y) = static_cast<std::uint8_t>(random.below(256));
  const auto last_frame_of_track = [&](bool has_good_checks) {
    Film film(sheet());
    const FrameView view{blank.pixels.data(), kWidth, kHeight, std::size_t{kWidth}, 1, 1, 1};
    film.count = 1;
    REQUIRE(film.tracker->start_from_pose(view, kCamera, pose, nullptr) == Status::ok);
    const int interval = kPrintTuning.check_interval_frames;
    int k = 0;
    while (k < 8 * interval && film.tracker->is_started()) {
      ++k;
      REQUIRE(film.show(has_good_checks && k % (2 * interval) == 0 ? print : blank) == Status::ok);
    }
    return film.tracker->is_started() ? 0 : k;
  };
  CHECK(last_frame_of_track(false) == 2 * kPrintTuning.check_interval_frames);
  CHECK(last_frame_of_track(true) == 0);
}

TEST_CASE("limits without detection, or a model without a print, start nothing by themselves") {
  TrackerLimits none = without_detection(TrackerLimits{});
  Film film(sheet(), none);
  const Image picture = picture_of(posed(0.1f, 0.1f, 0, 1), kRest, 1);
  CHECK(film.show(picture) == Status::not_started);
  TrackerLimits faces;
  faces.detection = &kFaceDetection;
  Film other(sheet(), faces);
  CHECK(other.show(picture) == Status::not_started);
  TrackerLimits prints;
  prints.detection = &kPrintDetection;
  Film third(sheet(), prints);
  CHECK(third.show(picture) == Status::ok);
}

TEST_CASE("a print that repeats itself, and one without corners, give no table; boxes of many sizes give one") {
  const Folder folder("print_repeated");
  enum { board, empty, boxes };
  for (const int kind : {board, empty, boxes}) {
    CAPTURE(kind);
    Image picture(256, 256, 1);
    for (int y = 0; y < 256; ++y)
      for (int x = 0; x < 256; ++x) *picture.at(x, y) = kind == board && (x / 16 + y / 16) % 2 == 0 ? 30 : 220;
    Random random(4);
    for (int k = 0; kind == boxes && k < 30; ++k) {
      const int left = random.below(256), top = random.below(256), width = 8 + random.below(40),
                height = 8 + random.below(40), grey = random.below(256);
      for (int y = top; y < std::min(256, top + height); ++y)
        for (int x = left; x < std::min(256, left + width); ++x)
          *picture.at(x, y) = static_cast<std::uint8_t>(grey);
    }
    const std::string bytes = encode_png(picture), path = folder.put("print.png", bytes);
    bake::BakeOptions options;
    options.source = PLIANT_FIXTURES "/sheet/sheet.obj";
    options.size = 64;
    options.texture = path;
    std::vector<std::uint8_t> table;
    std::string error;
    REQUIRE_MESSAGE(bake::bake(options, table, error), error);
    CHECK(bake::OpenedTable(table).model().print().empty() == (kind != boxes));
  }
}

TEST_CASE("a damaged table is refused: cut anywhere, or with any bit turned") {
  const auto print = sheet().print();
  PrintTable table;
  REQUIRE(PrintTable::open(print, &table) == Status::ok);
  REQUIRE(table.keypoints().count >= 500);
  std::vector<std::uint32_t> words(print.count / 4 + 1);
  auto* const bytes = reinterpret_cast<std::uint8_t*>(words.data());
  std::memcpy(bytes, print.data, print.count);
  PrintTable other;
  for (std::size_t n = 0; n < print.count; ++n)
    CHECK_FALSE(PrintTable::open({bytes, n}, &other) == Status::ok);
  Random random(1);
  for (int k = 0; k < 2000; ++k) {
    const auto bit =
        static_cast<std::size_t>(random.below(static_cast<int>(k < 500 ? 24 * 8 : 8 * print.count)));
    bytes[bit / 8] ^= static_cast<std::uint8_t>(1u << bit % 8);
    CHECK_FALSE(PrintTable::open({bytes, print.count}, &other) == Status::ok);
    bytes[bit / 8] ^= static_cast<std::uint8_t>(1u << bit % 8);
  }
  CHECK_FALSE(other.is_open());
  CHECK(PrintTable::open({bytes + 1, print.count - 1}, &other) == Status::misaligned);
  CHECK(PrintTable::open({}, &other) == Status::not_found);
}

TEST_CASE("a table with numbers out of range but a right checksum is refused") {
  const auto print = sheet().print();
  std::vector<std::uint32_t> words(print.count / 4);
  auto* const bytes = reinterpret_cast<std::uint8_t*>(words.data());
  PrintTable other;
  const auto refuses = [&](auto&& change) {
    std::memcpy(bytes, print.data, print.count);
    auto* const header = reinterpret_cast<PrintHeader*>(bytes);
    change(*header, reinterpret_cast<float*>(bytes + sizeof(PrintHeader)),
           reinterpret_cast<PrintKeypoint*>(bytes + print.count) - 1);
    constexpr std::size_t kSummedFrom = offsetof(PrintHeader, keypoint_count);
    header->crc32 = crc32(bytes + kSummedFrom, print.count - kSummedFrom);
    return PrintTable::open({bytes, print.count}, &other) == Status::bad_table;
  };
  CHECK_FALSE(refuses([](PrintHeader&, float*, PrintKeypoint*) {}));
  CHECK(refuses([](PrintHeader& h, float*, PrintKeypoint*) { h.extent_mm = 0; }));
  CHECK(refuses([](PrintHeader& h, float*, PrintKeypoint*) { h.extent_mm = NAN; }));
  CHECK(refuses([](PrintHeader& h, float*, PrintKeypoint*) { h.reserved = 1; }));
  CHECK(refuses([](PrintHeader& h, float*, PrintKeypoint*) { h.keypoint_count = 0; }));
  CHECK(refuses([](PrintHeader&, float* q, PrintKeypoint*) { q[0] = 2; }));
  CHECK(refuses([](PrintHeader&, float* q, PrintKeypoint*) { q[1] = NAN; }));
  CHECK(refuses([](PrintHeader& h, float* q, PrintKeypoint*) { q[4 * h.view_count] = -1; }));
  CHECK(refuses(
      [](PrintHeader& h, float*, PrintKeypoint* k) { k->view = static_cast<std::uint8_t>(h.view_count); }));
  CHECK(refuses(
      [](PrintHeader& h, float*, PrintKeypoint* k) { k->level = static_cast<std::uint8_t>(h.level_count); }));
}

TEST_CASE(
    "a descriptor turns with the picture and stands gain, bias and noise; flat patches and borders have "
    "none") {
  Random random(9);
  Image image(41, 41, 1), turned(41, 41, 1);
  for (int k = 0; k < 40; ++k) {
    const int x = random.below(41), y = random.below(41), w = 2 + random.below(9), grey = random.below(256);
    for (int j = y; j < std::min(41, y + w); ++j)
      for (int i = x; i < std::min(41, x + w); ++i) *image.at(i, j) = static_cast<std::uint8_t>(grey);
  }
  for (int y = 0; y < 41; ++y)
    for (int x = 0; x < 41; ++x)
      *turned.at(40 - y, x) = static_cast<std::uint8_t>(*image.at(x, y) / 2 + 40 + random.below(5));
  const auto view = [](const Image& i) { return ImageView{i.pixels.data(), i.width, i.height, i.width}; };
  Descriptor a, b;
  for (const PatchScale scale : {PatchScale::whole, PatchScale::half}) {
    REQUIRE(describe(view(image), 20, 20, scale, &a));
    REQUIRE(describe(view(turned), 20, 20, scale, &b));
    CHECK(b.direction.x == doctest::Approx(double(-a.direction.y)).epsilon(0.05));
    CHECK(b.direction.y == doctest::Approx(double(a.direction.x)).epsilon(0.05));
    CHECK(distance_of(a.bits, b.bits) < 40);
  }
  const Image flat(41, 41, 1, 90);
  CHECK_FALSE(describe(view(flat), 20, 20, PatchScale::whole, &a));
  CHECK_FALSE(describe(view(image), descriptor_reach(PatchScale::whole) - 1, 20, PatchScale::whole, &a));
  CHECK_FALSE(describe(view(image), 20, 41 - descriptor_reach(PatchScale::whole), PatchScale::whole, &a));
  CHECK(describe(view(image), descriptor_reach(PatchScale::half), 20, PatchScale::half, &a));
  CHECK_FALSE(describe(view(image), 20, descriptor_reach(PatchScale::half) - 1, PatchScale::half, &a));
  const Image one(1, 1, 1, 90);
  CHECK_FALSE(describe(view(one), 0, 0, PatchScale::half, &a));
}

TEST_CASE(
    "a mirrored tilt shows a flat surface at the same place without perspective, and is its own inverse") {
  View view;
  view.q = posed(0.5f, -0.3f, 1.2f, 1).q;
  view.rho = kMinRho;
  const View other = mirrored_tilt(view, {});
  CHECK(length(log_rotation(other.q * conjugate(view.q))) > 0.5f);
  const Projector a(view, true), b(other, true);
  for (const Vec3 p : {Vec3{100, 0, 0}, Vec3{0, 80, 0}, Vec3{-50, 70, 0}}) {
    Vec2 x, y;
    REQUIRE(a.project(p, &x));
    REQUIRE(b.project(p, &y));
    CHECK(length(x - y) < 0.2f);
  }
  CHECK(length(log_rotation(mirrored_tilt(other, {}).q * conjugate(view.q))) < 1e-3f);
}


TEST_CASE("of views that lead to one fit only the one with most votes is kept") {
  const auto match = [](Vec2 uv, float turn, Vec2 off) {
    SurfaceMatch m;
    m.uv = uv;
    m.p = {200 * (uv.x - 0.5f), 200 * (uv.y - 0.5f), 0};
    m.q = exp_rotation({0, 0, turn});
    m.s = 0.5f;
    const Vec3 p = rotation_matrix(m.q) * Vec3{m.p.x, -m.p.y, -m.p.z};
    m.x = Vec2{kCamera.cx, kCamera.cy} + m.s * Vec2{p.x, p.y} + off;
    return m;
  };
  std::vector<SurfaceMatch> matches;
  for (int k = 0; k < 9; ++k) {
    const Vec2 uv{0.1f + 0.1f * static_cast<float>(k), 0.3f + 0.05f * static_cast<float>(k % 4)};
    matches.push_back(match(uv, 0.2f, {20, 10}));
    if (k % 2 == 0) matches.push_back(match(uv, -2, {-40, 0}));
  }
  ViewVotes views[3];
  std::vector<std::uint16_t> order(matches.size());
  ScaledMatches scaled{{matches.data(), matches.size()}, {order.data(), order.size()}};
  scaled.sort();
  std::size_t count = 0;
  for (std::size_t k = 0; k < matches.size(); ++k)
    CHECK(vote_for_view(scaled, k, kCamera, 20, {views, 3}, &count) == matches.size());
  REQUIRE(count == 2);
  CHECK(views[0].votes == 9);
  CHECK(views[1].votes == 5);
  CHECK(length(log_rotation(views[0].view.q * conjugate(exp_rotation({0, 0, 0.2f})))) < 1e-3f);
  CHECK_FALSE(is_similar(matches[views[0].match], matches[views[1].match]));
}

TEST_CASE("matches that suggest another scale are not compared") {
  std::vector<SurfaceMatch> matches(9);
  for (std::size_t k = 0; k < matches.size(); ++k) {
    matches[k].p = {10.0f * static_cast<float>(k), 0, 0};
    matches[k].s = k % 3 == 0 ? 2.0f : k % 3 == 1 ? 0.5f : 0.51f;
  }
  std::uint16_t order[9];
  ScaledMatches scaled{{matches.data(), matches.size()}, {order, matches.size()}};
  scaled.sort();
  for (std::size_t k = 1; k < matches.size(); ++k) CHECK(scaled[k - 1].s <= scaled[k].s);
  ViewVotes views[3];
  std::size_t count = 0;
  CHECK(vote_for_view(scaled, 0, kCamera, 20, {views, 3}, &count) == 6);
  CHECK(vote_for_view(scaled, 8, kCamera, 20, {views, 3}, &count) == 3);
}

TEST_CASE("the distance of two descriptors is the number of bits that differ") {
  std::uint32_t a[kDescriptorWords] = {}, b[kDescriptorWords] = {};
  Random random(3);
  for (int k = 0; k < kDescriptorWords; ++k)
    a[k] = b[k] = static_cast<std::uint32_t>(random.below(1 << 30)) * 5;
  for (int count = 0; count < 32 * kDescriptorWords; ++count) {
    CHECK(distance_of(a, b) == count);
    const int bit = 37 * count % (32 * kDescriptorWords);
    b[bit / 32] ^= 1u << bit % 32;
  }
  CHECK(distance_of(a, b) == 32 * kDescriptorWords);
}

TEST_CASE(
    "a view is fitted tilted to the other side where a fifth of its blocks agree, not where its fit failed") {
  CHECK(is_promising({48, 12}));
  CHECK(is_promising({5, 1}));
  CHECK_FALSE(is_promising({48, 9}));
  CHECK_FALSE(is_promising({48, 0}));
  CHECK_FALSE(is_promising({}));
}

TEST_CASE("the smallest and the longest frames are searched without harm, longer ones are not searched") {
  constexpr int kSizes[][2] = {{64, 64}, {8192, 64}, {64, 8192}, {8193, 64}};
  for (const auto& [width, height] : kSizes) {
    TrackerLimits limits;
    limits.width = static_cast<std::uint16_t>(width);
    limits.height = static_cast<std::uint16_t>(height);
    limits.search_work = 100000;
    Film film(sheet(), limits);
    Random random(2);
    Image image(width, height, 1);
    for (std::uint8_t& p : image.pixels) p = static_cast<std::uint8_t>(random.below(256));
    const bool is_searched = width <= 8192;
    for (int k = 0; k < 3; ++k) CHECK(film.show(image) == (is_searched ? Status::ok : Status::not_started));
    CHECK_FALSE(film.tracker->is_started());
    if (is_searched) CHECK(film.show(Image(1, 1, 1)) == Status::size_mismatch);
  }
}

TEST_CASE("a model with a damaged print, or with a print but no albedo, is not searched for, and tracks without harm") {
  const Image picture = picture_of(posed(0.1f, 0.1f, 0, 1), kRest, 1);
  for (const bool has_albedo : {true, false}) {
    AlignedTable changed(sheet_bytes());
    std::uint8_t* const bytes = changed.bytes();
    table::Header header;
    std::memcpy(&header, bytes, sizeof header);
    for (std::uint32_t k = 0; k < header.section_count; ++k) {
      table::Section s;
      std::memcpy(&s, bytes + sizeof header + k * sizeof s, sizeof s);
      if (has_albedo && s.kind == table::Kind::print) bytes[s.offset + 100] ^= 1;
      if (!has_albedo && s.kind == table::Kind::albedo) s.kind = table::Kind::detector;  // bytes of no meaning
      std::memcpy(bytes + sizeof header + k * sizeof s, &s, sizeof s);
    }
    header.crc32 = crc32(bytes + 16, header.total_bytes - 16);
    std::memcpy(bytes, &header, sizeof header);
    Model model;
    REQUIRE(Model::open(changed.data(), header.total_bytes, &model) == Status::ok);
    Film film(model);
    CHECK(film.show(picture) == (has_albedo ? Status::bad_checksum : Status::bad_table));
    FrameView view{picture.pixels.data(), kWidth, kHeight, std::size_t{kWidth}, 1, 1, 1};
    film.count = 1;
    REQUIRE(film.tracker->start_from_pose(view, kCamera, posed(0.1f, 0.1f, 0, 1), nullptr) == Status::ok);
    for (int k = 0; k < 4; ++k) CHECK(film.show(picture) == Status::ok);
    CHECK(film.result.state == TrackState::tracking);
  }
}

}  // namespace print_start_test
