#include "host/io/fit_file.hpp"

#include <cmath>

#include "host/io/failure.hpp"
#include "host/io/files.hpp"
#include "host/io/json.hpp"
#include "host/io/numbers.hpp"
#include "pliant/lens.hpp"

namespace pliant::host {

namespace {

/// Reads the members of an object; errors name the file and the member.
class Members {
 public:
  Members(std::string where, const Json* value) : where_(std::move(where)), value_(value) {
    if (value == nullptr || value->object() == nullptr) fail_input(where_, "is missing or not an object");
  }
  std::string where(const std::string& name) const { return where_ + ": '" + name + "'"; }
  const Json* find(const char* name) const { return value_->find(name); }

  float number(const char* name) const { return number_of(find(name), name); }
  float number(const char* name, float low, float high) const {
    const float value = number(name);
    if (!(value >= low && value <= high)) fail_input(where(name), "is out of range");
    return value;
  }
  std::vector<float> numbers(const char* name, std::size_t count) const {
    const Json* value = find(name);
    if (value == nullptr || value->array() == nullptr || value->array()->size() != count)
      fail_input(where(name), "is missing or not " + std::to_string(count) + " numbers");
    std::vector<float> out;
    for (const Json& item : *value->array()) out.push_back(number_of(&item, name));
    return out;
  }
  NamedValues named_values(const char* name) const {
    NamedValues out;
    const Json* value = find(name);
    if (value == nullptr || value->object() == nullptr)
      fail_input(where(name), "is missing or not an object");
    for (const auto& [key, item] : *value->object()) out.emplace_back(key, number_of(&item, key));
    return out;
  }
  std::string string(const char* name) const {
    const Json* value = find(name);
    if (value == nullptr || value->string() == nullptr) fail_input(where(name), "is missing or not a string");
    return *value->string();
  }

