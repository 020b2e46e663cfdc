#include "estimate/observation_rows.hpp"

#include "base/symmetric.hpp"

namespace pliant {

namespace {

constexpr const ObservationRowsTuning& kTuning = kObservationRowsTuning;

/// Median of a Rayleigh variable, sqrt(2 ln 2), over that of a half-normal one, 0.67449.
constexpr float kLineToPlane = 1.74559f, kPerSquare = 1 / (kLineToPlane * kLineToPlane);

/// Length of a residual in standard deviations; of a line, times that ratio. Not inlined, for the sake of code size.
[[gnu::noinline]] float whitened_length(const Sym2& w, Vec2 r, bool is_line) {
  return square_root(quadratic_form(w, r)) * (is_line ? kLineToPlane : 1.0f);
}

/// W (I + s^2 W)^-1: the information after an error with standard deviation s is added. Keeps rank one.
Sym2 with_added_error(Sym2 w, float s) {
  const float s2 = s * s, most = kTuning.most_over_error / (s2 * (w.xx + w.yy));
  if (most < 1) w = {most * w.xx, most * w.xy, most * w.yy};
  const float a = 1 + s2 * w.xx, b = s2 * w.xy, d = 1 + s2 * w.yy;
  const float inverse = 1.0f / (a * d - b * b);
  return {inverse * (w.xx * d - w.xy * b), inverse * (w.xy * a - w.xx * b), inverse * (w.yy * a - w.xy * b)};
}

/// The determinant less a part of the squared trace.
float determinant_less(Sym2 w, float part) {
  const float trace = w.xx + w.yy;
  return w.xx * w.yy - w.xy * w.xy - part * trace * trace;
}

bool is_line(Sym2 w) {
  return determinant_less(w, kTuning.line_ratio) <= 0;
}

}  // namespace

void ObservationRows::lay_out(Arena& arena, std::size_t rows) {
  rows_ = arena.take<ObservationRow>(rows);
  information_ = arena.take<Sym2>(rows);
  residuals_ = arena.take<Vec2>(rows);
  lengths_ = arena.take<float>(rows);
  sorted_ = arena.take<float>(rows);
  capacity_ = rows;
  count_ = 0;
}

void ObservationRows::start(const RowPolicy& policy) {
  policy_ = policy;
  for (float& scale : cue_scale_) scale = 1;
  count_ = equations_ = searched_ = patches_searched_ = 0;
}

bool ObservationRows::is_usable(const Observation& o, const SurfacePoints& points) const {
  const Sym2 w = o.information;
  return points.has(o.id) && static_cast<std::size_t>(o.cue) < kCueCount && is_finite(o.score) &&
         dot(o.x, o.x) <= kTuning.most_distance_px2 && w.xx >= 0 && w.yy >= 0 && w.xx + w.yy > 0 &&
         w.xx <= kTuning.most_information && w.yy <= kTuning.most_information &&
         determinant_less(w, -kTuning.line_ratio) >= 0;
}

/// The observation's information with the model error added, in the scale of its cue.
Sym2 ObservationRows::information_of(const Observation& o) const {
  const auto cue = static_cast<std::size_t>(o.cue);
  const float mm = o.cue == Cue::edge ? kTuning.edge_error_mm : policy_.model_error_mm;
  const Sym2 w = with_added_error(o.information, mm * px_per_mm_);
  const float factor = 1.0f / (cue_scale_[cue] * cue_scale_[cue]);
  return {factor * w.xx, factor * w.xy, factor * w.yy};
}

void ObservationRows::gather(Span<Observation> observations, const SurfacePoints& points, float px_per_mm) {
  observations_ = observations;
  px_per_mm_ = px_per_mm;
  count_ = equations_ = searched_ = patches_searched_ = 0;
  for (std::size_t k = 0; k < observations.count && k < kNone;) {
    const std::size_t first = k;
    bool was_searched = false, is_patch = false;
    Observation* usable = nullptr;
    for (; k < observations.count && observations[k].id == observations[first].id && k - first < 255; ++k) {
      Observation& o = observations[k];
      was_searched = was_searched || o.reason != Reason::not_visible;
      is_patch = is_patch || (o.reason != Reason::not_visible && o.cue == Cue::patch);
      if (o.reason != Reason::found && o.reason != Reason::rejected) continue;
      o.reason = is_usable(o, points) && count_ < capacity_ ? Reason::found : Reason::not_visible;
      if (o.reason != Reason::found) continue;
      const bool takes_part = (policy_.cues >> static_cast<unsigned>(o.cue) & 1u) != 0;
      if (takes_part)
        usable = &o;
      else
        o.reason = Reason::rejected;
    }
    searched_ += was_searched;
    patches_searched_ += is_patch;
    if (usable == nullptr) continue;
    const bool line = is_line(usable->information);
    rows_[count_] = {usable->id,
                     static_cast<std::uint16_t>(first),
                     static_cast<std::uint8_t>(k - first),
                     0,
                     usable->cue,
                     true,
                     line};
    information_[count_++] = information_of(*usable);
    equations_ += line ? 1 : 2;
  }
}

void ObservationRows::measure(std::size_t k, Vec2 x) {
  ObservationRow& r = rows_[k];
  if (r.count == 1 && observations_[r.first].reason == Reason::found) {  // the usual case
    residuals_[k] = observations_[r.first].x - x;
    lengths_[k] = whitened_length(information_[k], residuals_[k], r.is_line);
    return;
  }
  float best = -1;
  for (std::uint8_t i = 0; i < r.count; ++i) {
    const Observation& o = observations_[static_cast<std::size_t>(r.first) + i];
    if (o.reason != Reason::found) continue;
    const Sym2 w = r.count == 1 ? information_[k] : information_of(o);
    const float length = whitened_length(w, o.x - x, r.is_line);
    if (best >= 0 && length >= best) continue;
    best = length;
    r.chosen = i;
    information_[k] = w;
    residuals_[k] = o.x - x;
  }
  lengths_[k] = best;
}

float ObservationRows::cost(Loss loss, float scale, bool only_kept) const {
  const float per_scale = 1.0f / scale;
  float sum = 0;
  for (std::size_t k = 0; k < count_; ++k)
    if (rows_[k].is_kept || !only_kept)
      sum += (rows_[k].is_line ? kPerSquare : 1.0f) * evaluate(loss, lengths_[k] * per_scale).rho;
  return sum;
}

float ObservationRows::scale() {
  std::size_t n = 0;
  for (std::size_t k = 0; k < count_; ++k)
    if (rows_[k].is_kept) sorted_[n++] = lengths_[k];
  return clamp(robust_scale(sorted_, n), kTuning.least_scale, kTuning.most_scale);
}

void ObservationRows::keep_within(float limit) {
  for (std::size_t k = 0; k < count_; ++k) rows_[k].is_kept = lengths_[k] <= limit;
}

float ObservationRows::outlier_fraction(float scale) const {
  std::size_t outliers = 0;
  for (std::size_t k = 0; k < count_; ++k) outliers += !is_inlier(lengths_[k], scale);
  return static_cast<float>(outliers) / static_cast<float>(count_);
}

float ObservationRows::squared_px(std::size_t k) const {
  const Sym2 w = information_[k];
  const Vec2 r = residuals_[k];
  if (!rows_[k].is_line) return dot(r, r);
  return quadratic_form(w, r) / (w.xx + w.yy);
}

void ObservationRows::update_cue_scales() {
  for (std::size_t c = 0; c < kCueCount; ++c) {
    std::size_t n = 0;
    for (std::size_t k = 0; k < count_; ++k)
      if (rows_[k].is_kept && rows_[k].cue == static_cast<Cue>(c)) sorted_[n++] = lengths_[k];
    if (n < kTuning.least_cue_rows) continue;
    const float seen = clamp(cue_scale_[c] * robust_scale(sorted_, n), 1, kTuning.most_cue_scale);
    cue_scale_[c] += policy_.cue_scale_rate * (seen - cue_scale_[c]);
  }
}

}  // namespace pliant
