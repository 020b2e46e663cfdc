#pragma once
/// \file arkit.hpp
/// The expression of a model as ARKit's 52 blendshape coefficients.
#include <array>
#include <ostream>
#include <string>
#include <vector>

#include "pliant/model.hpp"

namespace pliant::host {

constexpr std::size_t kArkitCount = 52;
/// ARKit's names, in the order of its documentation: left eye, right eye, jaw and mouth, brows, cheeks, nose, tongue. Left
/// and right are the subject's.
extern const std::array<const char*, kArkitCount> kArkitNames;

/// Angles at which ARKit's eight eyeLook... are 1, rad: how far eyes turn without the head. ARKit does not tell its own.
struct ArkitGaze {
  double side = 0.6;  ///< 34 degrees
  double up = 0.45;   ///< 26 degrees, and as much down
};

/// Maps a model's parameters to ARKit's coefficients. A coefficient is the parameter of its name over that parameter's
/// maximum, so that it runs from 0 (rest) to 1; where ARKit has one name for both sides, the mean of the model's two.
class ArkitExpression {
 public:
  /// \param model  its expressions are known by name; identity is not asked.
  explicit ArkitExpression(const Model& model);

  /// The names that nothing measures: no parameter of the model, nor its readers of the eyes. `coefficients` gives 0 for them.
  std::vector<std::string> absent() const;
  /// The model's expressions that have no place in ARKit's list.
  const std::vector<std::string>& left_out() const { return left_out_; }
  /// Writes a line for each of the two that is not empty. \param source  the model's file.
  void list_unmatched(const std::string& source, std::ostream& err) const;
  /// \param q     all parameters, in the model's order.
  /// \param gaze  as FrameResult::gaze; eyeLook... is its angle over the most that eyes turn (ArkitGaze).
  /// \return in the order of kArkitNames, each within 0 to 1.
  std::vector<float> coefficients(const std::vector<float>& q, Vec3 gaze = {}) const;

 private:
  Model model_;
  bool has_gaze_;                                                   // the model has readers of the eyes
  std::array<std::vector<std::uint16_t>, kArkitCount> parameters_;  // of each name, both sides of a pair
  std::vector<std::string> left_out_;
};

}  // namespace pliant::host
