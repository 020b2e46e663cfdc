#include "print/print_matcher.hpp"

#include "base/arrays.hpp"
#include "base/integers.hpp"
#include "pliant/corners.hpp"
#include "print/distinct_best.hpp"
#include "print/print_tuning.hpp"

namespace pliant {

namespace {

constexpr const PrintTuning& kTuning = kPrintTuning;

/// Room for the corners of a level, in the first place of all.
std::size_t room_of(int level) {
  return kTuning.corners >> level;
}

/// Corners among which those of a level are chosen, the strongest first: at most one a cell.
std::size_t candidates_of(int level, int width, int height) {
  const int cell = kTuning.corner_cell_px;
  const auto cells = static_cast<std::size_t>(corner_cells(width, cell) * corner_cells(height, cell));
  const std::size_t room = room_of(level);
  return smaller(larger(cells, room), kTuning.corner_candidates * room);
}

std::size_t all_room() {
  std::size_t all = room_of(0);  // those of the first level are described twice
  for (int level = 0; level < kTuning.levels; ++level) all += room_of(level);
  return all;
}

/// Moves the corners of a choice to the front: of each tile of the frame as many as of any other, as far as there are some, then
/// the strongest of the others. \return their number, at most `most`.
std::size_t spread_corners(const ImageView& image, Span<Corner> corners, std::size_t most) {
  if (corners.count <= most) return corners.count;
  constexpr std::size_t kTiles = kTuning.corner_tiles;
  std::size_t taken[kTiles * kTiles] = {};
  const std::size_t each = most / (kTiles * kTiles) + 1;
  std::size_t count = 0;
  for (std::size_t k = 0; k < corners.count && count < most; ++k) {
    const auto tile_of = [](float x, int size) {
      return static_cast<std::size_t>(x) * kTiles / static_cast<std::size_t>(size);
    };
    std::size_t& of_tile =
        taken[tile_of(corners[k].x.y, image.height) * kTiles + tile_of(corners[k].x.x, image.width)];
    if (of_tile == each) continue;
    ++of_tile;
    const Corner chosen = corners[k];  // those passed over stay in their order
    for (std::size_t i = k; i > count; --i) corners[i] = corners[i - 1];
    corners[count++] = chosen;
  }
  return most;
}

const std::uint8_t* copy_of(const std::uint8_t* data, std::size_t count, Arena& arena) {
  const Span<std::uint8_t> bytes = arena.take_span<std::uint8_t>(count);
  copy(data, count, bytes.data);
  return bytes.data;
}

}  // namespace

void PrintMatcher::lay_out(Arena& arena, const PrintTable& table, int width, int height) {
  table_ = table;
  PyramidLimits limits;
  limits.width = width;
  limits.height = height;
  limits.levels = kTuning.levels;
  pyramid_.lay_out(arena, limits);
  scratch_ = arena.take_span<unsigned char>(corner_scratch_bytes(width, height, print_corner_options()) +
                                            candidates_of(0, width, height) * sizeof(Corner) +
                                            2 * Arena::kAlignment);
  corners_ = arena.take_span<FrameCorner>(all_room());
  matches_ = arena.take_span<PrintMatch>(most_matches());
}

Status PrintMatcher::begin(const FrameView& frame, CornerChoice choice) {
  const Status status = pyramid_.build(frame);
  if (status != Status::ok) return status;
  corner_count_ = match_count_ = next_corner_ = 0;
  next_level_ = 0;
  choice_ = choice;
  is_searching_ = true;
  return status;
}

SmallPictures PrintMatcher::move_on(const FrameView& now) {
  const int level = pyramid_.levels() - 1;
  const ImageView& small = pyramid_.level(level);
  Arena scratch(scratch_.data, scratch_.count);
  const std::size_t pixels = static_cast<std::size_t>(small.width * small.height);
  const ImageView before{copy_of(small.data, pixels, scratch), small.width, small.height, small.width};
  const Status status = pyramid_.build(now);  // else it stays as it is
  (void)status;
  return {before, small, static_cast<float>(1 << level)};
}

std::size_t PrintMatcher::most_matches() {
  return kTuning.matches_per_corner * all_room();
}

std::uint32_t PrintMatcher::step() {
  if (next_level_ < pyramid_.levels()) return find_corners_of(next_level_++);
  if (next_corner_ < corner_count_) {
    match(next_corner_++);
    return static_cast<std::uint32_t>(table_.keypoints().count) / kTuning.keypoints_per_cell + 1;
  }
  is_searching_ = false;
  return 0;
}

std::uint32_t PrintMatcher::find_corners_of(int level) {
  const ImageView& image = pyramid_.level(level);
  Arena scratch(scratch_.data, scratch_.count);
  const Span<Corner> room = scratch.take_span<Corner>(
      choice_ == CornerChoice::spread ? candidates_of(level, image.width, image.height) : room_of(level));
  int found = 0;
  const Status status = find_corners(image, print_corner_options(), {}, scratch, room, found);
  if (status != Status::ok) found = 0;
  if (choice_ == CornerChoice::spread)
    found =
        static_cast<int>(spread_corners(image, {room.data, static_cast<std::size_t>(found)}, room_of(level)));
  const auto to_frame = static_cast<float>(1 << level);
  for (int k = 0; k < found; ++k) {
    const Vec2 x = room[static_cast<std::size_t>(k)].x;
    add_corner(image, x, PatchScale::whole, to_frame);
    if (level == 0) add_corner(image, x, PatchScale::half, to_frame);
  }
  return static_cast<std::uint32_t>(image.width * image.height) / kTuning.pixels_per_cell +
         kTuning.cells_per_descriptor * static_cast<std::uint32_t>(found);
}

void PrintMatcher::add_corner(const ImageView& image, Vec2 x, PatchScale patch, float to_frame) {
  FrameCorner& corner = corners_[corner_count_];
  if (!describe(image, static_cast<int>(x.x), static_cast<int>(x.y), patch, &corner.descriptor)) return;
  corner.x = to_frame * x;
  corner.scale = patch == PatchScale::half ? 0.5f * to_frame : to_frame;
  ++corner_count_;
}

/// Keeps the nearest keypoints of different places of the surface, as far as they are near enough.
void PrintMatcher::match(std::size_t corner) {
  struct Near {
    std::size_t keypoint;
    int distance;
  };
  const auto& bits = corners_[corner].descriptor.bits;
  const Span<const PrintKeypoint> keypoints = table_.keypoints();
  constexpr std::size_t kMost = kTuning.matches_per_corner;
  Near nearest[kMost];
  std::size_t count = 0;
  for (std::size_t k = 0; k < keypoints.count; ++k) {
    const int most = count < kMost ? kTuning.most_distance + 1 : nearest[kMost - 1].distance;
    const int distance = distance_of(bits, keypoints[k].bits);
    if (distance >= most) continue;
    insert_distinct(
        Span<Near>{nearest, kMost}, &count, {k, distance},
        [](const Near& a, const Near& b) { return a.distance < b.distance; },
        [&](const Near& a, const Near& b) {
          return length(keypoints[a.keypoint].uv() - keypoints[b.keypoint].uv()) < kTuning.same_place;
        });
  }
  for (std::size_t i = 0; i < count; ++i)
    matches_[match_count_++] = {static_cast<std::uint16_t>(corner),
                                static_cast<std::uint16_t>(nearest[i].keypoint)};
}

}  // namespace pliant
