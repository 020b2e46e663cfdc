#include "host/render/raster.hpp"

namespace pliant::host {

Raster::Raster(int width, int height, int samples) : width_(width), height_(height), samples_(samples) {
  const auto count = static_cast<std::size_t>(width * samples) * static_cast<std::size_t>(height * samples);
  inverse_depth_.resize(count);
  grey_.resize(count);
}

void Raster::clear() {
  std::fill(inverse_depth_.begin(), inverse_depth_.end(), 0.0f);
}

float Raster::value(int x, int y, float background) const {
  float sum = 0;
  for (int j = y * samples_; j < (y + 1) * samples_; ++j)
    for (int i = x * samples_; i < (x + 1) * samples_; ++i)
      sum += inverse_depth_[index(i, j)] > 0 ? grey_[index(i, j)] : background;
  return sum / static_cast<float>(samples_ * samples_);
}

float Raster::coverage(int x, int y) const {
  int covered = 0;
  for (int j = y * samples_; j < (y + 1) * samples_; ++j)
    for (int i = x * samples_; i < (x + 1) * samples_; ++i)
      covered += inverse_depth_[index(i, j)] > 0 ? 1 : 0;
  return static_cast<float>(covered) / static_cast<float>(samples_ * samples_);
}

}  // namespace pliant::host
