#include "host/render/sheet.hpp"

#include <algorithm>

#include "host/render/draw.hpp"

namespace pliant::host {

namespace {
constexpr int kMostWidth = 1600, kGap = 4;
}

// Half of what may be kept is twice what is shown: as even as is needed.
ContactSheet::ContactSheet(std::size_t expected)
    : expected_(static_cast<int>(std::min<std::size_t>(expected, 1 << 30))),
      stride_(std::max(1, expected_ / static_cast<int>(kMost / 2))) {}

Image ContactSheet::cell_of(const Image& image) {
  constexpr int kCell = (kMostWidth - (kColumns + 1) * kGap) / kColumns;
  return shrunk_to(image, kCell, kCell);
}

void ContactSheet::add(std::function<Image()> make) {
  if (next_ % stride_ == 0) kept_.push_back({next_, cell_of(make())});
  make_last_ = std::move(make);
  last_ = next_;
  ++next_;
  if (kept_.size() <= kMost) return;
  stride_ *= 2;
  kept_.erase(std::remove_if(kept_.begin(), kept_.end(),
                             [this](const Picture& k) { return k.number % stride_ != 0; }),
              kept_.end());
}

std::vector<ContactSheet::Picture> ContactSheet::pictures() const {
  constexpr int kCells = kColumns * kRows;
  const Picture last{last_, cell_of(make_last_())};
  std::vector<Picture> chosen;
  for (int cell = 0; cell < kCells; ++cell) {
    const int wanted = last_ * cell / (kCells - 1);
    const Picture* best = &last;
    for (const Picture& k : kept_)
      if (std::abs(k.number - wanted) < std::abs(best->number - wanted)) best = &k;
    if (chosen.empty() || chosen.back().number != best->number) chosen.push_back(*best);
  }
  return chosen;
}

Image ContactSheet::image() const {
  const auto cells = pictures();
  const int width = cells[0].image.width, height = cells[0].image.height;
  Image sheet(kColumns * (width + kGap) + kGap, kRows * (height + kGap) + kGap, 3, 24);
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const int column = static_cast<int>(k) % kColumns, row = static_cast<int>(k) / kColumns;
    paste(sheet, cells[k].image, kGap + column * (width + kGap), kGap + row * (height + kGap));
  }
  return sheet;
}

}  // namespace pliant::host
