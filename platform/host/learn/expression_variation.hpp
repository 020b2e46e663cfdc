#pragma once
/// \file expression_variation.hpp
/// Changes a person's expression, and the person a little, at random.
#include <vector>

#include "host/learn/sample_random.hpp"
#include "pliant/model.hpp"

namespace pliant::host::learn {

/// Which changes are made how often: a chance is the probability in a sample. Chosen by eye: the photographs smile with open eyes,
/// people do not always. `shut_chance` and how far mouths open (`jaw_linear`, `jaw_cubic`): docs/experiments.md, Shut lips.
struct ExpressionVariationTuning {
  float unchanged_chance = 0.15f;  ///< the photograph's expression stays as it is
  float relax_chance = 0.5f;       ///< the photograph's own expression gets weaker
  float shut_chance = 0.2f;        ///< lips that meet, whatever the photograph's do
  float jaw_chance = 0.4f;         ///< mouth opened
  float jaw_linear = 0.3f,
        jaw_cubic = 0.6f;      ///< by linear t + cubic t^3 of the largest opening, t uniform in [0, 1]
  float blink_chance = 0.25f;  ///< eyes closed, or nearly
  float brow_chance = 0.35f;   ///< brows raised or lowered
  float lips_chance = 0.3f;    ///< one movement of the lips
  float any_sd = 0.15f;        ///< of every expression, in standard deviations of its prior
  float identity_sd = 0.5f;    ///< of every identity parameter, in standard deviations of its prior
};

/// Draws parameters around given ones. Parameters are known by their ARKit names; a model without them gets the general
/// changes only.
class ExpressionVariation {
 public:
  explicit ExpressionVariation(const Model& model, const ExpressionVariationTuning& tuning = {});
  /// \param q  all parameters. \return within the model's limits.
  std::vector<float> varied(const std::vector<float>& q, SampleRandom& random) const;
  /// A random person with a random expression.
  std::vector<float> random_face(SampleRandom& random) const;

 private:
  void add(std::vector<float>& q, const char* name, float fraction) const;
  void shut_mouth(std::vector<float>& q, SampleRandom& random) const;
  void move_mouth(std::vector<float>& q, SampleRandom& random) const;
  void express(std::vector<float>& q, SampleRandom& random) const;
  void limit(std::vector<float>& q) const;

  Model model_;
  ExpressionVariationTuning tuning_;
};

}  // namespace pliant::host::learn
