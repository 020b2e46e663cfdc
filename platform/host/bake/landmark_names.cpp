#include "host/bake/landmark_names.hpp"

#include <algorithm>

#include "host/io/ibug_names.hpp"
#include "host/io/words.hpp"

namespace pliant::host::bake {

namespace {

const std::vector<std::string>& standard_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all = {"eye_right", "eye_left", "nose_tip", "mouth_right", "mouth_left"};
    for (int k = 0; k < kIbugCount; ++k) all.push_back(ibug_name(k));
    return all;
  }();
  return names;
}

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

/// The letters in lower case and the digits, without the zeros that begin a number.
std::string essence(const std::string& name) {
  const std::string text = in_lower_case(name);
  std::string out;
  for (std::size_t k = 0; k < text.size(); ++k) {
    const bool begins = out.empty() || !is_digit(out.back()),
               goes_on = k + 1 < text.size() && is_digit(text[k + 1]);
    if (text[k] == '0' && begins && goes_on) continue;
    if (is_digit(text[k]) || (text[k] >= 'a' && text[k] <= 'z')) out += text[k];
  }
  return out;
}

/// The standard name that this one is nearly, or none.
std::string nearest_standard(const std::string& name) {
  const auto& all = standard_names();
  const auto found = std::find_if(all.begin(), all.end(),
                                  [&](const std::string& known) { return essence(name) == essence(known); });
  return found == all.end() ? "" : *found;
}

bool is_ibug_number(const std::string& name) {
  const std::string text = essence(name);
  return text.compare(0, 4, "ibug") == 0 && text.size() > 4 &&
         std::all_of(text.begin() + 4, text.end(), is_digit);
}

}  // namespace

std::vector<std::string> misspelt_landmarks(const Source& source) {
  std::vector<std::string> lines;
  for (const SourceLandmark& landmark : source.landmarks) {
    const std::string& name = landmark.name;
    const std::string standard = nearest_standard(name);
    if (standard == name) continue;
    if (!standard.empty())
      lines.push_back("the landmark '" + name + "' is not found by the name '" + standard +
                      "': if it is that one, rename it");
    else if (is_ibug_number(name))
      lines.push_back("the landmark '" + name +
                      "' is none of iBUG's, which are ibug00 to ibug67, counted from 0");
  }
  return lines;
}

}  // namespace pliant::host::bake
