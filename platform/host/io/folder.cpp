// Reads a folder of pictures as frames.
#include <algorithm>
#include <cctype>
#include <filesystem>

#include "host/io/failure.hpp"
#include "host/io/image.hpp"
#include "host/io/pnm.hpp"
#include "host/io/sources.hpp"
#include "host/io/words.hpp"

namespace pliant::host {
namespace {

bool is_pnm(const std::string& ending) {
  return ending == ".pgm" || ending == ".ppm" || ending == ".pnm";
}

std::string ending_of(const std::string& path) {
  return in_lower_case(std::filesystem::path(path).extension().string());
}

// `colour` becomes what the file holds beyond luma.
Status read_luma(const std::string& path, LumaPicture& picture, Image& colour, std::string& message) {
  if (is_pnm(ending_of(path))) {
    const Status status = read_pnm(path, picture, message);
    colour = std::move(picture.colour);
    return status;
  }
  try {
    colour = read_image(path);
    Image grey = to_grey(colour);
    picture = {grey.width, grey.height, std::move(grey.pixels), {}};
    return Status::ok;
  } catch (const Failure& failure) {
    message = failure.what();
    return Status::io_error;
  }
}

class PictureSource : public FrameSource {
 public:
  PictureSource(std::vector<std::string> paths, LumaPicture first, Image colour)
      : paths_(std::move(paths)), picture_(std::move(first)), colour_(std::move(colour)) {
    count_ = paths_.size();
    width_ = picture_.width;
    height_ = picture_.height;
  }

  Image colour() const override { return colour_; }

 private:
  Status read(std::uint32_t index, FrameView& frame) override {
    if (index >= paths_.size()) return Status::end_of_stream;
    // The first picture was read to know the size.
    if (index > 0) {
      std::string message;
      colour_ = {};
      if (const Status s = read_luma(paths_[index], picture_, colour_, message); s != Status::ok)
        return fail(s, message);
      if (picture_.width != width_ || picture_.height != height_)
        return fail(Status::size_mismatch, paths_[index] + ": is " + std::to_string(picture_.width) + "x" +
                                               std::to_string(picture_.height) +
                                               ", but the first picture is " + std::to_string(width_) + "x" +
                                               std::to_string(height_));
    }
    frame.data = picture_.pixels.data();
    return Status::ok;
  }

  std::vector<std::string> paths_;
  LumaPicture picture_;
  Image colour_;  // empty if the picture has no colour
};

bool is_digit(char c) {
  return std::isdigit(static_cast<unsigned char>(c)) != 0;
}

// The digits at `i` without leading zeros; moves i after them.
std::string number_at(const std::string& s, std::size_t& i) {
  while (i < s.size() && s[i] == '0') ++i;
  const std::size_t start = i;
  while (i < s.size() && is_digit(s[i])) ++i;
  return s.substr(start, i - start);
}

}  // namespace

bool has_picture_extension(const std::string& path) {
  const std::string ending = ending_of(path);
  return is_pnm(ending) || ending == ".png" || ending == ".jpg" || ending == ".jpeg";
}

bool is_file_of_folder(const std::filesystem::directory_entry& entry) {
  std::error_code error;
  return entry.path().filename().string()[0] != '.' && (entry.is_regular_file(error) || !entry.exists(error));
}

bool is_picture_of_folder(const std::filesystem::directory_entry& entry) {
  return has_picture_extension(entry.path().string()) && is_file_of_folder(entry);
}

bool is_naturally_before(const std::string& a, const std::string& b) {
  std::size_t i = 0, k = 0;
  while (i < a.size() && k < b.size()) {
    if (is_digit(a[i]) && is_digit(b[k])) {
      const std::string m = number_at(a, i), n = number_at(b, k);
      if (m.size() != n.size()) return m.size() < n.size();
      if (m != n) return m < n;
    } else {
      if (a[i] != b[k]) return static_cast<unsigned char>(a[i]) < static_cast<unsigned char>(b[k]);
      ++i, ++k;
    }
  }
  const std::size_t left_a = a.size() - i, left_b = b.size() - k;
  return left_a != left_b ? left_a < left_b : a < b;
}

OpenedFrames open_pictures(std::vector<std::string> paths) {
  LumaPicture first;
  Image colour;
  OpenedFrames opened;
  if (read_luma(paths.front(), first, colour, opened.message) != Status::ok) return opened;
  opened.source = std::make_unique<PictureSource>(std::move(paths), std::move(first), std::move(colour));
  return opened;
}

std::vector<std::string> pictures_in(const std::string& folder, std::error_code& error) {
  std::vector<std::string> paths;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error))
    if (is_picture_of_folder(*entry)) paths.push_back(entry->path().string());
  std::sort(paths.begin(), paths.end(), is_naturally_before);
  return paths;
}

OpenedFrames open_folder(const std::string& path) {
  std::error_code error;
  std::vector<std::string> paths = pictures_in(path, error);
  if (error) return {nullptr, path + ": " + error.message()};
  if (paths.empty()) return {nullptr, path + ": no PNG, JPEG, PGM or PPM picture in this folder"};
  return open_pictures(std::move(paths));
}

}  // namespace pliant::host
