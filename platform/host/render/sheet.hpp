#pragma once
/// \file sheet.hpp
/// A contact sheet: nine pictures of a sequence whose length is not known in advance.
#include <cstddef>
#include <functional>
#include <vector>

#include "host/io/image.hpp"

namespace pliant::host {

/// Keeps a bounded, evenly spaced selection of the pictures that it is given, and the last one. Only those are made.
class ContactSheet {
 public:
  static constexpr int kColumns = 3, kRows = 3;

  /// \param expected  number of pictures that will come; 0: unknown, and more pictures are made than are needed.
  explicit ContactSheet(std::size_t expected = 0);

  /// Whether the next picture may be shown.
  bool wants_next() const { return next_ % stride_ == 0 || next_ + 1 >= expected_; }
  /// Adds picture number k = 0, 1, 2, ..., which `make` gives. It is called now, or later for the last picture. All have one
  /// size and three channels.
  void add(std::function<Image()> make);
  /// Counts a picture that is not wanted.
  void skip() { ++next_; }
  struct Picture {
    int number;
    Image image;  ///< shrunk to a cell of the sheet
  };
  /// The pictures on the sheet; the first and the last that were added are among them. Precondition: one was added.
  std::vector<Picture> pictures() const;
  /// The sheet, at most 1,600 pixels wide.
  Image image() const;

 private:
  static constexpr std::size_t kMost = 4 * kColumns * kRows;
  static Image cell_of(const Image& image);

  std::vector<Picture> kept_;  // numbers 0, stride_, 2 stride_, ...
  std::function<Image()> make_last_;
  int next_ = 0, last_ = 0, expected_, stride_;
};

}  // namespace pliant::host
