#include "host/bake/material_library.hpp"

#include <algorithm>
#include <optional>
#include <string_view>

#include "host/io/files.hpp"
#include "host/io/numbers.hpp"
#include "host/io/words.hpp"

namespace pliant::host::bake {

namespace {

/// An option of a picture, with what follows it: words, of which some may be left out where they are numbers.
struct MapOption {
  std::string_view name;
  int words;
  std::optional<float> neutral;  // the number that changes nothing; none: the option has no effect here
};
constexpr MapOption kMapOptions[] = {
    {"-s", 3, 1.0f},    {"-o", 3, 0.0f},    {"-t", 3, 0.0f},     {"-blendu", 1, {}}, {"-cc", 1, {}},
    {"-blendv", 1, {}}, {"-bm", 1, {}},     {"-imfchan", 1, {}}, {"-mm", 2, {}},     {"-clamp", 1, {}},
    {"-type", 1, {}},   {"-texres", 1, {}}, {"-boost", 1, {}}};

/// What follows `map_Kd`: options, then a name to the end of the line.
class MapLine {
 public:
  explicit MapLine(std::string_view text) : rest_(text) {
    for (const MapOption* option = next_option(); option != nullptr; option = next_option()) skip(*option);
  }
  std::string name() const { return std::string(unquoted(trimmed(rest_))); }
  /// Whether an option changes which part of the picture is seen.
  bool is_moved() const { return is_moved_; }

 private:
  std::string_view first_word() const {
    const std::size_t first = std::min(rest_.find_first_not_of(" \t"), rest_.size());
    return rest_.substr(first, std::min(rest_.find_first_of(" \t", first), rest_.size()) - first);
  }
  void drop(std::string_view word) {
    rest_.remove_prefix(static_cast<std::size_t>(word.data() + word.size() - rest_.data()));
  }

  const MapOption* next_option() {
    const std::string_view word = first_word();
    for (const MapOption& option : kMapOptions)
      if (option.name == word) {
        drop(word);
        return &option;
      }
    return nullptr;
  }

  void skip(const MapOption& option) {
    for (int k = 0; k < option.words; ++k) {
      const std::string_view word = first_word();
      const std::optional<float> number = parse_float(word);
      if (k > 0 && !number) return;
      if (option.neutral) is_moved_ |= number != option.neutral;
      drop(word);
    }
  }

  std::string_view rest_;
  bool is_moved_ = false;
};

}  // namespace

std::map<std::string, std::string> read_picture_names(const std::string& path,
                                                      std::vector<std::string>* warnings) {
  const std::string folder = path.substr(0, path.find_last_of('/') + 1);
  std::map<std::string, std::string> names;
  const std::string text = read_file(path);
  std::string material;
  for (std::string_view lines = without_byte_order_mark(text); !lines.empty();) {
    const std::string line = trimmed(take_line(lines));
    const std::size_t blank = line.find_first_of(" \t");
    if (blank == std::string::npos) continue;
    const std::string key = line.substr(0, blank), rest = trimmed(line.substr(blank));
    if (key == "newmtl") names.emplace(material = rest, "");
    if (key != "map_Kd" && key != "map_kd") continue;
    const MapLine map(rest);
    std::string name = map.name();
    if (name.empty()) continue;
    if (map.is_moved())
      warnings->push_back(path + ": the picture of material '" + material +
                          "' is scaled or moved; it is read as it is");
    std::replace(name.begin(), name.end(), '\\', '/');
    names[material] = name[0] == '/' ? name : folder + name;
  }
  return names;
}

}  // namespace pliant::host::bake
