#include "host/commands/command.hpp"

#include <algorithm>
#include <cstdio>
#include <exception>

#include "host/io/failure.hpp"

namespace pliant::host {

namespace {

std::vector<Command> commands() {
  return {bake_command(),   learn_command(), info_command(),  mesh_command(),    detect_command(),
          points_command(), fit_command(),   track_command(), animate_command(), render_command(),
          camera_command(), plan_command(),  bench_command()};
}

void print_help(std::ostream& out) {
  out << "usage: pliant COMMAND ...\n";
  for (const Command& c : commands())
    out << "  pliant " << c.name << " " << c.usage << "\n      " << c.summary << "\n";
  out << "`pliant COMMAND --help` lists the options of a command.\n";
}

void print_help(const Command& command, std::ostream& out) {
  out << "usage: pliant " << command.name << " " << command.usage << "\n" << command.summary << "\n";
  for (const Option& o : command.options) {
    std::string left = std::string("  ") + o.name + (o.value == nullptr ? "" : std::string(" ") + o.value);
    left.resize(std::max<std::size_t>(left.size() + 2, 30), ' ');
    out << left << o.help << "\n";
  }
}

/// The exit code after output: 0 if everything was written.
int flushed(Console& console) {
  if (console.out.flush()) return 0;
  console.err << "pliant: standard output: writing failed\n";
  return kBadInput;
}

int run_command(const Command& command, const std::vector<std::string>& words, Console& console) {
  const std::string name = std::string("pliant ") + command.name;
  try {
    const Args args(words, command.options, command.operands, command.optional_operands);
    // A result on standard output is not mixed with notes.
    Console notes{console.err, console.err, console.shows_progress};
    const int code = command.run(args, args.writes_to_standard_output() ? notes : console);
    return code != 0 ? code : flushed(console);
  } catch (const Failure& failure) {
    console.err << name << ": " << failure.what() << "\n";
    if (failure.exit_code() == kBadUsage) console.err << "usage: " << name << " " << command.usage << "\n";
    return failure.exit_code();
  } catch (const std::bad_alloc&) {
    console.err << name << ": not enough memory\n";
  } catch (const std::exception& e) {
    console.err << name << ": " << e.what() << "\n";
  }
  return kBadInput;
}

}  // namespace

int run(const std::vector<std::string>& words, Console& console) {
  if (words.empty()) {
    print_help(console.err);
    return kBadUsage;
  }
  if (words[0] == "--help" || words[0] == "-h" || words[0] == "help") {
    print_help(console.out);
    return flushed(console);
  }
  if (words[0] == "--version") {
    console.out << "pliant " << PLIANT_VERSION_MAJOR << "." << PLIANT_VERSION_MINOR << "."
                << PLIANT_VERSION_PATCH << "\n";
    return flushed(console);
  }
  const std::vector<std::string> rest(words.begin() + 1, words.end());
  for (const Command& command : commands()) {
    if (words[0] != command.name) continue;
    if (std::find(rest.begin(), rest.end(), "--help") == rest.end() &&
        std::find(rest.begin(), rest.end(), "-h") == rest.end())
      return run_command(command, rest, console);
    print_help(command, console.out);
    return flushed(console);
  }
  console.err << "pliant: no such command: " << words[0] << "\n";
  return kBadUsage;
}

std::string Progress::time_left(std::size_t count) const {
  const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - began_;
  if (count == 0 || count > of_ || passed.count() < 2) return "";
  const double left = passed.count() * static_cast<double>(of_ - count) / static_cast<double>(count);
  const auto seconds = static_cast<int>(std::min(left, 360000.0) + 0.5);
  char text[48];
  std::snprintf(text, sizeof text, ", %d:%02d left", seconds / 60, seconds % 60);
  return text;
}

Progress::~Progress() {
  if (shown_) console_.err << "\n" << std::flush;
}

void Progress::note(const std::string& line) {
  console_.err << (shown_ ? "\r\x1b[K" : "") << line << "\n" << std::flush;
  shown_ = false;
}

void Progress::show(std::size_t count) {
  if (!console_.shows_progress || (of_ == 0 && count % 5 != 0)) return;
  console_.err << "\r" << what_ << " " << count;
  if (of_ > 0) console_.err << " of " << of_ << time_left(count) << "\x1b[K";
  console_.err << std::flush;
  shown_ = true;
}

void StageProgress::show(const char* stage, std::size_t done, std::size_t of) {
  if (stage_ != stage || of_ != of || done < done_) counter_.reset();
  if (counter_ == nullptr) {
    stage_ = stage;
    of_ = of;
    counter_ = std::make_unique<Progress>(console_, stage_.c_str(), of);
  }
  done_ = done;
  counter_->show(done);
}

}  // namespace pliant::host
