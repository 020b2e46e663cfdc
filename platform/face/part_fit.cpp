#include "face/part_fit.hpp"

#include "base/arrays.hpp"

namespace pliant {

namespace {

constexpr const PartFitTuning& kTuning = kPartFitTuning;
constexpr std::size_t kShift = 2;  // unknowns before the parameters
constexpr Vec2 kAxes[kShift] = {{1, 0}, {0, 1}};

/// Between the lids of a side, mm; 0 of a part that is no eye. \param mm  of all points, upright crop.
float gap_of(const PartPoints& points, const PartSide& side, const Vec2* mm) {
  float gap = 0;
  for (std::size_t k = side.first; k < side.first + side.count; ++k) gap -= points.in_gap(k) * mm[k].y;
  return gap;
}

/// Whether x lies in the frame, that far from its edge. \param x  px, its y divided by the aspect.
bool is_within(const FrameView& frame, float aspect, Vec2 x, float from_edge) {
  return x.x >= from_edge && x.y >= from_edge && x.x + from_edge < static_cast<float>(frame.width) &&
         aspect * (x.y + from_edge) < static_cast<float>(frame.height);
}

}  // namespace

void PartFit::lay_out(Arena& arena, const Model& model) {
  const std::size_t parameters = model.parameters().count, unknowns = kMostPartParameters + kShift;
  cascade_.lay_out(arena, model);
  equations_.lay_out(arena, unknowns);
  reader_.lay_out(arena);
  readings_ = arena.take<PartReading>(kMostPartReadings);
  read_mm_ = arena.take<Vec2>(kMostPartReadings);
  q_ = arena.take<float>(parameters);
  step_ = arena.take<float>(unknowns);
  samples_ = arena.take<Vec3>(model.cascade().count);
  opens_mm_ = arena.take<float>(parameters);
  is_free_ = arena.take<std::uint8_t>(parameters);
  row_.lay_out(arena, unknowns);
}

Vec3 PartFit::evaluate(Vec2 uv, Jacobian* j) {
  cascade_.sample_point(uv, q_, samples_);
  return cascade_.evaluate(samples_, q_, j);
}

Vec2 PartFit::project(Vec2 uv) {
  Vec2 x = view_.c;
  Projector(view_, true).project(cascade_.surface_point(uv, q_), &x);
  return x;
}

void PartFit::read(const FrameView& frame, const Lens& lens, const View& view, const float* q, float centring,
                   PartPoints* points) {
  view_ = view;
  view_.c.y /= lens.aspect();
  lens_ = lens.of_square_pixels();
  reader_.set_aspect(lens.aspect());
  axes_ = upright(view_);
  copy(q, cascade_.parameter_count(), q_);
  points->are_seen = true;
  for (std::size_t s = 0; s < points->side_count; ++s) {
    PartSide& side = points->side[s];
    const PartRecord& part = points->table[side.part];
    const Vec2 middle = 0.5f * (project(side.anchor[0]) + project(side.anchor[1]));
    const CropMap map = crop_of_part(part, view_, lens_.distort(middle) + axes_.along(side.centre_mm));
    side.is_seen = is_within(frame, lens.aspect(), map.origin, kTuning.least_room_mm * view_.s);
    if (!side.is_seen) {
      points->are_seen = false;
      continue;
    }
    reader_.read(frame, points->table, side.part, map, side.is_left, readings_ + side.first);
    const Vec2 centre = side.centre_mm + centring * off_centre(points->table, side);
    side.centre_mm = min(1, kTuning.most_off_centre_mm / max(length(centre), 1e-3f)) * centre;
  }
  for (std::size_t k = 0; k < points->count; ++k) {
    readings_[k].x = lens_.undistort(readings_[k].x);
    read_mm_[k] = axes_.to_crop(readings_[k].x);
  }
}

/// How far the anchors were just read from where they usually are in a crop, mm. One that the part does not read is in its place.
Vec2 PartFit::off_centre(const PartTable& table, const PartSide& side) const {
  const PartRecord& part = table[side.part];
  const float* const start = table.shape(side.part).start;
  Vec2 off;
  for (std::size_t k = 0; k < side.count; ++k)
    if (part.number[k] == part.anchor[0] || part.number[k] == part.anchor[1])
      off = off + 0.5f * (reader_.read_mm()[k] - Vec2{start[2 * k], start[2 * k + 1]});
  return {side.is_left ? -off.x : off.x, off.y};
}

/// \return false: the part is no eye.
bool PartFit::read_eye(const PartPoints& points, const PartSide& side, SeenEye* eye) {
  const PartRecord& part = points.table[side.part];
  bool has_pupil = false;
  eye->lid_mm = 0;
  for (std::size_t n = 0; n < side.count; ++n) {
    const std::size_t k = side.first + n;
    float weight = points.lid[k] > 0 ? -0.5f : 0.0f;
    if (part.number[n] == kPupilRight) eye->pupil = readings_[k].x, has_pupil = true, weight = 1;
    eye->lid_mm += weight * read_mm_[k].y;
  }
  eye->opening_mm = gap_of(points, side, read_mm_);
  // The eye is where its corners are read; up and down, where they are read less exactly, in part.
  eye->pupil = eye->pupil - axes_.along({side.centre_mm.x, kGazeTuning.corner_weight * side.centre_mm.y});
  eye->corners =
      0.5f * (cascade_.surface_point(side.anchor[0], q_) + cascade_.surface_point(side.anchor[1], q_));
  return has_pupil;
}

Vec3 PartFit::gaze(const PartPoints& points) {
  if (!points.are_seen) return {};
  SeenEye eyes[2 * kMostParts];
  std::size_t count = 0;
  for (std::size_t s = 0; s < points.side_count; ++s)
    if (read_eye(points, points.side[s], &eyes[count])) ++count;
  return find_gaze({eyes, count}, view_);
}

/// Which parameters move a side's points far enough, and how they open its eye.
void PartFit::sense_parameters(const PartPoints& points, const PartSide& side) {
  const Span<const Parameter> all = cascade_.model().parameters();
  for (std::size_t k = side.first; k < side.first + side.count; ++k) {
    if (!points.is_fitted(k)) continue;
    const float weight = side.is_left ? -points.in_gap(k) : points.in_gap(k);
    Jacobian j;
    evaluate(points.uv[k], &j);
    for (std::size_t c = 0; c < j.count; ++c) {
      const std::uint16_t p = cascade_.parameter_of(j.list[c]);
      const Vec3& column = j.column[j.list[c]];
      if ((all[p].maximum - all[p].minimum) * length(column) > kTuning.least_range_mm) is_free_[p] = 1;
      opens_mm_[p] += weight * column.y;
    }
  }
}

void PartFit::choose_parameters(PartPoints* points) {
  const std::size_t all = cascade_.parameter_count();
  cascade_.set_free(Group::expression);
  for (std::size_t k = 0; k < all; ++k) is_free_[k] = 0, opens_mm_[k] = 0;
  for (std::size_t s = 0; s < points->side_count; ++s) sense_parameters(*points, points->side[s]);
  std::size_t count = 0;
  for (std::size_t k = 0; k < all && count < kMostPartParameters; ++k)
    if (is_free_[k] != 0) {
      points->last[count] = q_[k];
      points->sd[count] = 0;
      points->opens_mm[count] = opens_mm_[k];
      points->parameter[count++] = static_cast<std::uint16_t>(k);
    }
  points->parameter_count = count;
}

/// Gives the parameters of the parts these values.
void PartFit::set(const float* values, const PartPoints& points) {
  for (std::size_t n = 0; n < points.parameter_count; ++n) q_[points.parameter[n]] = values[n];
}

/// Whether no point would move far if the parameters had these values instead of the fitted ones.
bool PartFit::is_near(float mm, const float* values, const PartPoints& points) {
  for (std::size_t k = 0; k < points.count; ++k) {
    if (!points.is_fitted(k)) continue;
    set(points.last, points);
    const Vec3 fitted = cascade_.surface_point(points.uv[k], q_);
    set(values, points);
    if (length(cascade_.surface_point(points.uv[k], q_) - fitted) > mm) return false;
  }
  return true;
}

/// How the readings differ from the model with these values, which are the person's from now on.
void PartFit::note_offsets(const float* values, PartPoints* points) {
  if (!points->are_seen) return;
  set(values, *points);
  for (std::size_t k = 0; k < points->count; ++k)
    if (points->is_fitted(k)) points->offset_mm[k] = read_mm_[k] - axes_.to_crop(project(points->uv[k]));
  for (std::size_t s = 0; s < points->side_count; ++s)
    points->side[s].open_mm = gap_of(*points, points->side[s], read_mm_);
  for (std::size_t n = 0; n < points->parameter_count; ++n) points->last[n] = points->start[n] = values[n];
  points->is_calibrated = true;
}

void PartFit::calibrate(PartPoints* points) {
  choose_parameters(points);
  float values[kMostPartParameters];
  copy(points->last, points->parameter_count, values);
  for (Vec2& offset : points->offset_mm) offset = {};
  for (float& start : points->start) start = 0;
  points->is_calibrated = false;
  solve(kTuning.start_s, points);
  if (is_near(kTuning.contradiction_mm, values, *points)) note_offsets(values, points);
}

/// What of the offset between the lids is left out where they are not as open as when it was noted, mm: lids that meet have none.
float PartFit::shut_offset(const PartPoints& points, const PartSide& side) const {
  if (!points.is_calibrated || !(side.open_mm > 0)) return 0;
  const float open = clamp(gap_of(points, side, read_mm_) / side.open_mm, 0, 1);
  return (1 - open) * gap_of(points, side, points.offset_mm);
}

/// The rows of a side's readings.
void PartFit::add_readings(const PartPoints& points, const PartSide& side) {
  if (!side.is_seen) return;
  const Projector projector(view_, true);
  const float shut = shut_offset(points, side);
  for (std::size_t k = side.first; k < side.first + side.count; ++k) {
    if (!points.is_fitted(k)) continue;
    Jacobian j;
    Projector::Derivatives d;
    Vec2 x;
    if (!projector.project(evaluate(points.uv[k], &j), &x, &d)) continue;
    const Vec2 offset = points.offset_mm[k] + Vec2{0, shut * points.in_gap(k)};
    const Vec2 target = readings_[k].x - axes_.along(offset);
    row_.add_to(equations_, {kAxes, kShift}, d, j, target - x, readings_[k].information);
  }
}

/// One Gauss-Newton step of a common shift and the parameters.
void PartFit::step(float seconds, const PartPoints& points) {
  const std::size_t unknowns = kShift + points.parameter_count;
  equations_.reset(unknowns);
  for (std::size_t s = 0; s < points.side_count; ++s) add_readings(points, points.side[s]);
  const float shift_px = kTuning.shift_mm * view_.s;
  for (std::size_t n = 0; n < kShift; ++n) equations_.add_prior(n, 0, 1 / (shift_px * shift_px));
  for (std::size_t n = 0; n < points.parameter_count; ++n) {
    const std::uint16_t k = points.parameter[n];
    const Parameter& p = cascade_.model().parameters()[k];
    const float range = p.maximum - p.minimum, change = kTuning.change * range * 30 * seconds;
    const bool shuts = range * magnitude(points.opens_mm[n]) > kTuning.shutting_mm;
    add_prior(p, q_[k], shuts ? kTuning.shutting_prior : 1, kShift + n, equations_);
    equations_.add_prior(kShift + n, points.last[n] - q_[k], 1 / (change * change));
  }
  add_symmetry(points);
  equations_.solve(0, step_);
  for (std::size_t n = 0; n < points.parameter_count; ++n) {
    const std::uint16_t k = points.parameter[n];
    q_[k] = stepped(cascade_.model().parameters()[k], q_[k], step_[kShift + n]);
  }
}

/// Both eyes open and shut alike, the more so the more alike they were in the last frame.
void PartFit::add_symmetry(const PartPoints& points) {
  float now = 0, before = 0;  // mm
  for (std::size_t n = 0; n < points.parameter_count; ++n) {
    const float mm = points.opens_mm[n];
    now += mm * (q_[points.parameter[n]] - points.start[n]);
    before += mm * (points.last[n] - points.start[n]);
    row_.unknown[n] = static_cast<std::uint16_t>(kShift + n);
    row_.column[n] = {mm, 0};
  }
  const float variance = kTuning.unlike_mm * kTuning.unlike_mm + before * before;
  equations_.add(row_.unknown, row_.column, points.parameter_count, {-now, 0}, {1 / variance, 0, 0});
}

/// Fits the parameters and keeps them. \return false: they are as before.
bool PartFit::solve(float seconds, PartPoints* points) {
  for (std::size_t k = 0; k < cascade_.parameter_count(); ++k) is_free_[k] = 0;
  for (std::size_t n = 0; n < points->parameter_count; ++n) is_free_[points->parameter[n]] = 1;
  set(points->last, *points);
  cascade_.set_free(is_free_);
  step(seconds, *points);  // One is enough: the lids' motion is nearly linear (docs/experiments.md, Lids).
  equations_.variances(step_);
  for (std::size_t n = 0; n < points->parameter_count; ++n)
    if (!is_finite(q_[points->parameter[n]]) || !(step_[kShift + n] > 0)) return false;
  for (std::size_t n = 0; n < points->parameter_count; ++n) {
    points->last[n] = q_[points->parameter[n]];
    points->sd[n] = kTuning.trusted_sd * square_root(step_[kShift + n]);
  }
  return true;
}

void PartFit::fit(float seconds, PartPoints* points) {
  static constexpr float kRest[kMostPartParameters] = {};
  if (solve(seconds, points) && !points->is_calibrated && is_near(kTuning.rest_mm, kRest, *points))
    note_offsets(kRest, points);
}

}  // namespace pliant
