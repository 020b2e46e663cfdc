#pragma once
// Runs the pliant command in-process, as a user would run it, in a folder of its own.
#include <doctest/doctest.h>

#include <filesystem>

#include "host/commands/command.hpp"
#include "host/io/files.hpp"
#include "pliant/geometry.hpp"
#include "scratch_folder.hpp"
#include "textured_model.hpp"

namespace cli_run {

using namespace pliant;
using namespace pliant::host;

namespace fs = std::filesystem;

struct Ran {
  int code;
  std::string out, err;
};

Ran run_words(const std::vector<std::string>& words);

bool is_one_line(const std::string& text);

bool contains(const std::string& text, const std::string& part);

/// Bad input: exit 1 and one line that has all these parts.
void check_refused(const std::vector<std::string>& words, const std::vector<std::string>& parts);

std::string model_bytes();

/// A model, twelve rendered frames of it with their truth, and the landmarks of frame 0.
struct Sequence : Folder {
  std::string model, video, truth, points;
  Sequence();
  ~Sequence();
  std::string first_points() const;
  std::vector<std::string> track_words() const;
};

float value_after(const std::string& text, const std::string& key);

}  // namespace cli_run
