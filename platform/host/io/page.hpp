#pragma once
/// \file page.hpp
/// Self-contained HTML pages: templates with places to fill in, and pictures within the page.
#include <string>
#include <utility>
#include <vector>

#include "host/io/image.hpp"

namespace pliant::host {

/// Templates, from the files in pages/.
extern const char* const kPointsPage;
extern const char* const kReportPage;

/// Puts each value in the place of its {{name}}. Every place of the template must have one.
std::string fill_page(const std::string& page,
                      const std::vector<std::pair<std::string, std::string>>& values);

/// Text as it stands in HTML, attributes included.
std::string html_text(const std::string& text);
/// JSON as it may stand within a script element.
std::string script_json(const std::string& json);

/// A picture file as a data: address that every browser shows as `read_image` reads it: PNG and JPEG as they are, but
/// without a JPEG's EXIF (its turning, and where it was taken); anything else as PNG.
std::string picture_address(const std::string& path);
std::string png_address(const Image& image);
std::string jpeg_address(const Image& image, int quality);

}  // namespace pliant::host
