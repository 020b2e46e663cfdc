#include "host/io/arkit.hpp"

#include <algorithm>
#include <cstring>

#include "host/io/fit_file.hpp"
#include "host/io/track_table.hpp"

namespace pliant::host {

const std::array<const char*, kArkitCount> kArkitNames = {
    "eyeBlinkLeft",      "eyeLookDownLeft",    "eyeLookInLeft",
    "eyeLookOutLeft",    "eyeLookUpLeft",      "eyeSquintLeft",
    "eyeWideLeft",       "eyeBlinkRight",      "eyeLookDownRight",
    "eyeLookInRight",    "eyeLookOutRight",    "eyeLookUpRight",
    "eyeSquintRight",    "eyeWideRight",       "jawForward",
    "jawLeft",           "jawRight",           "jawOpen",
    "mouthClose",        "mouthFunnel",        "mouthPucker",
    "mouthLeft",         "mouthRight",         "mouthSmileLeft",
    "mouthSmileRight",   "mouthFrownLeft",     "mouthFrownRight",
    "mouthDimpleLeft",   "mouthDimpleRight",   "mouthStretchLeft",
    "mouthStretchRight", "mouthRollLower",     "mouthRollUpper",
    "mouthShrugLower",   "mouthShrugUpper",    "mouthPressLeft",
    "mouthPressRight",   "mouthLowerDownLeft", "mouthLowerDownRight",
    "mouthUpperUpLeft",  "mouthUpperUpRight",  "browDownLeft",
    "browDownRight",     "browInnerUp",        "browOuterUpLeft",
    "browOuterUpRight",  "cheekPuff",          "cheekSquintLeft",
    "cheekSquintRight",  "noseSneerLeft",      "noseSneerRight",
    "tongueOut"};

namespace {

/// 0 at rest, 1 at the maximum; what bends the other way is rest.
float fraction_of(float value, const Parameter& p) {
  return p.maximum > 0 ? clamp(value / p.maximum, 0.0f, 1.0f) : 0.0f;
}

/// A direction of the gaze, and the names whose coefficients it drives.
struct Look {
  const char* names[2];
  double fraction;
};

std::vector<Look> looks_of(Vec3 gaze) {
  const GazeAngles angles = gaze_angles(gaze);
  const double left = angles.left / ArkitGaze{}.side, up = angles.up / ArkitGaze{}.up;
  return {{{"eyeLookOutLeft", "eyeLookInRight"}, left},
          {{"eyeLookInLeft", "eyeLookOutRight"}, -left},
          {{"eyeLookUpLeft", "eyeLookUpRight"}, up},
          {{"eyeLookDownLeft", "eyeLookDownRight"}, -up}};
}

bool is_look(const char* name) {
  return std::strncmp(name, "eyeLook", 7) == 0;
}

std::size_t column_of(const char* name) {
  const auto is_it = [&](const char* other) { return std::strcmp(name, other) == 0; };
  return static_cast<std::size_t>(std::find_if(kArkitNames.begin(), kArkitNames.end(), is_it) -
                                  kArkitNames.begin());
}

void write_list(const std::string& source, const char* what, const std::vector<std::string>& names,
                std::ostream& err) {
  if (names.empty()) return;
  err << source << ": " << what << ":";
  for (const std::string& name : names) err << " " << name;
  err << "\n";
}

}  // namespace

ArkitExpression::ArkitExpression(const Model& model) : model_(model), has_gaze_(!model.parts().empty()) {
  const auto is_expression = [&](std::uint16_t k) {
    return model.parameters()[k].group == Group::expression;
  };
  std::vector<bool> has_place(model.parameters().count);
  for (std::size_t column = 0; column < kArkitCount; ++column)
    for (const std::uint16_t k : parameters_named(model, kArkitNames[column]))
      if (is_expression(k)) {
        parameters_[column].push_back(k);
        has_place[k] = true;
      }
  for (std::uint16_t k = 0; k < model.parameters().count; ++k)
    if (is_expression(k) && !has_place[k]) left_out_.push_back(model.parameters()[k].name);
}

std::vector<std::string> ArkitExpression::absent() const {
  std::vector<std::string> names;
  for (std::size_t column = 0; column < kArkitCount; ++column)
    if (parameters_[column].empty() && (!has_gaze_ || !is_look(kArkitNames[column])))
      names.push_back(kArkitNames[column]);
  return names;
}

void ArkitExpression::list_unmatched(const std::string& source, std::ostream& err) const {
  write_list(source, "not measured, always 0", absent(), err);
  write_list(source, "left out, not ARKit's", left_out_, err);
}

std::vector<float> ArkitExpression::coefficients(const std::vector<float>& q, Vec3 gaze) const {
  std::vector<float> out;
  for (const auto& sides : parameters_) {
    float sum = 0;
    for (const std::uint16_t k : sides) sum += fraction_of(q[k], model_.parameters()[k]);
    out.push_back(sides.empty() ? 0.0f : sum / static_cast<float>(sides.size()));
  }
  for (const Look& look : looks_of(gaze))
    for (const char* name : look.names)
      if (const std::size_t column = column_of(name); parameters_[column].empty())
        out[column] = static_cast<float>(std::clamp(look.fraction, 0.0, 1.0));
  return out;
}

}  // namespace pliant::host
