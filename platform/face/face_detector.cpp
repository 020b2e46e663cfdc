#include "pliant/face_detector.hpp"

#include "base/integers.hpp"
#include "face/box_selection.hpp"
#include "face/cell_strip.hpp"
#include "face/detector_table.hpp"
#include "face/search_place.hpp"
#include "pliant/model.hpp"

namespace pliant {

struct FaceDetector::State {
  DetectorTable table;
  CellStrip strip;
  BoxHits hits;
  SearchPlace place;
  bool strip_is_of_other = false;  // than the search in parts

  int least_sum() const { return table.trees()[table.trees().count - 1].rejection; }
  void search_windows(const SearchPlace& at);
  std::uint32_t step(const FrameView& frame);
  std::size_t select(Span<DetectedFace> room);
};

void FaceDetector::lay_out(Arena& arena, const Span<const std::uint8_t>& table,
                           const FaceDetectorLimits& limits) {
  limits_ = limits;
  State unused;
  state_ = arena.make<State>();
  State& state = state_ == nullptr ? unused : *state_;
  status_ = DetectorTable::open(table, &state.table);
  state.strip.lay_out(arena, SearchPlace::most_columns(limits.width));
  state.hits.lay_out(arena, larger(int{limits.hits}, 1));
}

// All windows of the strip's last row of windows.
void FaceDetector::State::search_windows(const SearchPlace& at) {
  for (int k = 0; k + kWindowCells <= at.columns(); ++k) {
    const int sum = sum_of_trees(table.trees(), strip.window(k), strip.stride());
    if (sum != kRejected) hits.add({at.box(k, strip.next_row() - kWindowCells), sum});
  }
}

// Searches one more row. \return the cells computed.
std::uint32_t FaceDetector::State::step(const FrameView& frame) {
  const ScaledLines lines(frame, place.ratio());
  if (place.begins_strip() || strip_is_of_other) {
    // Where another search was between, the rows of cells above this one are computed again.
    const int above = place.row() - (kWindowCells - 1);
    strip.begin(place.first_column(), place.columns(), larger(above, place.first_row()));
    while (strip.next_row() < place.row()) strip.add_row(lines);
    strip_is_of_other = false;
  }
  strip.add_row(lines);
  if (strip.rows() >= kWindowCells) search_windows(place);
  const std::uint32_t cells = static_cast<std::uint32_t>(place.columns());
  place.advance();
  return cells;
}

std::size_t FaceDetector::State::select(Span<DetectedFace> room) {
  std::size_t count = 0;
  while (count < room.count && !hits.empty()) {
    const BoxHit hit = hits.take_best(least_sum());
    room[count++] = {hit.box, table.probability(hit.sum)};
  }
  return count;
}

Status FaceDetector::check_input(const FrameView& frame, Span<DetectedFace> room,
                                 const std::size_t* count) const {
  if (status_ != Status::ok) return status_;
  if (state_ == nullptr || count == nullptr || (room.data == nullptr && room.count > 0))
    return Status::bad_argument;
  const Status status = check(frame);
  if (status != Status::ok) return status;
  return frame.width <= limits_.width && frame.height <= limits_.height && frame.width <= kLargestFramePx &&
                 frame.height <= kLargestFramePx
             ? Status::ok
             : Status::size_mismatch;
}

Status FaceDetector::find(const FrameView& frame, Span<DetectedFace> room, std::size_t* count) {
  const Status status = check_input(frame, room, count);
  if (status != Status::ok) return status;
  state_->hits.clear();
  state_->place.begin(frame.width, frame.height, limits_.smallest_px);
  while (!state_->place.is_complete()) state_->step(frame);
  *count = state_->select(room);
  return Status::ok;
}

Status FaceDetector::search(const FrameView& frame, std::uint32_t work, Span<DetectedFace> room,
                            std::size_t* count, bool* is_complete) {
  if (is_complete == nullptr) return Status::bad_argument;
  const Status status = check_input(frame, room, count);
  if (status != Status::ok) return status;
  State& s = *state_;
  s.hits.clear();
  if (s.place.is_complete() || !s.place.is_of(frame.width, frame.height))
    s.place.begin(frame.width, frame.height, limits_.smallest_px);
  std::uint32_t done = 0;
  do done += s.place.is_complete() ? work : s.step(frame);
  while (done < work && !s.place.is_complete());
  *is_complete = s.place.is_complete();
  *count = s.select(room);
  return Status::ok;
}

Status FaceDetector::search_near(const FrameView& frame, const FaceBox& box, DetectedFace* face) {
  std::size_t count = 0;
  const Status status = check_input(frame, {face, 1}, &count);
  if (status != Status::ok) return status;
  const float most = 2 * kLargestFramePx;
  if (!(box.side > 0 && box.side < most && magnitude(box.center.x) < most && magnitude(box.center.y) < most))
    return Status::bad_argument;
  State& s = *state_;
  s.hits.clear();
  const SearchPlace of_parts = s.place;
  s.place.begin_near(frame.width, frame.height, limits_.smallest_px, box);
  while (!s.place.is_complete()) s.step(frame);
  s.place = of_parts;
  s.strip_is_of_other = true;
  return s.select({face, 1}) > 0 ? Status::ok : Status::not_found;
}

}  // namespace pliant