 private:
  float number_of(const Json* value, const std::string& name) const {
    if (value == nullptr || value->number() == nullptr) fail_input(where(name), "is missing or not a number");
    if (!(std::fabs(*value->number()) <= 1e30)) fail_input(where(name), "is out of range");
    return static_cast<float>(*value->number());
  }
  std::string where_;
  const Json* value_;
};

std::uint32_t parse_crc(const Members& root) {
  const Json* crc = root.find("model_crc");
  const double* value = crc == nullptr ? nullptr : crc->number();
  if (value == nullptr || !(*value >= 0 && *value <= 4294967295.0))
    fail_input(root.where("model_crc"), "is missing or not a checksum");
  return static_cast<std::uint32_t>(*value);
}

Pose parse_pose(const Members& pose) {
  const auto q = pose.numbers("q", 4), t = pose.numbers("t", 3);
  const float squared = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
  if (!(squared > 0.9f && squared < 1.1f)) fail_input(pose.where("q"), "is not a unit quaternion");
  if (!(t[2] > 0)) fail_input(pose.where("t"), "lies behind the camera");
  return {unit_of({q[0], q[1], q[2], q[3]}), {t[0], t[1], t[2]}};
}

void parse_points(const Members& root, const std::string& source, FitFile* fit) {
  const Json* points = root.find("points");
  if (points == nullptr) return;
  if (points->array() == nullptr) fail_input(root.where("points"), "is not a list");
  for (const Json& item : *points->array()) {
    const Members point(source + ": 'points'", &item);
    const auto is_set = [&point](const char* name) {
      const Json* flag = point.find(name);
      return flag != nullptr && flag->boolean() != nullptr && *flag->boolean();
    };
    fit->points.push_back({point.string("landmark"),
                           {point.number("x"), point.number("y")},
                           {point.number("dx"), point.number("dy")},
                           is_set("used"),
                           is_set("at_landmark")});
  }
}

Json::Object object_of(const NamedValues& values) {
  Json::Object out;
  for (const auto& [name, value] : values) out.emplace_back(name, Json(static_cast<double>(value)));
  return out;
}

Json number(float value) {
  return Json(static_cast<double>(value));
}

}  // namespace

Quat unit_of(Quat q) {
  const float squared = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
  return magnitude(squared - 1) < 1e-6f ? q : normalised(q);
}

FitFile parse_fit(const std::string& source, const std::string& text) {
  const Json json = Json::parse(source, text);
  const Members root(source, &json);
  if (root.number("version") != 1.0f) fail_input(root.where("version"), "is not 1");
  FitFile fit;
  fit.model_crc = parse_crc(root);
  fit.width = static_cast<int>(root.number("width", 1, 65535));
  fit.height = static_cast<int>(root.number("height", 1, 65535));
  const Members camera(root.where("camera"), root.find("camera"));
  fit.camera = {camera.number("f", 1e-3f, 1e7f), camera.number("cx"), camera.number("cy")};
  if (camera.find("k1") != nullptr) fit.camera.k1 = camera.number("k1");
  if (camera.find("k2") != nullptr) fit.camera.k2 = camera.number("k2");
  if (camera.find("aspect") != nullptr) fit.camera.aspect = camera.number("aspect", 0.5f, 2);
  Lens lens;
  if (Lens::make(fit.camera, fit.width, fit.height, &lens) != Status::ok)
    fail_input(root.where("camera"), "has a lens that cannot be inverted over the whole picture");
  fit.pose = parse_pose(Members(root.where("pose"), root.find("pose")));
  fit.parameters = root.named_values("parameters");
  if (root.find("sd") != nullptr) fit.sd = root.named_values("sd");
  if (root.find("rms_px") != nullptr) fit.rms_px = root.number("rms_px");
  if (root.find("inliers") != nullptr)
    fit.inliers = static_cast<std::size_t>(root.number("inliers", 0, 65535));
  if (root.find("landmark_error") != nullptr) fit.landmark_error = root.number("landmark_error", 0, 100);
  if (const Json* unseen = root.find("unseen"); unseen != nullptr && unseen->array() != nullptr)
    for (const Json& name : *unseen->array())
      if (name.string() != nullptr) fit.unseen.push_back(*name.string());
  parse_points(root, source, &fit);
  return fit;
}

std::string fit_text(const FitFile& fit) {
  const Quat& q = fit.pose.q;
  const Vec3& t = fit.pose.t;
  Json::Array unseen, points;
  for (const std::string& name : fit.unseen) unseen.push_back(Json(name));
  for (const FitPoint& p : fit.points)
    points.push_back(Json(Json::Object{{"landmark", Json(p.landmark)},
                                       {"x", number(p.x.x)},
                                       {"y", number(p.x.y)},
                                       {"dx", number(p.residual.x)},
                                       {"dy", number(p.residual.y)},
                                       {"used", Json(p.used)},
                                       {"at_landmark", Json(p.is_landmark)}}));
  return Json(Json::Object{
                  {"version", Json(1)},
                  {"model_crc", Json(static_cast<double>(fit.model_crc))},
                  {"width", Json(fit.width)},
                  {"height", Json(fit.height)},
                  {"camera", Json(Json::Object{{"f", number(fit.camera.f)},
                                               {"cx", number(fit.camera.cx)},
                                               {"cy", number(fit.camera.cy)},
                                               {"k1", number(fit.camera.k1)},
                                               {"k2", number(fit.camera.k2)},
                                               {"aspect", number(fit.camera.aspect)}})},
                  {"pose", Json(Json::Object{
                               {"q", Json(Json::Array{number(q.w), number(q.x), number(q.y), number(q.z)})},
                               {"t", Json(Json::Array{number(t.x), number(t.y), number(t.z)})}})},
                  {"parameters", Json(object_of(fit.parameters))},
                  {"sd", Json(object_of(fit.sd))},
                  {"unseen", Json(unseen)},
                  {"rms_px", number(fit.rms_px)},
                  {"inliers", Json(static_cast<double>(fit.inliers))},
                  {"landmark_error", number(fit.landmark_error)},
                  {"points", Json(points)}})
      .text();
}

std::vector<std::uint16_t> parameters_named(const Model& model, const std::string& name) {
  const std::uint16_t one = model.find_parameter(name.c_str());
  if (one != kNone) return {one};
  const std::uint16_t left = model.find_parameter((name + "Left").c_str());
  const std::uint16_t right = model.find_parameter((name + "Right").c_str());
  if (left == kNone || right == kNone) return {};
  return {left, right};
}

std::vector<std::string> apply(const NamedValues& values, const std::string& source, const Model& model,
                               float* q) {
  std::vector<std::string> unmatched;
  for (const auto& [name, value] : values) {
    const auto found = parameters_named(model, name);
    for (const std::uint16_t k : found) {
      const Parameter& p = model.parameters()[k];
      if (!(value >= p.minimum && value <= p.maximum))
        fail_input(source, "'" + name + "' is outside its limits " +
                               number_text(static_cast<double>(p.minimum)) + " and " +
                               number_text(static_cast<double>(p.maximum)));
      q[k] = value;
    }
    if (found.empty()) unmatched.push_back(name);
  }
  return unmatched;
}

void list_unmatched(const std::vector<std::string>& names, const std::string& source, std::ostream& err) {
  if (names.empty()) return;
  err << source << ": the model has no parameter";
  for (std::size_t i = 0; i < names.size(); ++i) err << (i > 0 ? ", " : " ") << names[i];
  err << "\n";
}

}  // namespace pliant::host
