#pragma once
/// \file sheet.hpp
/// A contact sheet: nine pictures of a sequence whose length is not known in advance.
#include <vector>

#include "host/io/image.hpp"

namespace pliant::host {

/// Keeps a bounded, evenly spaced selection of the pictures that it is given, and the last one.
class ContactSheet {
 public:
  static constexpr int kColumns = 3, kRows = 3;

  /// Adds picture number k = 0, 1, 2, ... All have one size and three channels.
  void add(const Image& image);
  bool is_empty() const { return kept_.empty(); }
  struct Picture {
    int number;
    Image image;  ///< shrunk to a cell of the sheet
  };
  /// The pictures on the sheet; the first and the last of the sequence are among them.
  std::vector<Picture> pictures() const;
  /// The sheet, at most 1,600 pixels wide.
  Image image() const;

 private:
  static constexpr std::size_t kMost = 4 * kColumns * kRows;
  std::vector<Picture> kept_;  // numbers 0, stride_, 2 stride_, ...
  Picture last_{0, {}};
  int next_ = 0, stride_ = 1;
};

}  // namespace pliant::host
