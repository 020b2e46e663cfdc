#include "face/aligner_pass.hpp"

#include "face/ibug_landmarks.hpp"
#include "vision/noise_tuning.hpp"

namespace pliant {

namespace {

/// Tuning of a pass. Each constant: unit, reason, experiment.
struct AlignerPassTuning {
  /// Largest displacement of a landmark in one stage, mm: more is no prediction. Half a face.
  float most_displacement_mm = 60;
  /// Sine of the yaw from which on a face counts as fully turned. Not tuned; the learnt weights depend on it.
  float turned_sine = 0.6f;
};
constexpr AlignerPassTuning kTuning{};

/// What one row of learnt weights says of a block.
template <class Weights>
float response(const Weights& w, std::size_t row, const std::uint8_t* block, std::size_t bytes) {
  return w.scale[row] * static_cast<float>(dot_bytes(w.rows + row * bytes, block, bytes));
}

Vec2 limited(Vec2 mm) {
  constexpr float kMost = kTuning.most_displacement_mm;
  return {clamp(mm.x, -kMost, kMost), clamp(mm.y, -kMost, kMost)};
}

}  // namespace

void AlignerPass::lay_out(Arena& arena, const Model& model, std::size_t landmarks, AlignerUse use) {
  if (use != AlignerUse::spread_alignment) {
    picture_.lay_out(arena);
    gradients_.lay_out(arena);
  } else {
    motion_ = arena.take<FaceMotion>(1);
  }
  shape_.lay_out(arena, model, landmarks, use);
  block_ = arena.take<std::uint8_t>(static_cast<std::size_t>(kMostBlockBytes));
  mirrored_ = arena.take<std::uint8_t>(static_cast<std::size_t>(kMostBlockBytes));
  index_ = arena.take<std::uint16_t>(landmarks);
  model_index_ = arena.take<std::uint16_t>(landmarks);
  image_ = arena.take<Vec2>(landmarks);
  target_ = arena.take<Vec2>(landmarks);
  components_ = arena.take<float>(kMostAlignerComponents);
}

void AlignerPass::lay_out_scratch(Arena& arena) {
  picture_.lay_out(arena);
  gradients_.lay_out(arena);
  shape_.lay_out_samples(arena);
}

std::size_t AlignerPass::choose_landmarks(const Model& model, const std::uint8_t* numbers,
                                          std::size_t count) {
  const Span<const Landmark> all = model.landmarks();
  std::uint16_t corner[4];
  if (!find_box_corners(model, corner)) return 0;
  const Vec2 corners[4] = {all[corner[0]].uv(), all[corner[1]].uv(), all[corner[2]].uv(),
                           all[corner[3]].uv()};
  shape_.set_corners(corners);
  std::size_t chosen = 0;
  std::uint16_t found = 0;
  for (std::size_t k = 0; k < count; ++k) {
    found = find_ibug(model, numbers[k], found + std::size_t{1});
    if (found == kNone) continue;
    shape_.set_landmark(chosen, all[found].uv());
    model_index_[chosen] = found;
    index_[chosen++] = static_cast<std::uint16_t>(k);
  }
  shape_.set_landmark_count(chosen);
  return chosen;
}

bool AlignerPass::start(const FrameView& frame, const Lens& lens, const View& view, const float* q,
                        const std::uint8_t* is_free) {
  shape_.start(view, q, is_free, lens);
  return take_picture(frame);
}

bool AlignerPass::take_picture(const FrameView& frame) {
  const Vec2 middle = shape_.crop_map(1, 1).origin;
  if (!is_finite(middle)) return false;
  picture_.take(frame, middle, max(1, kFaceBoxMm * shape_.view().s) / kFacePictureTuning.face_px,
                gradients_.scratch());
  picture_.smooth_noise(kNoiseTuning.most_places);
  return true;
}

/// Behind what pictures need there.
FaceMotion& AlignerPass::motion() {
  constexpr std::size_t kColumns =
      static_cast<std::size_t>(kFacePictureTuning.side_px * kFacePictureTuning.most_samples);
  static_assert(kColumns * sizeof(int) + sizeof(FaceMotion) <= 2 * kMostCropPx * kMostCropPx, "");
  return motion_ != nullptr ? *motion_ : *reinterpret_cast<FaceMotion*>(gradients_.scratch() + kColumns);
}

bool AlignerPass::follow(const FrameView& frame) {
  picture_.take(frame, picture_.centre(), picture_.ratio(), gradients_.scratch());
  shape_.move(motion().since_kept(picture_));
  return take_picture(frame);
}

void AlignerPass::prepare(const AlignerStage& stage) {
  map_ = shape_.crop_map(stage.mm_per_px, stage.crop_px);
  gradients_.compute(picture_, map_);
  const Vec3 forward = Projector(shape_.view(), true).rotated({0, 0, 1});
  gate_ = clamp(0.5f + (0.5f / kTuning.turned_sine) * forward.x, 0, 1);
}

Vec2 AlignerPass::describe_around(Vec2 x, const AlignerStage& stage, std::uint8_t* out) const {
  return gradients_.describe(map_.to_crop(x), stage.cells, stage.cell_px, out);
}

void AlignerPass::describe_place(int i, int j, const AlignerStage& stage, std::uint8_t* out) const {
  const float step = static_cast<float>(stage.cells * stage.cell_px);
  const float first =
      0.5f * (static_cast<float>(stage.crop_px - 1) - step * static_cast<float>(stage.blocks - 1));
  const Vec2 at{first + step * static_cast<float>(i), first + step * static_cast<float>(j)};
  gradients_.describe(at, stage.cells, stage.cell_px, out);
}

/// The position that a local stage predicts for a landmark seen at x. Leaves its block and the mirrored one in block_ and
/// mirrored_.
Vec2 AlignerPass::predict_local(const AlignerTable& table, const AlignerStage& stage, const LocalWeights& w,
                                std::size_t t, Vec2 x) const {
  const std::size_t bytes = block_bytes(stage), other = table.mirrored(t);
  const Vec2 middle = describe_around(x, stage, block_);
  mirror_block(block_, stage.cells, mirrored_);
  const auto along = [&](std::size_t row, const std::uint8_t* block) {
    return response(w, row, block, bytes);
  };
  const float left = 1 - gate_, right = gate_;
  const Vec2 mm{
      left * along(2 * t, block_) - right * along(2 * other, mirrored_) + w.bias[2 * t],
      left * along(2 * t + 1, block_) + right * along(2 * other + 1, mirrored_) + w.bias[2 * t + 1]};
  return map_.to_frame(middle + (1.0f / stage.mm_per_px) * limited(mm));
}

void AlignerPass::predict_components(const AlignerStage& stage, const GlobalWeights& w) {
  const std::size_t bytes = block_bytes(stage), row = bytes * stage.blocks * stage.blocks;
  for (std::size_t c = 0; c < stage.components; ++c) components_[c] = w.bias[c];
  const std::int8_t* basis = w.basis;
  for (int j = 0; j < stage.blocks; ++j)
    for (int i = 0; i < stage.blocks; ++i, basis += bytes) {
      describe_place(i, j, stage, block_);
      for (std::size_t c = 0; c < stage.components; ++c)
        components_[c] += w.scale[c] * static_cast<float>(dot_bytes(basis + c * row, block_, bytes));
    }
}

/// The position that a global stage predicts for a landmark seen at x.
Vec2 AlignerPass::predict_global(const AlignerStage& stage, const GlobalWeights& w, std::size_t t,
                                 Vec2 x) const {
  Vec2 mm{w.mean[2 * t], w.mean[2 * t + 1]};
  const std::int8_t* const along_x = w.output + 2 * t * stage.components;
  const std::int8_t* const along_y = along_x + stage.components;
  for (std::size_t c = 0; c < stage.components; ++c)
    mm = mm + components_[c] * Vec2{static_cast<float>(along_x[c]), static_cast<float>(along_y[c])};
  return x + map_.along((1.0f / stage.mm_per_px) * limited(mm));
}

void AlignerPass::run_stage(const AlignerTable& table, std::size_t number) {
  const AlignerStage& stage = table.stage(number);
  const bool is_local = stage.components == 0;
  const LocalWeights local = is_local ? table.local(number) : LocalWeights{};
  const GlobalWeights global = is_local ? GlobalWeights{} : table.global(number);
  prepare(stage);
  if (!is_local) predict_components(stage, global);
  const Vec2 millimetre = (1.0f / stage.mm_per_px) * map_.right;
  shape_.begin();
  for (std::size_t k = 0; k < shape_.landmark_count(); k += stage.stride) {
    const std::size_t t = index_[k];
    const Vec2 x = shape_.evaluate(k).x;
    const Vec2 target =
        is_local ? predict_local(table, stage, local, t, x) : predict_global(stage, global, t, x);
    const float* const w = (is_local ? local.information : global.information) + 3 * t;
    shape_.add(target, to_frame_px({w[0], w[1], w[2]}, millimetre));
  }
  shape_.finish(stage.prior);
}

AlignerEvidence AlignerPass::weigh(const AlignerTable& table) {
  const std::size_t last = table.stage_count() - 1;
  const AlignerStage& stage = table.stage(last);
  const std::size_t bytes = block_bytes(stage);
  const LocalWeights local = table.local(last);
  const CheckWeights check = table.check_weights();
  const CheckWeights text = table.tells_text() ? table.text_weights() : CheckWeights{};
  const float* const usual = table.check().usual;
  AlignerEvidence evidence;
  float weights = 0, squares = 0, above[kFaceParts] = {};  // each part's appearance less the usual one
  prepare(stage);
  shape_.select();
  for (std::size_t k = 0; k < shape_.landmark_count(); ++k) {
    const std::size_t t = index_[k];
    const FaceShape::Seen seen = shape_.locate(k);
    image_[k] = seen.x;
    target_[k] = predict_local(table, stage, local, t, seen.x);
    const std::size_t other = table.mirrored(t);
    const auto sum_of = [&](const CheckWeights& w) {
      return seen.weight * ((1 - gate_) * response(w, t, block_, bytes) +
                            gate_ * response(w, other, mirrored_, bytes) + w.bias[t]);
    };
    const float of_landmark = sum_of(check);
    if (table.tells_text()) evidence.text += sum_of(text);
    const int part = part_of_landmark(table.landmark_numbers()[t]);
    evidence.appearance += of_landmark;
    above[part] += of_landmark - seen.weight * usual[part];
    const Vec2 residual = map_.to_crop(target_[k]) - map_.to_crop(seen.x);
    squares += seen.weight * dot(residual, residual);
    weights += seen.weight;
  }
  for (int p = 0; p < kFaceParts; ++p)
    evidence.least_part = min(evidence.least_part, usual[kFaceParts + p] * above[p]);
  evidence.displacement = stage.mm_per_px * square_root(squares / max(weights, 1e-6f));
  evidence.parameters = shape_.mean_square_parameter();
  return evidence;
}

}  // namespace pliant
