#pragma once
/// \file other_pictures.hpp
/// Photographs without faces: backgrounds, and what a detector must not find.
#include <string>
#include <vector>

#include "host/io/image.hpp"
#include "host/learn/mipmap.hpp"
#include "host/learn/sample_random.hpp"

namespace pliant::host::learn {

/// Grey photographs without faces, in memory.
class OtherPictures {
 public:
  OtherPictures() = default;
  /// Takes pictures as they are; colour becomes grey.
  explicit OtherPictures(const std::vector<Image>& pictures);

  std::size_t count() const { return pictures_.size(); }
  /// Grey.
  const Image& picture(std::size_t k) const { return pictures_[k]; }

  /// A random part of a random picture, mirrored half of the time, upright. Sizes of parts are spread over octaves: from one
  /// source pixel a pixel (or less, in a small picture) to the whole picture.
  /// \pre count() > 0.
  Image crop(int width, int height, SampleRandom& random) const;

 private:
  std::vector<Image> pictures_;
  std::vector<Mipmap> mipmaps_;
};

/// Reads all pictures (JPEG, PNG, PNM) of a folder and its subfolders, in the order of their paths. Larger ones than
/// `kOtherPictureSide` px are shrunk to it. A file that is no picture is passed over.
OtherPictures read_other_pictures(const std::string& folder);
constexpr int kOtherPictureSide = 1280;

}  // namespace pliant::host::learn
