#pragma once
/// \file y4m_output.hpp
/// Writes a Y4M file that gets its name only when it is complete.
#include <optional>
#include <string>

#include "host/io/failure.hpp"
#include "host/io/files.hpp"
#include "host/io/image.hpp"
#include "host/io/y4m_writer.hpp"

namespace pliant::host {

/// Writes pictures of one size, all grey or all colour as the first one.
class Y4mOutput {
 public:
  Y4mOutput(const std::string& path, FrameRate rate) : pending_(path), rate_(rate) {}

  void write(const Image& image) {
    const bool is_grey = image.channels == 1;
    if (!is_open_) {
      const auto colour = is_grey ? Y4mWriter::Colour::mono : Y4mWriter::Colour::yuv420;
      check(writer_.open(pending_.working_path(), image.width, image.height, rate_, colour));
      is_open_ = true;
    }
    check(is_grey ? writer_.write_luma(image.pixels.data()) : writer_.write_rgb(image.pixels.data()));
  }
  void commit() {
    if (is_open_) check(writer_.close());
    pending_.commit();
  }

 private:
  void check(Status status) const {
    if (status != Status::ok)
      fail_input(pending_.path(), writer_.message().empty() ? text(status) : writer_.message());
  }
  PendingFile pending_;
  FrameRate rate_;
  Y4mWriter writer_;
  bool is_open_ = false;
};

}  // namespace pliant::host
