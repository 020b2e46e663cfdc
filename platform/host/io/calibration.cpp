#include "host/io/calibration.hpp"

#include <yaml-cpp/yaml.h>

#include <array>
#include <cmath>

#include "camera/pixel_aspect.hpp"
#include "host/io/failure.hpp"
#include "host/io/files.hpp"
#include "host/io/numbers.hpp"

namespace pliant::host {

namespace {

/// Elements of a matrix, at most.
constexpr std::size_t kMostNumbers = 64;

/// The keys of a FileStorage file; keys of a nested block are "block.key".
class YamlKeys {
 public:
  YamlKeys(std::string source, const std::string& text) : source_(std::move(source)) {
    if (text.size() > kMostCalibrationBytes)
      fail_input(source_, "is larger than " + std::to_string(kMostCalibrationBytes) + " bytes");
    if (text.find("<?xml") < 4)
      fail_input(source_, "is XML; OpenCV writes YAML where the file's name ends in .yml");
    try {
      root_ = YAML::Load(text);
    } catch (const YAML::Exception& e) {
      fail_input(source_, place(e.mark) + e.msg);
    }
    if (!root_.IsMap()) fail_input(source_, "has no 'image_width'");
  }

  bool has(const std::string& key) const { return find(key).IsDefined(); }
  /// Empty if there is no such key.
  std::string text(const std::string& key) const {
    const YAML::Node found = find(key);
    return found.IsDefined() && found.IsScalar() ? found.Scalar() : "";
  }
  double number(const std::string& key, double low, double high) const {
    return checked(key, existing(key), low, high);
  }
  /// The elements of a matrix, row by row.
  std::vector<double> matrix(const std::string& key) const {
    const auto rows = static_cast<std::size_t>(number(key + ".rows", 1, 64)),
               columns = static_cast<std::size_t>(number(key + ".cols", 1, 64));
    const YAML::Node data = existing(key + ".data");
    if (!data.IsSequence())
      fail_input(source_, place(data.Mark()) + "'" + key + ".data' is not a list in brackets");
    if (data.size() != rows * columns || data.size() > kMostNumbers)
      fail_input(source_, place(data.Mark()) + "'" + key + "' has " + std::to_string(data.size()) +
                              " numbers, not " + std::to_string(rows) + " x " + std::to_string(columns));
    std::vector<double> out;
    for (const YAML::Node& number : data) out.push_back(checked(key + ".data", number, -1e9, 1e9));
    return out;
  }

 private:
  static std::string place(const YAML::Mark& mark) {
    return mark.is_null() ? ""
                          : "line " + std::to_string(mark.line + 1) + ", column " +
                                std::to_string(mark.column + 1) + ": ";
  }
  /// The value of a key; not defined if there is none.
  YAML::Node find(const std::string& key) const {
    const std::size_t dot = key.find('.');
    const YAML::Node block = only(root_, key.substr(0, dot));
    return dot == std::string::npos || !block.IsDefined() ? block : only(block, key.substr(dot + 1));
  }
  /// The member of this name, of which the library would take the first of several.
  YAML::Node only(const YAML::Node& map, const std::string& name) const {
    YAML::Node found(YAML::NodeType::Undefined);
    if (!map.IsMap()) return found;
    for (const auto& member : map) {
      if (!member.first.IsScalar() || member.first.Scalar() != name) continue;
      if (found.IsDefined()) fail_input(source_, place(member.first.Mark()) + "'" + name + "' appears twice");
      found.reset(member.second);
    }
    return found;
  }
  YAML::Node existing(const std::string& key) const {
    const YAML::Node found = find(key);
    if (!found.IsDefined()) fail_input(source_, "has no '" + key + "'");
    return found;
  }
  double checked(const std::string& key, const YAML::Node& node, double low, double high) const {
    const std::string text = node.IsScalar() ? node.Scalar() : "";
    const auto value = parse_number(!text.empty() && text.back() == '.' ? text + "0" : text);
    if (!value)
      fail_input(source_, place(node.Mark()) + "'" + key + "': not a number: '" + text.substr(0, 40) + "'");
    if (*value < low || *value > high)
      fail_input(source_, place(node.Mark()) + "'" + key + "' is out of range");
    return *value;
  }
  std::string source_;
  YAML::Node root_;
};

/// OpenCV's lens model with radial and tangential coefficients: maps ideal to distorted normalised coordinates.
struct FullLens {
  std::array<double, 8> c{};  // k1 k2 p1 p2 k3 k4 k5 k6

