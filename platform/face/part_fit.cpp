#include "face/part_fit.hpp"

#include "base/arrays.hpp"
#include "face/ibug_landmarks.hpp"

namespace pliant {

namespace {

constexpr const PartFitTuning& kTuning = kPartFitTuning;
constexpr std::size_t kShift = 2;  // unknowns before the parameters
constexpr Vec2 kAxes[kShift] = {{1, 0}, {0, 1}};

/// Weight of a point's height in that of the upper lid, and in the gap between the lids.
float weight_in_lid(int number) {
  return number == 37 || number == 38 ? 0.5f : 0.0f;
}
float weight_in_gap(int number) {
  return number == 40 || number == 41 ? -0.5f : weight_in_lid(number);
}

/// Of the crop's axes in px of the frame a millimetre.
CropMap upright(const View& view) {
  PartRecord record{};
  record.mm_per_px = 1;
  record.crop_px = 1;
  return crop_of_part(record, view, {});
}

}  // namespace

Status PartPoints::open(const Model& model) {
  side_count = count = parameter_count = 0;
  const Status status = PartTable::open(model.parts(), &table);
  if (status != Status::ok) return status;
  for (std::size_t k = 0; k < table.count(); ++k)
    for (int left = 0; left <= table[k].is_paired; ++left) {
      if (count + table[k].point_count > kMostPartReadings) return Status::capacity;
      PartSide& s = side[side_count];
      s = {static_cast<std::uint8_t>(k),
           table[k].point_count,
           left != 0,
           static_cast<std::uint16_t>(count),
           {},
           {}};
      const auto of_side = [&](int number) { return left != 0 ? mirrored_part_point(number) : number; };
      for (int a = 0; a < 2; ++a) {
        const std::uint16_t anchor = find_ibug(model, of_side(table[k].anchor[a]));
        if (anchor == kNone) return Status::not_found;
        s.anchor[a] = model.landmarks()[anchor].uv();
      }
      for (std::size_t p = 0; p < s.count; ++p, ++count) {
        landmark[count] = find_ibug(model, of_side(table[k].number[p]));
        uv[count] = is_fitted(count) ? model.landmarks()[landmark[count]].uv() : s.anchor[0];
      }
      ++side_count;
    }
  return Status::ok;
}

void PartPoints::move(const View& view, const Vec3* moved) {
  const CropMap axes = upright(view);
  const Projector projector(view, true);
  for (std::size_t k = 0; k < count; ++k) {
    if (!is_fitted(k)) continue;
    const Vec3 by = projector.rotated(moved[landmark[k]]);
    offset_mm[k] = offset_mm[k] + axes.to_crop(view.s * Vec2{by.x, by.y});
  }
}

void PartFit::lay_out(Arena& arena, const Model& model) {
  const std::size_t parameters = model.parameters().count, unknowns = kMostPartParameters + kShift;
  cascade_.lay_out(arena, model);
  equations_.lay_out(arena, unknowns);
  reader_.lay_out(arena);
  readings_ = arena.take<PartReading>(kMostPartReadings);
  q_ = arena.take<float>(parameters);
  step_ = arena.take<float>(unknowns);
  samples_ = arena.take<Vec3>(model.cascade().count);
  is_free_ = arena.take<std::uint8_t>(parameters);
  row_.lay_out(arena, unknowns);
}

Vec2 PartFit::project(Vec2 uv) {
  Vec2 x = view_.c;
  Projector(view_, true).project(cascade_.surface_point(uv, q_), &x);
  return lens_.distort(x);
}

void PartFit::read(const FrameView& frame, const Lens& lens, const View& view, const float* q, float centring,
                   PartPoints* points) {
  view_ = view;
  view_.c.y /= lens.aspect();
  lens_ = lens.of_square_pixels();
  reader_.set_aspect(lens.aspect());
  copy(q, cascade_.parameter_count(), q_);
  for (std::size_t s = 0; s < points->side_count; ++s) {
    PartSide& side = points->side[s];
    const PartRecord& part = points->table[side.part];
    CropMap map = crop_of_part(part, view_, 0.5f * (project(side.anchor[0]) + project(side.anchor[1])));
    map.origin = map.origin + map.along((1 / part.mm_per_px) * side.centre_mm);
    if (!is_finite(map.origin + map.right)) continue;
    reader_.read(frame, points->table, side.part, map, side.is_left, readings_ + side.first);
    const Vec2 off = off_centre(map, points->table, side);
    if (!is_finite(off)) continue;
    const Vec2 centre = side.centre_mm + centring * off;
    side.centre_mm = min(1, kTuning.most_off_centre_mm / max(length(centre), 1e-3f)) * centre;
  }
}

/// How far the anchors are read from where they usually are in a crop, mm; 0 if the part does not read them.
Vec2 PartFit::off_centre(const CropMap& map, const PartTable& table, const PartSide& side) const {
  const PartRecord& part = table[side.part];
  const float* const start = table.shape(side.part).start;
  const float half = 0.5f * static_cast<float>(part.crop_px - 1);
  Vec2 sum;
  float n = 0;
  for (std::size_t k = 0; k < side.count; ++k) {
    if (part.number[k] != part.anchor[0] && part.number[k] != part.anchor[1]) continue;
    const Vec2 read = part.mm_per_px * (map.to_crop(readings_[side.first + k].x) - Vec2{half, half});
    sum = sum + read - Vec2{side.is_left ? -start[2 * k] : start[2 * k], start[2 * k + 1]};
    ++n;
  }
  return n > 0 ? (1 / n) * sum : Vec2{};
}

/// \return false: the part is no eye.
bool PartFit::read_eye(const PartPoints& points, const PartSide& side, SeenEye* eye) {
  const PartRecord& part = points.table[side.part];
  const CropMap axes = upright(view_);
  Vec2 lids, upper;  // from the upper to the lower one; the upper one
  bool has_pupil = false;
  for (std::size_t k = 0; k < side.count; ++k) {
    const Vec2 x = lens_.undistort(readings_[side.first + k].x);
    const int number = part.number[k];
    if (number == kPupilRight) eye->pupil = x, has_pupil = true;
    lids = lids - weight_in_gap(number) * x;
    upper = upper + weight_in_lid(number) * x;
  }
  eye->opening_mm = axes.to_crop(lids).y;
  eye->lid_mm = axes.to_crop(eye->pupil - upper).y;
  // The eye is where its corners are read; up and down, where they are read less exactly, in part.
  eye->pupil = eye->pupil - axes.along({side.centre_mm.x, kGazeTuning.corner_weight * side.centre_mm.y});
  eye->corners =
      0.5f * (cascade_.surface_point(side.anchor[0], q_) + cascade_.surface_point(side.anchor[1], q_));
  return has_pupil;
}

Vec3 PartFit::gaze(const PartPoints& points) {
  SeenEye eyes[2 * kMostParts];
  std::size_t count = 0;
  for (std::size_t s = 0; s < points.side_count; ++s)
    if (read_eye(points, points.side[s], &eyes[count])) ++count;
  return find_gaze({eyes, count}, view_);
}

void PartFit::choose_parameters(PartPoints* points) {
  const Span<const Parameter> all = cascade_.model().parameters();
  cascade_.set_free(Group::expression);
  for (std::size_t k = 0; k < all.count; ++k) is_free_[k] = 0;
  for (std::size_t k = 0; k < points->count; ++k) {
    if (!points->is_fitted(k)) continue;
    Jacobian j;
    cascade_.sample_point(points->uv[k], q_, samples_);
    cascade_.evaluate(samples_, q_, &j);
    for (std::size_t c = 0; c < j.count; ++c) {
      const std::uint16_t p = cascade_.parameter_of(j.list[c]);
      const float range = all[p].maximum - all[p].minimum;
      if (range * length(j.column[j.list[c]]) > kTuning.least_range_mm) is_free_[p] = 1;
    }
  }
  points->parameter_count = 0;
  for (std::size_t k = 0; k < all.count && points->parameter_count < kMostPartParameters; ++k)
    if (is_free_[k] != 0) {
      points->last[points->parameter_count] = q_[k];
      points->sd[points->parameter_count] = 0;
      points->parameter[points->parameter_count++] = static_cast<std::uint16_t>(k);
    }
}

/// How the parameters open the eyes.
void PartFit::find_openings(PartPoints* points) {
  for (std::size_t n = 0; n < points->parameter_count; ++n) points->opens_mm[n] = 0;
  for (std::size_t s = 0; s < points->side_count; ++s) {
    const PartSide& side = points->side[s];
    for (std::size_t k = 0; k < side.count; ++k) {
      const float weight = weight_in_gap(points->table[side.part].number[k]);
      if (weight == 0) continue;
      Jacobian j;
      cascade_.sample_point(points->uv[side.first + k], q_, samples_);
      cascade_.evaluate(samples_, q_, &j);
      for (std::size_t c = 0; c < j.count; ++c)
        for (std::size_t n = 0; n < points->parameter_count; ++n)
          if (points->parameter[n] == cascade_.parameter_of(j.list[c]))
            points->opens_mm[n] += (side.is_left ? -weight : weight) * j.column[j.list[c]].y;
    }
  }
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
  const CropMap axes = upright(view_);
  set(values, *points);
  for (std::size_t k = 0; k < points->count; ++k)
    if (points->is_fitted(k)) points->offset_mm[k] = axes.to_crop(readings_[k].x - project(points->uv[k]));
  for (std::size_t n = 0; n < points->parameter_count; ++n) points->last[n] = points->start[n] = values[n];
  points->is_calibrated = true;
}

void PartFit::calibrate(PartPoints* points) {
  choose_parameters(points);
  find_openings(points);
  float values[kMostPartParameters];
  copy(points->last, points->parameter_count, values);
  for (Vec2& offset : points->offset_mm) offset = {};
  for (float& start : points->start) start = 0;
  points->is_calibrated = false;
  solve(kTuning.start_s, points);
  if (is_near(kTuning.contradiction_mm, values, *points)) note_offsets(values, points);
}

/// One Gauss-Newton step of a common shift and the parameters.
void PartFit::step(float seconds, const PartPoints& points) {
  const Projector projector(view_, true);
  const CropMap axes = upright(view_);
  const std::size_t unknowns = kShift + points.parameter_count;
  equations_.reset(unknowns);
  for (std::size_t k = 0; k < points.count; ++k) {
    if (!points.is_fitted(k)) continue;
    Jacobian j;
    Projector::Derivatives d;
    Vec2 x;
    cascade_.sample_point(points.uv[k], q_, samples_);
    if (!projector.project(cascade_.evaluate(samples_, q_, &j), &x, &d)) continue;
    const Vec2 target = readings_[k].x - axes.along(points.offset_mm[k]);
    row_.add_to(equations_, {kAxes, kShift}, d, j, lens_.undistort(target) - x, readings_[k].information);
  }
  const float shift_px = kTuning.shift_mm * view_.s;
  for (std::size_t n = 0; n < kShift; ++n) equations_.add_prior(n, 0, 1 / (shift_px * shift_px));
  for (std::size_t n = 0; n < points.parameter_count; ++n) {
    const std::uint16_t k = points.parameter[n];
    const Parameter& p = cascade_.model().parameters()[k];
    const float change = kTuning.change * (p.maximum - p.minimum) * 30 * seconds;
    add_prior(p, q_[k], 1, kShift + n, equations_);
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
  std::size_t columns = 0;
  for (std::size_t n = 0; n < points.parameter_count; ++n) {
    const float mm = points.opens_mm[n];
    now += mm * (q_[points.parameter[n]] - points.start[n]);
    before += mm * (points.last[n] - points.start[n]);
    if (mm == 0) continue;
    row_.unknown[columns] = static_cast<std::uint16_t>(kShift + n);
    row_.column[columns++] = {mm, 0};
  }
  const float variance = kTuning.unlike_mm * kTuning.unlike_mm + before * before;
  equations_.add(row_.unknown, row_.column, columns, {-now, 0}, {1 / variance, 0, 0});
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
