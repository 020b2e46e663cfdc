#include "host/render/sheet.hpp"

#include <algorithm>

#include "host/render/draw.hpp"

namespace pliant::host {

namespace {
constexpr int kMostWidth = 1600, kGap = 4;
}

void ContactSheet::add(const Image& image) {
  const int cell = (kMostWidth - (kColumns + 1) * kGap) / kColumns;
  last_ = {next_, shrunk_to(image, cell, cell)};
  if (next_ % stride_ == 0) kept_.push_back(last_);
  ++next_;
  if (kept_.size() <= kMost) return;
  stride_ *= 2;
  kept_.erase(
      std::remove_if(kept_.begin(), kept_.end(), [this](const Picture& k) { return k.number % stride_ != 0; }),
      kept_.end());
}

std::vector<ContactSheet::Picture> ContactSheet::pictures() const {
  constexpr int kCells = kColumns * kRows;
  std::vector<Picture> chosen;
  for (int cell = 0; cell < kCells; ++cell) {
    const int wanted = (next_ - 1) * cell / (kCells - 1);
    const Picture* best = &last_;
    for (const Picture& k : kept_)
      if (std::abs(k.number - wanted) < std::abs(best->number - wanted)) best = &k;
    if (chosen.empty() || chosen.back().number != best->number) chosen.push_back(*best);
  }
  return chosen;
}

Image ContactSheet::image() const {
  const auto cells = pictures();
  const int width = last_.image.width, height = last_.image.height;
  Image sheet(kColumns * (width + kGap) + kGap, kRows * (height + kGap) + kGap, 3, 24);
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const int column = static_cast<int>(k) % kColumns, row = static_cast<int>(k) / kColumns;
    paste(sheet, cells[k].image, kGap + column * (width + kGap), kGap + row * (height + kGap));
  }
  return sheet;
}

}  // namespace pliant::host