  std::array<double, 2> seen(double x, double y) const {
    const double s = x * x + y * y;
    const double radial = (1 + s * (c[0] + s * (c[1] + s * c[4]))) / (1 + s * (c[5] + s * (c[6] + s * c[7])));
    return {x * radial + 2 * c[2] * x * y + c[3] * (s + 2 * x * x),
            y * radial + c[2] * (s + 2 * y * y) + 2 * c[3] * x * y};
  }
};

/// Calls `visit` for a grid of ideal points over the picture.
template <class Visit>
void for_each_point(const Camera& camera, const ImageSize& size, const Visit& visit) {
  constexpr int kSide = 40;
  for (int j = 0; j <= kSide; ++j)
    for (int i = 0; i <= kSide; ++i)
      visit((static_cast<double>(i) * size.width / kSide - static_cast<double>(camera.cx)) /
                static_cast<double>(camera.f),
            (static_cast<double>(j) * size.height / kSide - static_cast<double>(camera.cy)) /
                static_cast<double>(camera.f * camera.aspect));
}

/// Fits k1 and k2 to the full model by least squares: x (k1 s + k2 s^2) = seen - x.
void set_two_coefficients(const FullLens& full, const ImageSize& size, Camera* camera) {
  double a11 = 0, a12 = 0, a22 = 0, b1 = 0, b2 = 0;
  for_each_point(*camera, size, [&](double x, double y) {
    const auto seen = full.seen(x, y);
    const double s = x * x + y * y, along = x * (seen[0] - x) + y * (seen[1] - y);
    a11 += s * s * s;
    a12 += s * s * s * s;
    a22 += s * s * s * s * s;
    b1 += s * along;
    b2 += s * s * along;
  });
  const double determinant = a11 * a22 - a12 * a12;
  camera->k1 = static_cast<float>((a22 * b1 - a12 * b2) / determinant);
  camera->k2 = static_cast<float>((a11 * b2 - a12 * b1) / determinant);
}

float worst_off_px(const FullLens& full, const ImageSize& size, const Camera& camera) {
  double worst = 0;
  for_each_point(camera, size, [&](double x, double y) {
    const auto seen = full.seen(x, y);
    const double s = x * x + y * y;
    const double grow = 1 + s * (static_cast<double>(camera.k1) + s * static_cast<double>(camera.k2));
    worst =
        std::max(worst, std::hypot(seen[0] - grow * x, seen[1] - grow * y) * static_cast<double>(camera.f));
  });
  return static_cast<float>(worst);
}

/// Bad input: coefficients that are not those of FullLens, though they may be as many. OpenCV's program writes `fisheye_model`, ROS
/// `distortion_model`.
void check_lens_model(const std::string& source, const YamlKeys& keys) {
  const std::string fisheye = keys.text("fisheye_model"), model = keys.text("distortion_model");
  if (fisheye != "" && fisheye != "0") fail_input(source, "is of a fisheye model, which is not supported");
  if (model != "" && model != "plumb_bob" && model != "rational_polynomial")
    fail_input(source, "is of the distortion model '" + model.substr(0, 40) + "', which is not supported");
}

/// Ratio of the picture's size to the calibration's.
double scale_between(const std::string& source, const YamlKeys& keys, const ImageSize& size) {
  const double width = keys.number("image_width", 16, 65535), height = keys.number("image_height", 16, 65535);
  const double scale = size.width / width;
  if (std::fabs(scale * height - size.height) > 0.5 + 0.5 * scale)
    fail_input(source, "is for " + number_text(width) + "x" + number_text(height) + " pixels; " +
                           std::to_string(size.width) + "x" + std::to_string(size.height) +
                           " is no uniform scale of that");
  return scale;
}

}  // namespace

Calibration parse_calibration(const std::string& source, const std::string& text, const ImageSize& size) {
  const YamlKeys keys(source, text);
  check_lens_model(source, keys);
  const double scale = scale_between(source, keys, size);
  const auto m = keys.matrix("camera_matrix");
  if (m.size() != 9) fail_input(source, "'camera_matrix' is not 3 x 3");
  if (!(m[0] > 0 && m[4] > 0) || m[1] != 0 || m[3] != 0 || m[6] != 0 || m[7] != 0 || m[8] != 1)
    fail_input(source, "'camera_matrix' is not [fx 0 cx; 0 fy cy; 0 0 1]");
  Calibration out;
  Camera& camera = out.camera;
  camera.f = static_cast<float>(scale * m[0]);
  camera.aspect = static_cast<float>(m[4] / m[0]);
  if (!is_aspect(camera.aspect))
    fail_input(source, "'camera_matrix' has fy / fx = " + number_text(m[4] / m[0]) +
                           ": pixels are supported where it is " +
                           number_text(static_cast<double>(kLeastAspect)) + " to " +
                           number_text(static_cast<double>(kMostAspect)));
  // Pixel centres are at integers, so the scale has its fixed point at the picture's corner (-0.5, -0.5).
  camera.cx = static_cast<float>(scale * (m[2] + 0.5) - 0.5);
  camera.cy = static_cast<float>(scale * (m[5] + 0.5) - 0.5);
  if (keys.has("distortion_coefficients")) {
    const auto d = keys.matrix("distortion_coefficients");
    if (d.size() != 4 && d.size() != 5 && d.size() != 8 && d.size() != 12 && d.size() != 14)
      fail_input(source,
                 "'distortion_coefficients' are " + std::to_string(d.size()) + ", not 4, 5, 8, 12 or 14");
    FullLens full;
    bool has_more = false;
    for (std::size_t k = 0; k < d.size(); ++k) {
      if (k < 8) full.c[k] = d[k];
      if (k >= 8 && d[k] != 0)
        fail_input(source, "has a thin prism or a tilted sensor, which is not supported");
      has_more = has_more || (k >= 2 && d[k] != 0);
    }
    camera.k1 = static_cast<float>(full.c[0]);
    camera.k2 = static_cast<float>(full.c[1]);
    if (has_more) set_two_coefficients(full, size, &camera);
    out.off_px = has_more ? worst_off_px(full, size, camera) : 0;
  }
  if (!(out.off_px <= 0.01f * static_cast<float>(size.width)))
    fail_input(source, "two radial coefficients do not describe this lens: the error is " +
                           number_text(static_cast<double>(out.off_px)) + " px");
  if (!is_possible(Pose{}, camera))
    fail_input(source, "'camera_matrix' has a focal length or a principal point that no camera has");
  Lens lens;
  if (Lens::make(camera, size.width, size.height, &lens) != Status::ok)
    fail_input(source, "the distortion cannot be inverted over the whole picture");
  return out;
}

Lens lens_of(const Camera& camera, const ImageSize& size) {
  Lens lens;
  require(Lens::make(camera, size.width, size.height, &lens), "camera");
  return lens;
}

}  // namespace pliant::host
