#include "host/learn/expression_variation.hpp"
#include "model/parameters.hpp"

#include <string>

namespace pliant::host::learn {

ExpressionVariation::ExpressionVariation(const Model& model, const ExpressionVariationTuning& tuning)
    : model_(model), tuning_(tuning) {}

/// Adds a fraction of the maximum to the parameter, or to its left and right ones.
void ExpressionVariation::add(std::vector<float>& q, const char* name, float fraction) const {
  for (const char* side : {"", "Left", "Right"})
    if (const std::uint16_t k = model_.find_parameter((std::string(name) + side).c_str()); k != kNone)
      q[k] += fraction * model_.parameters()[k].maximum;
}

void ExpressionVariation::limit(std::vector<float>& q) const {
  for (std::size_t k = 0; k < q.size(); ++k) q[k] = within_range(model_.parameters()[k], q[k]);
}

/// The mouth at rest, in which the lips meet, or a movement that leaves them together.
void ExpressionVariation::shut_mouth(std::vector<float>& q, SampleRandom& random) const {
  for (std::size_t k = 0; k < q.size(); ++k) {
    const std::string name = model_.parameters()[k].name;
    if (name.compare(0, 5, "mouth") == 0 || name.compare(0, 3, "jaw") == 0) q[k] = 0;
  }
  static const char* const kNames[] = {"mouthPucker", "mouthFrown", "mouthSmile",
                                       "mouthPress",  "mouthLeft",  "mouthRight"};
  const char* const name = kNames[random.below(sizeof kNames / sizeof *kNames)];
  if (random.chance(0.5f)) add(q, name, random.between(0.1f, 0.7f));
}

void ExpressionVariation::move_mouth(std::vector<float>& q, SampleRandom& random) const {
  if (random.chance(tuning_.jaw_chance)) {
    const float t = random.unit();
    add(q, "jawOpen", tuning_.jaw_linear * t + tuning_.jaw_cubic * t * t * t);
  }
  if (random.chance(tuning_.lips_chance)) {
    static const char* const kNames[] = {"mouthPucker", "mouthFunnel",  "mouthFrown",     "mouthStretch",
                                         "mouthSmile",  "mouthUpperUp", "mouthLowerDown", "mouthPress",
                                         "mouthLeft",   "mouthRight",   "jawLeft",        "jawRight"};
    const char* const name = kNames[random.below(sizeof kNames / sizeof *kNames)];
    add(q, name, random.between(0.1f, 0.7f));
  }
}

void ExpressionVariation::express(std::vector<float>& q, SampleRandom& random) const {
  const auto parameters = model_.parameters();
  if (random.chance(tuning_.blink_chance)) {
    const float closed = random.chance(0.6f) ? random.between(0.85f, 1) : random.between(0.2f, 0.8f);
    for (const char* name : {"eyeBlinkLeft", "eyeBlinkRight", "eyeBlink"})
      if (const std::uint16_t k = model_.find_parameter(name); k != kNone)
        q[k] += closed * max(parameters[k].maximum - q[k], 0);
  } else if (random.chance(0.15f)) {
    add(q, "eyeWide", random.between(0, 0.8f));
  }
  if (random.chance(tuning_.brow_chance)) {
    const float raised = random.between(0, 0.8f);
    if (random.chance(0.6f)) {
      add(q, "browInnerUp", raised * random.between(0.5f, 1));
      add(q, "browOuterUp", raised * random.between(0.5f, 1));
    } else {
      add(q, "browDown", raised);
    }
  }
  if (random.chance(tuning_.shut_chance))
    shut_mouth(q, random);
  else
    move_mouth(q, random);
}

std::vector<float> ExpressionVariation::varied(const std::vector<float>& q, SampleRandom& random) const {
  std::vector<float> out = q;
  if (random.chance(tuning_.unchanged_chance)) return out;
  const auto parameters = model_.parameters();
  const float kept = random.chance(tuning_.relax_chance) ? random.between(0, 0.8f) : 1;
  for (std::size_t k = 0; k < out.size(); ++k) {
    const bool is_identity = parameters[k].group == Group::identity;
    if (!is_identity) out[k] *= kept;
    out[k] += (is_identity ? tuning_.identity_sd : tuning_.any_sd) * parameters[k].sd * random.normal();
  }
  express(out, random);
  limit(out);
  return out;
}

std::vector<float> ExpressionVariation::random_face(SampleRandom& random) const {
  const auto parameters = model_.parameters();
  std::vector<float> out(parameters.count);
  for (std::size_t k = 0; k < out.size(); ++k)
    out[k] =
        (parameters[k].group == Group::identity ? 1.0f : tuning_.any_sd) * parameters[k].sd * random.normal();
  if (random.chance(0.5f)) add(out, "mouthSmile", random.between(0, 0.9f));
  express(out, random);
  limit(out);
  return out;
}

}  // namespace pliant::host::learn
