#pragma once
/// \file page.hpp
/// Makes self-contained HTML pages from templates.
#include <string>
#include <utility>
#include <vector>

#include "host/io/image.hpp"

namespace pliant::host {

/// The templates and scripts: the files in pages/.
extern const char* const kPointsPage;
extern const char* const kPointsScript;
extern const char* const kPointsFileScript;
extern const char* const kSurfaceFitScript;
extern const char* const kReportPage;

/// Replaces each {{name}} of a template by its value. Every name in the template must have a value.
std::string fill_page(const std::string& page,
                      const std::vector<std::pair<std::string, std::string>>& values);

/// Escapes a text for HTML and its attributes.
std::string html_text(const std::string& text);
/// Escapes JSON for a script element.
std::string script_json(const std::string& json);

/// Bytes as text.
std::string base64(const std::string& bytes);

/// A picture as a data: address, of which a browser shows what `image_in` reads of the file's bytes. PNG and JPEG keep their bytes,
/// without a JPEG's EXIF data (location). A JPEG whose orientation is not upright is turned and written anew. Other formats become
/// PNG.
std::string picture_address(const Image& image, const std::string& bytes);
std::string png_address(const Image& image);
std::string jpeg_address(const Image& image, int quality);

}  // namespace pliant::host
