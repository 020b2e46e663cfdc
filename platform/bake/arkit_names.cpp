#include <algorithm>

#include "bake/obj_source.hpp"

namespace pliant::bake {

namespace {

// A "+" ending stands for Left and Right.
constexpr const char* kNames[] = {
    "browDown+",     "browInnerUp+",   "browOuterUp+",   "cheekPuff+",      "cheekSquint+",    "eyeBlink+",
    "eyeLookDown+",  "eyeLookIn+",     "eyeLookOut+",    "eyeLookUp+",      "eyeSquint+",      "eyeWide+",
    "jawForward",    "jawLeft",        "jawOpen",        "jawRight",        "mouthClose",      "mouthDimple+",
    "mouthFrown+",   "mouthFunnel",    "mouthLeft",      "mouthLowerDown+", "mouthPress+",     "mouthPucker",
    "mouthRight",    "mouthRollLower", "mouthRollUpper", "mouthShrugLower", "mouthShrugUpper", "mouthSmile+",
    "mouthStretch+", "mouthUpperUp+",  "noseSneer+",     "tongueOut"};

bool is_known(const std::string& name) {
  return std::any_of(std::begin(kNames), std::end(kNames), [&](const std::string& known) {
    if (known.back() != '+') return name == known;
    const std::string stem = known.substr(0, known.size() - 1);
    return name == stem + "Left" || name == stem + "Right";
  });
}

}  // namespace

std::vector<std::string> names_unknown_to_arkit(const Source& source) {
  std::vector<std::string> unknown;
  for (const SourceParameter& p : source.parameters)
    if (p.group == Group::expression && !is_known(p.name)) unknown.push_back(p.name);
  return unknown;
}

}  // namespace pliant::bake
