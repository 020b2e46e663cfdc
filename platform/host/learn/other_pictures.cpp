#include "host/learn/other_pictures.hpp"

#include <algorithm>
#include <filesystem>

#include "host/io/failure.hpp"
#include "host/io/sources.hpp"

namespace pliant::host::learn {

OtherPictures::OtherPictures(const std::vector<Image>& pictures) {
  for (const Image& picture : pictures) {
    pictures_.push_back(to_grey(picture));
    mipmaps_.emplace_back(pictures_.back());
  }
}

Image OtherPictures::crop(int width, int height, SampleRandom& random) const {
  const Mipmap& source = mipmaps_[random.below(mipmaps_.size())];
  const float largest = min(static_cast<float>(source.width()) / static_cast<float>(width),
                            static_cast<float>(source.height()) / static_cast<float>(height));
  const float step = random.octaves_between(min(1, largest), max(1, largest));
  const float x0 = random.unit() * (static_cast<float>(source.width()) - step * static_cast<float>(width));
  const float y0 = random.unit() * (static_cast<float>(source.height()) - step * static_cast<float>(height));
  const bool is_mirrored = random.chance(0.5f);
  const Mipmap::Detail detail = source.detail_for(step);
  Image out(width, height, 1);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const int column = is_mirrored ? width - 1 - x : x;
      const Vec2 at{x0 + step * (static_cast<float>(column) + 0.5f) - 0.5f,
                    y0 + step * (static_cast<float>(y) + 0.5f) - 0.5f};
      *out.at(x, y) = static_cast<std::uint8_t>(source.at(at, detail) + 0.5f);
    }
  return out;
}

OtherPictures read_other_pictures(const std::string& folder) {
  std::error_code error;
  std::vector<std::string> paths;
  for (std::filesystem::recursive_directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error))
    if (is_picture_of_folder(*entry)) paths.push_back(entry->path().string());
  if (error) fail_input(folder, error.message());
  std::sort(paths.begin(), paths.end());
  std::vector<Image> pictures;
  for (const std::string& path : paths) {
    try {
      pictures.push_back(shrunk_to(to_grey(read_image(path)), kOtherPictureSide, kOtherPictureSide));
    } catch (const Failure&) {
      continue;
    }
  }
  if (pictures.empty()) fail_input(folder, "holds no pictures");
  return OtherPictures(pictures);
}

}  // namespace pliant::host::learn
