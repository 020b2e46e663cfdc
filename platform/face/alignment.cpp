// Alignment by cascaded regression on the landmarks of a model, and verification (docs/algorithms.md, sections 7.13 and 7.14).
#include "face/alignment.hpp"

#include "base/arrays.hpp"
#include "face/box_view.hpp"
#include "model/parameters.hpp"

namespace pliant {

namespace {

constexpr AlignmentTuning kTuning = kAlignmentTuning;

/// The curve at a weighted sum of the features.
float value_of(const AlignerCurve& curve, float appearance, const AlignerEvidence& evidence) {
  const float features[kCheckFeatures] = {1, appearance, evidence.displacement, evidence.parameters};
  float sum = 0;
  for (int k = 0; k < kCheckFeatures; ++k) sum += curve.weight[k] * features[k];
  const float last = static_cast<float>(kCheckKnots - 1);
  const float at = clamp((sum - curve.low) / (curve.high - curve.low) * last, 0, last);
  if (!(at >= 0)) return 0;
  const int k = at >= last ? kCheckKnots - 2 : static_cast<int>(at);
  return curve.at[k] + (at - static_cast<float>(k)) * (curve.at[k + 1] - curve.at[k]);
}

bool is_within(float x, float low, float high) {
  return x >= low && x <= high;
}

/// That of the frame with y over the aspect.
Camera of_square_pixels(Camera camera) {
  camera.cy /= camera.aspect;
  camera.aspect = 1;
  return camera;
}

}  // namespace

void Alignment::lay_out(Arena& arena, const Model& of, Span<const std::uint8_t> bytes, AlignerUse of_use) {
  use = of_use;
  table = arena.make<AlignerTable>();
  begun = arena.make<Begun>();
  pass.lay_out(arena, of, landmark_room(bytes), use);
  start_q = arena.take<float>(of.parameters().count);
  if (arena.is_measuring() || arena.exhausted()) return;
  const bool is_summed = bytes.data == of.aligner().data;  // by Model::open
  status = AlignerTable::open(bytes, table, is_summed);
  if (status != Status::ok) return;
  const std::size_t found = pass.choose_landmarks(of, table->landmark_numbers(), table->landmark_count());
  if (static_cast<float>(found) < kTuning.least_landmarks * static_cast<float>(table->landmark_count()))
    status = Status::not_found;
}

Status Alignment::check_input(const FrameView& frame, const Camera& camera, const float* q,
                              const AlignedFace* face) {
  if (status != Status::ok) return status;
  if (q == nullptr || face == nullptr) return Status::bad_argument;
  if (check(frame) != Status::ok || !is_within(camera.cx, -kTuning.most_px, kTuning.most_px) ||
      !is_within(camera.cy, -kTuning.most_px, kTuning.most_px))
    return Status::bad_argument;
  begun->steps_left = 0;
  Lens lens;
  const Status made = Lens::make(camera, frame.width, frame.height, &lens);
  if (made != Status::ok) return made;
  begun->lens = lens.of_square_pixels();
  begun->camera = camera;
  pass.set_aspect(camera.aspect);
  return made;
}

Status Alignment::start_in_box(const FrameView& frame, const FaceBox& box, float roll) {
  if (!is_finite(box.center) || !is_within(box.side, 1, kTuning.most_px)) return Status::bad_argument;
  const float half = 0.5f * box.side;
  if (!is_within(box.center.x, -half, static_cast<float>(frame.width - 1) + half) ||
      !is_within(box.center.y, -half, static_cast<float>(frame.height - 1) + half))
    return Status::not_found;
  FaceBox square = box;
  square.center.y /= begun->camera.aspect;
  const Status placed = view_of_box(pass.shape().cascade(), start_q, square, roll,
                                    of_square_pixels(begun->camera), begun->lens, &begun->start_view);
  if (placed != Status::ok) return placed;
  // Where the distance is at its limit the face has another size.
  const View& view = begun->start_view;
  return is_within(kFaceBoxMm * view.s, 1, kTuning.most_px) && is_finite(view.tau) ? Status::ok
                                                                                   : Status::not_found;
}

Status Alignment::start_at_pose(const FrameView& frame, const Pose& pose) {
  if (!is_finite(pose) || !is_within(pose.t.z, 1.0f / kMaxRho, 1.0f / kMinRho)) return Status::bad_argument;
  View& view = begun->start_view;
  view = view_of({normalised(pose.q), pose.t}, of_square_pixels(begun->camera));
  const float side = kFaceBoxMm * view.s;
  const Vec2 x = view.c + view.s * view.tau;
  if (!is_within(side, 1, kTuning.most_px) || !is_finite(x)) return Status::bad_argument;
  if (!is_within(x.x, -side, static_cast<float>(frame.width) + side) ||
      !is_within(x.y, -side, static_cast<float>(frame.height) / begun->camera.aspect + side))
    return Status::not_found;
  return Status::ok;
}

AlignedFace Alignment::conclude() {
  const AlignerEvidence evidence = pass.weigh(*table);
  AlignedFace face;
  face.camera = begun->camera;
  face.pose = pose_of(pass.shape().view());
  // Text only speaks against a face (docs/experiments.md, Text).
  face.score = value_of(table->check().score, evidence.appearance + min(evidence.text, 0), evidence);
  face.landmark_error = value_of(table->check().error, evidence.appearance, evidence);
  face.least_part = evidence.least_part;
  return face;
}

/// The projected landmarks; those of the table are moved by a part of the displacements that the model could not follow.
void Alignment::write_landmarks(Span<Vec2> landmarks) {
  FaceShape& shape = pass.shape();
  const Span<const Landmark> all = model().landmarks();
  const LocalWeights w = table->local(table->stage_count() - 1);
  for (std::size_t i = 0; i < all.count; ++i) {
    std::size_t k = 0;
    while (k < shape.landmark_count() && pass.model_index(k) != i) ++k;
    if (k == shape.landmark_count()) {
      if (!shape.project(all[i].uv(), &landmarks[i])) landmarks[i] = shape.view().c;
    } else {
      const Vec2 x = pass.image(k);
      landmarks[i] = x + w.blend[pass.table_index(k)] * (pass.target(k) - x);
    }
    landmarks[i].y *= begun->camera.aspect;
  }
}

Status Alignment::begin(const FrameView& frame, const AlignOptions& options, bool is_refinement) {
  Begun& b = *begun;
  pass.shape().start(b.start_view, start_q, options.is_free, b.lens);
  if (!pass.shape().has_room()) return Status::capacity;
  b.width = frame.width;
  b.height = frame.height;
  b.refines = is_refinement;
  b.next_stage = 0;
  b.is_scored_twice = options.is_scored_twice;
  b.first_score = 0;
  b.steps_left = 1 + b.is_scored_twice;  // the last steps conclude
  for (std::size_t k = 0; k < table->stage_count(); ++k)
    b.steps_left += !b.refines || table->stage(k).refines != 0;
  return Status::ok;
}

Status Alignment::begin_in_box(const FrameView& frame, const FaceBox& box, const float* q,
                               const AlignOptions& options) {
  for (std::size_t k = 0; k < model().parameters().count; ++k) {
    const bool is_held = options.is_free != nullptr && options.is_free[k] == 0;
    if (is_held && !is_finite(q[k])) return Status::bad_argument;
    start_q[k] = is_held ? within_range(model().parameters()[k], q[k]) : 0.0f;
  }
  const Status placed = start_in_box(frame, box, options.roll);
  return placed == Status::ok ? begin(frame, options, false) : placed;
}

/// Of the steps but the last. \return whether the pose is still one.
bool Alignment::run_next_step() {
  if (begun->is_scored_twice && begun->steps_left == 2) {
    begun->first_score = conclude().score;
    return true;
  }
  while (begun->refines && table->stage(begun->next_stage).refines == 0) ++begun->next_stage;
  pass.run_stage(*table, begun->next_stage++);
  return pass.shape().is_usable();
}

Status Alignment::take_steps(const FrameView& frame, int steps, AlignedFace* face, float* q,
                             Span<Vec2> landmarks) {
  if (!(begun->next_stage == 0 ? pass.take_picture(frame) : pass.follow(frame))) {
    begun->steps_left = 0;
    return Status::not_found;
  }
  for (; steps > 0 && begun->steps_left > 1; --steps, --begun->steps_left)
    if (!run_next_step()) {
      begun->steps_left = 0;
      return Status::not_found;
    }
  if (steps <= 0) {
    pass.keep_picture();
    return Status::ok;
  }
  begun->steps_left = 0;
  *face = conclude();
  if (face->score >= kTuning.least_second_score) face->score = max(face->score, begun->first_score);
  if (!landmarks.empty()) write_landmarks(landmarks);
  copy(pass.shape().q(), model().parameters().count, q);
  return Status::ok;
}

}  // namespace pliant
