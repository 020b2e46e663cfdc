#include "face/aligner_pass.hpp"

namespace pliant {

namespace {

/// Largest displacement of a landmark in one stage, mm: more is no prediction. Half a face.
constexpr float kMostDisplacementMm = 60;

/// Index of the landmark ibugNN of a model, or kNone.
std::uint16_t find_ibug(const Model& model, int number) {
  char name[] = "ibug00";
  name[4] = static_cast<char>('0' + number / 10);
  name[5] = static_cast<char>('0' + number % 10);
  return model.find_landmark(name);
}

Vec2 limited(Vec2 mm) {
  return {clamp(mm.x, -kMostDisplacementMm, kMostDisplacementMm),
          clamp(mm.y, -kMostDisplacementMm, kMostDisplacementMm)};
}

}  // namespace

void AlignerPass::lay_out(Arena& arena, const Model& model, std::size_t landmarks) {
  picture_.lay_out(arena);
  blocks_.lay_out(arena);
  shape_.lay_out(arena, model, landmarks);
  crop_ = arena.take<std::uint8_t>(static_cast<std::size_t>(kMostCropPx + 2) * (kMostCropPx + 2));
  block_ = arena.take<std::uint8_t>(static_cast<std::size_t>(kMostBlockBytes));
  index_ = arena.take<std::uint16_t>(landmarks);
  model_index_ = arena.take<std::uint16_t>(landmarks);
  targets_ = arena.take<LandmarkTarget>(landmarks);
  components_ = arena.take<std::int32_t>(kMostAlignerComponents);
}

std::size_t AlignerPass::choose_landmarks(const Model& model, const AlignerTable& table) {
  std::size_t count = 0;
  for (std::size_t k = 0; k < table.landmark_count(); ++k) {
    const std::uint16_t found = find_ibug(model, table.landmark_number(k));
    if (found == kNone) continue;
    shape_.set_landmark(count, {model.landmarks()[found].u, model.landmarks()[found].v});
    model_index_[count] = found;
    index_[count++] = static_cast<std::uint16_t>(k);
  }
  shape_.set_landmark_count(count);
  return count;
}

void AlignerPass::start(const FrameView& frame, const Lens& lens, const View& view, const float* q,
                        const std::uint8_t* is_free) {
  shape_.start(view, q, is_free, lens);
  shape_.project();
  picture_.take(frame, shape_.crop_map(1, 1).origin, max(1, 150 * view.s));
}

void AlignerPass::prepare(const AlignerStage& stage) {
  shape_.project();
  map_ = shape_.crop_map(stage.mm_per_px, stage.crop_px);
  picture_.crop(map_, crop_);
}

Vec2 AlignerPass::describe_landmark(std::size_t k, const AlignerStage& stage, std::uint8_t* out) const {
  GradientBlocks blocks = blocks_;
  blocks.set_crop(crop_, stage.crop_px);
  return blocks.describe(map_.to_crop(shape_.image(k)), stage.cells, stage.cell_px, out);
}

void AlignerPass::describe_place(int i, int j, const AlignerStage& stage, std::uint8_t* out) const {
  GradientBlocks blocks = blocks_;
  blocks.set_crop(crop_, stage.crop_px);
  const float step = static_cast<float>(stage.cells * stage.cell_px),
              middle = 0.5f * static_cast<float>(stage.crop_px - 1);
  const float first = middle - 0.5f * step * static_cast<float>(stage.blocks - 1);
  blocks.describe({first + step * static_cast<float>(i), first + step * static_cast<float>(j)}, stage.cells,
                  stage.cell_px, out);
}

/// A target from the crop's millimetres to pixels of the frame.
void AlignerPass::set_target(std::size_t k, Vec2 x, const float* information, float mm_per_px) {
  const Vec2 a = (1.0f / mm_per_px) * map_.right;  // px a mm to the right
  const float by = 1.0f / (dot(a, a) * dot(a, a));
  const float xx = information[0], xy = information[1], yy = information[2];
  // R W R^T / |a|^2 with R = [a.x -a.y; a.y a.x] / |a|.
  targets_[k].x = x;
  targets_[k].information = {by * (a.x * a.x * xx - 2 * a.x * a.y * xy + a.y * a.y * yy),
                             by * (a.x * a.y * (xx - yy) + (a.x * a.x - a.y * a.y) * xy),
                             by * (a.y * a.y * xx + 2 * a.x * a.y * xy + a.x * a.x * yy)};
}

void AlignerPass::predict(const AlignerTable& table, std::size_t stage) {
  if (table.stage(stage).components > 0)
    predict_global(table, stage);
  else
    predict_local(table, stage, nullptr, nullptr);
}

void AlignerPass::predict_local(const AlignerTable& table, std::size_t stage, const CheckWeights* check,
                                AlignerEvidence* out) {
  const AlignerStage& s = table.stage(stage);
  const LocalWeights w = table.local(stage);
  const std::size_t bytes = block_bytes(s);
  float weights = 0, squares = 0;
  for (std::size_t k = 0; k < shape_.landmark_count(); ++k) {
    const std::size_t t = index_[k];
    const Vec2 middle = describe_landmark(k, s, block_);
    Vec2 mm{
        w.scale[2 * t] * static_cast<float>(dot_bytes(w.rows + 2 * t * bytes, block_, bytes)) + w.bias[2 * t],
        w.scale[2 * t + 1] * static_cast<float>(dot_bytes(w.rows + (2 * t + 1) * bytes, block_, bytes)) +
            w.bias[2 * t + 1]};
    mm = limited(mm);
    set_target(k, map_.to_frame(middle + (1.0f / s.mm_per_px) * mm), w.information + 3 * t, s.mm_per_px);
    if (check == nullptr) continue;
    out->appearance +=
        shape_.weight(k) *
        (check->scale[t] * static_cast<float>(dot_bytes(check->rows + t * bytes, block_, bytes)) +
         check->bias[t]);
    const Vec2 left = s.mm_per_px * (map_.to_crop(targets_[k].x) - map_.to_crop(shape_.image(k)));
    squares += shape_.weight(k) * dot(left, left);
    weights += shape_.weight(k);
  }
  if (check != nullptr) out->displacement = square_root(squares / max(weights, 1e-6f));
}

void AlignerPass::predict_global(const AlignerTable& table, std::size_t stage) {
  const AlignerStage& s = table.stage(stage);
  const GlobalWeights w = table.global(stage);
  const std::size_t bytes = block_bytes(s), row = bytes * s.blocks * s.blocks;
  for (std::size_t c = 0; c < s.components; ++c) components_[c] = 0;
  for (int j = 0; j < s.blocks; ++j)
    for (int i = 0; i < s.blocks; ++i) {
      describe_place(i, j, s, block_);
      const std::size_t first = static_cast<std::size_t>(j * s.blocks + i) * bytes;
      for (std::size_t c = 0; c < s.components; ++c)
        components_[c] += dot_bytes(w.basis + c * row + first, block_, bytes);
    }
  for (std::size_t k = 0; k < shape_.landmark_count(); ++k) {
    const std::size_t t = index_[k];
    Vec2 mm{w.mean[2 * t], w.mean[2 * t + 1]};
    for (std::size_t c = 0; c < s.components; ++c) {
      const float value = w.scale[c] * static_cast<float>(components_[c]) + w.bias[c];
      mm.x += value * static_cast<float>(w.output[2 * t * s.components + c]);
      mm.y += value * static_cast<float>(w.output[(2 * t + 1) * s.components + c]);
    }
    mm = limited(mm);
    set_target(k, shape_.image(k) + map_.along((1.0f / s.mm_per_px) * mm), w.information + 3 * t,
               s.mm_per_px);
  }
}

AlignerEvidence AlignerPass::weigh(const AlignerTable& table) {
  const std::size_t last = table.stage_count() - 1;
  prepare(table.stage(last));
  AlignerEvidence evidence;
  const CheckWeights check = table.check_weights();
  predict_local(table, last, &check, &evidence);
  evidence.parameters = shape_.mean_square_parameter();
  return evidence;
}

}  // namespace pliant
