#include "host/commands/args.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "host/io/failure.hpp"
#include "host/io/files.hpp"
#include "host/io/numbers.hpp"
#include "host/io/sources.hpp"
#include "host/io/words.hpp"

namespace pliant::host {

namespace {

/// Whether the path is, or would be, one of the files in a folder that are read, by its ending: pictures, and in a folder that is
/// an operand those of a surface. A table or a video beside them is not.
bool is_source_in(const std::string& folder, bool is_operand, const std::string& path) {
  std::error_code ignored;
  const std::filesystem::path file(path);
  const std::string ending = in_lower_case(file.extension().string());
  const bool is_of_surface = ending == ".txt" || ending == ".obj" || ending == ".mtl";
  return (has_picture_extension(path) || (is_operand && is_of_surface)) &&
         std::filesystem::is_directory(folder, ignored) &&
         std::filesystem::equivalent(std::filesystem::absolute(file, ignored).parent_path(), folder, ignored);
}

bool is_same_file(const std::string& a, const std::string& b) {
  std::error_code ignored;
  const auto spelt = [&](const std::string& path) {
    return std::filesystem::absolute(path, ignored).lexically_normal();
  };
  return spelt(a) == spelt(b) ||
         std::filesystem::equivalent(a, b, ignored);  // the latter: of files that are there
}

/// Bad usage if the name ends as that of another format than the option writes.
void check_ending(const Option& option, const std::string& path) {
  static constexpr const char* kFormats[] = {"avi", "bin",  "bmp",  "cpp", "csv",  "gif", "glb",  "gltf",
                                             "h",   "html", "jpeg", "jpg", "json", "mkv", "mov",  "mp4",
                                             "mtl", "obj",  "plm",  "ply", "png",  "svg", "webm", "y4m"};
  const std::string written = in_lower_case(option.value);
  std::string ending = in_lower_case(std::filesystem::path(path).extension().string());
  if (!ending.empty()) ending.erase(0, 1);
  const auto is_format = [](const std::string& name) {
    return std::find(std::begin(kFormats), std::end(kFormats), name) != std::end(kFormats);
  };
  if (is_format(written) && is_format(ending) && written != ending)
    fail_usage(std::string(option.name) + " writes " + option.value +
               ", but the name ends as another format: " + path);
}

/// The words, the last one first. An option without a value would take the next option for it, as where a variable of a script is
/// empty: after = that is an empty value, else bad usage.
std::vector<std::string> backwards(const std::vector<std::string>& words,
                                   const std::vector<Option>& options) {
  const auto option_of = [&](const std::string& word) {
    const std::string name = word.substr(0, word.find('='));
    return std::find_if(options.begin(), options.end(), [&](const Option& o) { return name == o.name; });
  };
  std::vector<std::string> out;
  for (auto word = words.rbegin(); word != words.rend(); ++word) {
    const auto option = option_of(*word);
    const bool has_value = option != options.end() && option->value != nullptr;
    if (has_value && *word == option->name && out.empty())
      fail_usage(*word + " lacks its value " + option->value);
    if (has_value && *word == option->name && option_of(word[-1]) != options.end())
      fail_usage(*word + " lacks its value: " + word[-1] + " is another option");
    if (has_value && *word == option->name + std::string("="))
      out.insert(out.end(), {"", option->name});
    else  // the value of a short option would begin with the =
      out.push_back(word->rfind("-o=", 0) == 0 ? "-o" + word->substr(3) : *word);
  }
  return out;
}

}  // namespace

Args::Args(const std::vector<std::string>& words, const std::vector<Option>& options, std::size_t operands,
           std::size_t optional) {
  CLI::App app;
  app.set_help_flag();  // `run` gives help, whatever else the words are
  for (const Option& option : options) {
    if (option.value == nullptr) {
      app.add_flag(option.name)->disable_flag_override();
      continue;
    }
    app.add_option(option.name)
        ->type_name(option.value)
        ->allow_extra_args(false)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  }
  std::vector<CLI::Option*> positional;
  for (std::size_t k = 0; k < operands + optional; ++k)
    positional.push_back(app.add_option("operand" + std::to_string(k + 1)));
  try {
    app.parse(backwards(words, options));
  } catch (const CLI::ExtrasError&) {
    const std::vector<std::string> left = app.remaining();
    fail_usage("this argument was not expected: " + left[left.size() > 1 && left[0] == "--" ? 1 : 0]);
  } catch (const CLI::Error& error) {
    fail_usage(error.what());
  }
  for (const CLI::Option* given : app.get_options({}))
    if (given->count() > 0 && !given->get_positional()) values_[given->get_name()] = given->results();
  for (const CLI::Option* given : positional)
    if (given->count() > 0) operands_.push_back(given->results()[0]);
  for (const Option& option : options)
    if (option.value != nullptr && option.takes != Takes::texts && texts(option.name).size() > 1)
      fail_usage(std::string(option.name) + " is given more than once");
  if (operands_.size() < operands) fail_usage("an operand is missing");
  if (std::find(operands_.begin(), operands_.end(), "") != operands_.end()) fail_usage("an operand is empty");
  check_files(options);
}

void Args::check_files(const std::vector<Option>& options) {
  for (const Option& option : options)
    if ((option.takes == Takes::input || option.takes == Takes::output) && text(option.name) == "")
      fail_usage(std::string(option.name) + " has an empty name");
  std::vector<std::string> inputs = operands_, outputs;
  for (const Option& option : options)
    if (option.takes == Takes::input)
      for (const std::string& path : texts(option.name)) inputs.push_back(path);
  for (const Option& option : options) {
    const auto path = text(option.name);
    if (option.takes != Takes::output || !path) continue;
    for (std::size_t k = 0; k < inputs.size(); ++k) {
      if (!is_standard_output(*path) && is_same_file(*path, inputs[k]))
        fail_usage(std::string(option.name) + " would overwrite the input " + inputs[k]);
      if (is_source_in(inputs[k], k < operands_.size(), *path))
        fail_usage(std::string(option.name) + " would be read with the folder " + inputs[k] + ": " + *path);
    }
    for (const std::string& other : outputs)
      if (is_same_file(*path, other) || (is_standard_output(*path) && is_standard_output(other)))
        fail_usage("two outputs have the name " + other);
    check_ending(option, *path);
    outputs.push_back(*path);
    writes_to_standard_output_ = writes_to_standard_output_ || is_standard_output(*path);
  }
}

std::optional<std::string> Args::text(const char* name) const {
  const auto found = values_.find(name);
  if (found == values_.end()) return std::nullopt;
  return found->second.back();
}

std::vector<std::string> Args::texts(const char* name) const {
  const auto found = values_.find(name);
  return found == values_.end() ? std::vector<std::string>{} : found->second;
}

void Args::refuse(std::initializer_list<const char*> options, const std::string& why) const {
  for (const char* option : options)
    if (has(option)) fail_usage(std::string(option) + " " + why);
}

void Args::check_needs(const char* option, const char* other) const {
  if (!has(other)) refuse({option}, std::string("has nothing to act on: ") + other + " is needed");
}

std::string Args::required(const char* name) const {
  const auto value = text(name);
  if (!value || value->empty()) fail_usage(std::string(name) + " is missing");
  return *value;
}

double Args::number(const char* name, double otherwise, double low, double high) const {
  const auto value = text(name);
  if (!value) return otherwise;
  const auto parsed = parse_number(*value);
  // Whole limits with all their digits; others as they were written, not as floats have them.
  const auto shown = [](double x) {
    char text[32];
    std::snprintf(text, sizeof text, x == std::floor(x) ? "%.0f" : "%g", x);
    return std::string(text);
  };
  if (!parsed || *parsed < low || *parsed > high)
    fail_usage(std::string(name) + ": not a number from " + shown(low) + " to " + shown(high) + ": " +
               *value);
  return *parsed;
}

int Args::integer(const char* name, int otherwise, int low, int high) const {
  const double value = number(name, otherwise, low, high);
  if (value != std::floor(value)) fail_usage(std::string(name) + " must be a whole number");
  return static_cast<int>(value);
}

std::optional<ImageSize> Args::size(const char* name) const {
  const auto value = text(name);
  if (!value) return std::nullopt;
  const std::size_t x = value->find_first_of("xX");
  const auto side = [&](const std::string& digits) {
    const double pixels = parse_number(digits).value_or(0);
    if (pixels < 16 || pixels > kMaxFrameSide || pixels != std::floor(pixels))
      fail_usage(std::string(name) + ": not a size like 320x240, 16 to " + std::to_string(kMaxFrameSide) +
                 " pixels a side: " + *value);
    return static_cast<int>(pixels);
  };
  return ImageSize{side(value->substr(0, x)), side(x == std::string::npos ? "" : value->substr(x + 1))};
}

std::vector<std::string> Args::list(const char* name) const {
  const auto value = text(name);
  if (!value) return {};
  const std::vector<std::string> words = split_at_commas(*value);
  for (auto word = words.begin(); word != words.end(); ++word) {
    if (word->empty()) fail_usage(std::string(name) + ": a name of the list is empty: '" + *value + "'");
    if (std::find(words.begin(), word, *word) != word)
      fail_usage(std::string(name) + ": the list has " + *word + " twice: " + *value);
  }
  return words;
}

std::optional<std::vector<float>> Args::numbers(const char* name, std::size_t count) const {
  const auto value = text(name);
  if (!value) return std::nullopt;
  std::vector<float> parsed;
  for (const std::string& word : split_at_commas(*value)) {
    const auto number = parse_number(word);
    if (!number || !std::isfinite(static_cast<float>(*number)))
      fail_usage(std::string(name) + ": not numbers separated by commas: " + *value);
    parsed.push_back(static_cast<float>(*number));
  }
  if (parsed.size() != count)
    fail_usage(std::string(name) + " needs " + std::to_string(count) + " numbers: " + *value);
  return parsed;
}

}  // namespace pliant::host
