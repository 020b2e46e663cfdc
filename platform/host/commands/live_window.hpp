#pragma once
/// \file live_window.hpp
/// A window that shows pictures while they are made, through the ffplay program.
#include <optional>

#include "host/io/y4m_writer.hpp"

namespace pliant::host {

class LiveWindow {
 public:
  /// \param rate  pictures a second, at most. Bad input if there is no ffplay program.
  explicit LiveWindow(FrameRate rate);

  /// Shows a picture of the first one's size. Nothing happens once the window is closed. Bad input if ffplay fails.
  void show(const Image& image);
  /// Whether the window can show another picture: its user has not closed it.
  bool is_open() const { return video_.has_value(); }
  /// Waits until the last picture was shown, and closes the window.
  void close();

 private:
  std::optional<Y4mWriter> video_;
};

}  // namespace pliant::host
