#include "host/io/json.hpp"

#include <algorithm>
#include <set>
#include <sstream>

#include "host/io/failure.hpp"

namespace pliant::host {

namespace {

/// Longest message of the parser that is shown, bytes: it repeats the text that it read last.
constexpr std::size_t kMostShown = 160;

/// What the parser itself accepts: repeated members, any depth and any size.
class Bounds {
 public:
  /// \return what is wrong; empty if nothing.
  std::string refusal(std::size_t depth, Json::parse_event_t event, const Json& value) {
    using Event = Json::parse_event_t;
    const bool opens = event == Event::object_start || event == Event::array_start;
    if (opens && depth >= kMaxJsonDepth) return "nested too deeply";
    if (event == Event::object_start) members_.emplace_back();
    if (event == Event::object_end) members_.pop_back();
    if (event != Event::key) return "";
    if (members_.back().size() == kMaxJsonMembers) return "too many members";
    const auto& name = value.get_ref<const std::string&>();
    return members_.back().insert(name).second ? "" : quoted(name) + " appears twice";
  }

 private:
  std::vector<std::set<std::string>> members_;  // of the objects that are open
};

std::string place(std::string_view text, std::streamoff offset) {
  const std::string_view before =
      text.substr(0, static_cast<std::size_t>(std::max<std::streamoff>(offset, 0)));
  const auto lines = std::count(before.begin(), before.end(), '\n');
  const std::size_t last = before.rfind('\n');
  return "line " + std::to_string(lines + 1) + ", column " +
         std::to_string(before.size() - (last == std::string_view::npos ? 0 : last + 1));
}

}  // namespace

std::string json_text(const Json& value) {
  return value.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string quoted(const std::string& name) {
  const std::string text = json_text(name);  // in double quotes
  return "'" + text.substr(1, text.size() - 2) + "'";
}

Json parse_json(const std::string& source, const std::string& text) {
  if (text.size() > kMaxJsonBytes)
    fail_input(source, "is larger than " + std::to_string(kMaxJsonBytes) + " bytes");
  std::istringstream stream(text);
  const auto fail = [&](const std::string& what) {
    fail_input(source, place(text, stream.rdbuf()->pubseekoff(0, std::ios::cur, std::ios::in)) + ": " +
                           what.substr(0, kMostShown));
  };
  Bounds bounds;
  try {
    return Json::parse(stream, [&](int depth, Json::parse_event_t event, const Json& value) {
      const std::string what = bounds.refusal(static_cast<std::size_t>(depth), event, value);
      if (!what.empty()) fail(what);
      return true;
    });
  } catch (const Json::exception& e) {
    // "[kind and number] parse error at line 1, column 2: what": the place is told above.
    const std::string_view what = e.what();
    const std::size_t at =
        what.find(" parse error at ") == std::string_view::npos ? what.find("] ") : what.find(": ");
    fail(std::string(what.substr(at + 2)));
  }
  return {};
}

}  // namespace pliant::host
