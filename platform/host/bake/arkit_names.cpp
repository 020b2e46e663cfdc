#include "host/bake/arkit_names.hpp"

#include <algorithm>

namespace pliant::host::bake {

namespace {

// A name that ends in "+" is a pair: the name with Left and with Right. One that ends in "=" may also stand alone, as it does
// in ARKit. The most useful names are first.
constexpr const char* kNames[] = {
    "jawOpen",        "mouthSmile+",     "eyeBlink+",       "browInnerUp=", "browDown+",
    "browOuterUp+",   "mouthPucker",     "mouthFunnel",     "mouthFrown+",  "mouthStretch+",
    "mouthUpperUp+",  "mouthLowerDown+", "mouthClose",      "mouthLeft",    "mouthRight",
    "jawLeft",        "jawRight",        "noseSneer+",      "cheekPuff=",   "eyeSquint+",
    "eyeWide+",       "cheekSquint+",    "mouthPress+",     "mouthDimple+", "mouthShrugLower",
    "mouthRollLower", "mouthRollUpper",  "mouthShrugUpper", "jawForward",   "tongueOut",
    "eyeLookDown+",   "eyeLookUp+",      "eyeLookIn+",      "eyeLookOut+"};

}  // namespace

std::size_t usefulness_rank(const std::string& name) {
  const auto found = std::find_if(std::begin(kNames), std::end(kNames), [&](const std::string& known) {
    if (known.back() != '+' && known.back() != '=') return name == known;
    const std::string stem = known.substr(0, known.size() - 1);
    return (known.back() == '=' && name == stem) || name == stem + "Left" || name == stem + "Right";
  });
  return static_cast<std::size_t>(found - std::begin(kNames));
}

std::vector<std::string> names_unknown_to_arkit(const Source& source) {
  const auto is_beside_pair = [&](const std::string& name, std::size_t rank) {
    const std::string known = kNames[rank], pair = known.substr(0, known.size() - 1);
    return known.back() == '=' && name != pair &&
           std::any_of(source.parameters.begin(), source.parameters.end(),
                       [&](const SourceParameter& p) { return p.name == pair; });
  };
  std::vector<std::string> unknown;
  bool is_face = std::any_of(source.landmarks.begin(), source.landmarks.end(),
                             [](const SourceLandmark& l) { return l.name.compare(0, 4, "ibug") == 0; });
  for (const SourceParameter& p : source.parameters) {
    if (p.group != Group::expression) continue;
    const std::size_t rank = usefulness_rank(p.name);
    const bool is_known = rank < std::size(kNames) && !is_beside_pair(p.name, rank);
    is_face |= is_known;
    if (!is_known) unknown.push_back(p.name);
  }
  return is_face ? unknown : std::vector<std::string>{};
}

}  // namespace pliant::host::bake
