#include "host/commands/live_window.hpp"

#include "host/io/child_process.hpp"
#include "host/io/failure.hpp"

namespace pliant::host {

LiveWindow::LiveWindow(FrameRate rate) {
  auto player = ChildProcess::start(
      {"ffplay", "-v", "error", "-autoexit", "-window_title", "pliant", "-f", "yuv4mpegpipe", "-i", "-"},
      ChildProcess::Pipe::to_input);
  if (player == nullptr)
    fail_input("--show", "the program ffplay is not installed (it comes with ffmpeg: apt install ffmpeg)");
  video_.emplace(std::move(player), "ffplay", rate);
}

void LiveWindow::show(const Image& image) {
  if (!video_) return;
  try {
    video_->write(image);
  } catch (const Failure&) {
    // A window that is closed no longer reads, and neither does a player that has failed.
    const std::string why = video_->end_program();
    video_.reset();
    if (!why.empty()) fail_input("ffplay", why);
  }
}

void LiveWindow::close() {
  if (video_) video_->commit();
  video_.reset();
}

}  // namespace pliant::host
