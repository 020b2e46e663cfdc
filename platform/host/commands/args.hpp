#pragma once
/// \file args.hpp
/// Parses the words of a command line.
#include <initializer_list>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host/io/image.hpp"

namespace pliant::host {

/// What the value of an option is.
enum class Takes : unsigned char {
  text,    ///< a number, a name
  texts,   ///< the option may be given several times
  input,   ///< a file or folder that is read
  output,  ///< a file that is written; "-" is standard output
};

struct Option {
  const char* name;   ///< with its dashes: "-o", "--size"
  const char* value;  ///< name of the value in the help, for a file its format; null for a flag
  const char* help;
  Takes takes = Takes::text;
};

/// A command line, split into positional words and options. Every error is bad usage (failure.hpp): also an output that is an
/// input of the same command or the target of another output, and one whose name ends as that of another format.
class Args {
 public:
  /// \param words     the words after the name of the command; "--name value" and "--name=value" are the same, also for -o.
  /// \param operands  number of required positional words.
  /// \param optional  number of further positional words that are allowed.
  Args(const std::vector<std::string>& words, const std::vector<Option>& options, std::size_t operands,
       std::size_t optional = 0);

  /// Whether a result goes to standard output.
  bool writes_to_standard_output() const { return writes_to_standard_output_; }
  const std::string& operand(std::size_t i) const { return operands_[i]; }
  std::size_t operand_count() const { return operands_.size(); }
  bool has(const char* name) const { return values_.count(name) != 0; }
  std::optional<std::string> text(const char* name) const;
  /// All values of an option that may repeat, in the order given.
  std::vector<std::string> texts(const char* name) const;
  /// Bad usage if one of these options is given: "OPTION `why`".
  void refuse(std::initializer_list<const char*> options, const std::string& why) const;
  /// Bad usage if an option is given without the one that it acts on.
  void check_needs(const char* option, const char* other) const;
  /// The value of a required option.
  std::string required(const char* name) const;
  /// A finite number in [low, high]; `otherwise` without the option.
  double number(const char* name, double otherwise, double low, double high) const;
  int integer(const char* name, int otherwise, int low, int high) const;
  /// "WxH", 16 to 16384 pixels a side.
  std::optional<ImageSize> size(const char* name) const;
  /// The words of a list that commas separate, of which none is empty or there twice; nothing without the option.
  std::vector<std::string> list(const char* name) const;
  /// Exactly `count` finite numbers, separated by commas.
  std::optional<std::vector<float>> numbers(const char* name, std::size_t count) const;

 private:
  void check_files(const std::vector<Option>& options);

  bool writes_to_standard_output_ = false;
  std::vector<std::string> operands_;
  std::map<std::string, std::vector<std::string>> values_;
};

}  // namespace pliant::host
