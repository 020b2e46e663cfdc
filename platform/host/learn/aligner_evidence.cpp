#include "host/learn/aligner_evidence.hpp"

#include <algorithm>
#include <cmath>

#include "face/box_view.hpp"
#include "host/io/aligned_table.hpp"
#include "host/learn/parallel.hpp"
#include "pliant/face_detector.hpp"

namespace pliant::host::learn {

EvidenceCollector::EvidenceCollector(AlignerCascade& cascade, const AlignerCheckTuning& tuning)
    : cascade_(cascade), tuning_(tuning) {
  for (int f = 0; f <= cascade.folds(); ++f)
    tables_.push_back(std::make_unique<OpenAlignerTable>(cascade.table(f)));
}

std::vector<Evidence> EvidenceCollector::of_faces() {
  const std::size_t each = 1 + static_cast<std::size_t>(tuning_.moved_starts), n = cascade_.examples().size();
  std::vector<Evidence> out(n * each);
  run_parallel(cascade_.options().threads, n * each, [&](std::size_t k, std::size_t thread) {
    const AlignerExample& example = cascade_.examples()[k / each];
    SampleRandom random(cascade_.options().seed ^ 0xc4ec, k);
    View view = example.view;
    if (k % each > 0) view = moved_view(view, example, random);
    AlignerPass& pass = cascade_.pass(thread);
    pass.start(frame_of(*example.picture), Lens{}, view, example.q.data(), nullptr);
    out[k] = collect(pass, example.fold);
    std::vector<Vec2> at;
    for (std::size_t l = 0; l < cascade_.numbers().size(); ++l) at.push_back(pass.image(l));
    out[k].error = mean_error(example, at, kTrustFitted);
    out[k].half = example.fold % 2;
    out[k].is_moved = k % each > 0;
  });
  return out;
}

std::vector<Evidence> EvidenceCollector::of_others(const OtherPictures& others, std::size_t first,
                                                   std::size_t count,
                                                   const std::function<bool(const Evidence&)>& is_wanted) {
  std::vector<Evidence> all(count);
  run_parallel(cascade_.options().threads, count, [&](std::size_t index, std::size_t thread) {
    const std::size_t k = first + index;
    SampleRandom random(cascade_.options().seed ^ 0x07e5, k);
    const Image picture = others.crop(tuning_.other_px, tuning_.other_px, random);
    const float side = random.octaves_between(tuning_.other_least_px, tuning_.other_most_px);
    const float low = tuning_.other_room * static_cast<float>(tuning_.other_px),
                high = static_cast<float>(tuning_.other_px) - low;
    const Vec2 centre{random.between(low, high), random.between(low, high)};
    Evidence evidence = align_other(picture, {centre, side}, k, thread);
    if (is_wanted(evidence)) all[index] = std::move(evidence);
  });
  std::vector<Evidence> out;
  for (Evidence& e : all)
    if (!e.blocks.empty()) out.push_back(std::move(e));
  return out;
}

std::vector<Evidence> EvidenceCollector::of_found(const OtherPictures& others,
                                                  const std::vector<std::uint8_t>& detector,
                                                  std::size_t searches) {
  const AlignedTable table(detector);
  FaceDetectorLimits limits;
  limits.width = limits.height = static_cast<std::uint16_t>(tuning_.searched_px);
  std::vector<std::unique_ptr<Owned<FaceDetector>>> detectors;
  for (int t = 0; t < cascade_.options().threads; ++t)
    detectors.push_back(std::make_unique<Owned<FaceDetector>>(table.span(), limits));
  std::vector<std::vector<Evidence>> found(searches);
  run_parallel(cascade_.options().threads, searches, [&](std::size_t k, std::size_t thread) {
    SampleRandom random(cascade_.options().seed ^ 0xf0d, k);
    const Image picture = others.crop(tuning_.searched_px, tuning_.searched_px, random);
    DetectedFace room[4];
    std::size_t count = 0;
    require((*detectors[thread])->find(frame_of(picture), {room, std::size(room)}, &count),
            "the detector's table");
    for (std::size_t c = 0; c < count; ++c)
      for (int j = 0; j < tuning_.found_starts; ++j)
        found[k].push_back(align_other(picture, moved_box(room[c].box, random), k, thread));
  });
  std::vector<Evidence> out;
  for (auto& f : found) std::move(f.begin(), f.end(), std::back_inserter(out));
  return out;
}

FaceBox EvidenceCollector::moved_box(FaceBox box, SampleRandom& random) const {
  box.center = box.center + (tuning_.found_shift * box.side) * Vec2{random.normal(), random.normal()};
  box.side *= std::exp(tuning_.found_log_side * random.normal());
  return box;
}

View EvidenceCollector::moved_view(const View& view, const AlignerExample& example,
                                   SampleRandom& random) const {
  const float mm = example.eye_distance / view.s, shift = tuning_.moved_most * random.unit() * mm;
  const float a = random.between(-1, 1), b = random.between(-1, 1),
              length_ab = std::sqrt(a * a + b * b) + 1e-3f;
  const float turn = tuning_.moved_turn_rad;
  const float step[kPoseUnknowns] = {turn * random.normal(), turn * random.normal(),
                                     turn * random.normal(), tuning_.moved_log_scale * random.normal(),
                                     shift * a / length_ab,  shift * b / length_ab};
  return moved(view, step, kPoseUnknowns);
}

Evidence EvidenceCollector::align_other(const Image& picture, const FaceBox& box, std::size_t number,
                                        std::size_t thread) {
  const Camera camera =
      centred_camera(picture.width, picture.height, kDefaultFocalRatio * static_cast<float>(picture.width));
  const std::vector<float> q(cascade_.model().parameters().count);
  AlignerPass& pass = cascade_.pass(thread);
  View view;
  require(view_of_box(pass.shape().cascade(), q.data(), box, 0, camera, Lens{}, &view), "landmarks");
  const int fold = static_cast<int>(number % static_cast<std::size_t>(cascade_.folds()));
  const AlignerTable& table = **tables_[static_cast<std::size_t>(fold)];
  pass.start(frame_of(picture), Lens{}, view, q.data(), nullptr);
  for (std::size_t s = 0; s < table.stage_count(); ++s) pass.run_stage(table, s);
  Evidence out = collect(pass, fold);
  out.error = 1;
  out.is_face = false;
  out.half = static_cast<int>(number / 2 % 2);
  return out;
}

Evidence EvidenceCollector::collect(AlignerPass& pass, int fold) {
  const AlignerTable& table = **tables_[static_cast<std::size_t>(fold)];
  const AlignerStage& last = table.stage(table.stage_count() - 1);
  const std::size_t bytes = block_bytes(last), landmarks = table.landmark_count();
  const AlignerEvidence evidence = pass.weigh(table);
  Evidence out;
  out.displacement = evidence.displacement;
  out.parameters = evidence.parameters;
  out.gate = pass.gate();
  out.blocks.resize(landmarks * bytes);
  out.mirrored_blocks.resize(landmarks * bytes);
  for (std::size_t k = 0; k < landmarks; ++k) {
    pass.describe_around(pass.image(k), last, out.blocks.data() + k * bytes);
    mirror_block(out.blocks.data() + k * bytes, last.cells, out.mirrored_blocks.data() + k * bytes);
    out.weights.push_back(pass.shape().evaluate(k).weight);
  }
  return out;
}

}  // namespace pliant::host::learn
