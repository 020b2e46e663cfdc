#include "host/io/fit_file.hpp"

#include <cmath>

#include "camera/pixel_aspect.hpp"
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
    if (value == nullptr || !value->is_object()) fail_input(where_, "is missing or not an object");
  }
  std::string where(const std::string& name) const { return where_ + ": " + quoted(name); }
  /// Null if there is no such member.
  const Json* find(const char* name) const {
    const auto found = value_->find(name);
    return found == value_->end() ? nullptr : &*found;
  }

  float number(const char* name) const { return number_of(find(name), name); }
  float number(const char* name, float low, float high) const {
    const float value = number(name);
    if (!(value >= low && value <= high)) fail_input(where(name), "is out of range");
    return value;
  }
  std::vector<float> numbers(const char* name, std::size_t count) const {
    const Json* value = find(name);
    if (value == nullptr || !value->is_array() || value->size() != count)
      fail_input(where(name), "is missing or not " + std::to_string(count) + " numbers");
    std::vector<float> out;
    for (const Json& item : *value) out.push_back(number_of(&item, name));
    return out;
  }
  NamedValues named_values(const char* name) const {
    NamedValues out;
    const Json* value = find(name);
    if (value == nullptr || !value->is_object()) fail_input(where(name), "is missing or not an object");
    for (const auto& [key, item] : value->items()) out.emplace_back(key, number_of(&item, key));
    return out;
  }
  std::string string(const char* name) const {
    const Json* value = find(name);
    if (value == nullptr || !value->is_string()) fail_input(where(name), "is missing or not a string");
    return value->get<std::string>();
  }

 private:
  float number_of(const Json* value, const std::string& name) const {
    if (value == nullptr || !value->is_number()) fail_input(where(name), "is missing or not a number");
    const auto number = value->get<float>();
    if (!(std::fabs(number) <= 1e30f)) fail_input(where(name), "is out of range");
    return number;
  }
  std::string where_;
  const Json* value_;
};

std::uint32_t parse_crc(const Members& root) {
  const Json* crc = root.find("model_crc");
  if (crc == nullptr || !crc->is_number_unsigned() || crc->get<std::uint64_t>() > 4294967295u)
    fail_input(root.where("model_crc"), "is missing or not a checksum");
  return crc->get<std::uint32_t>();
}

Pose parse_pose(const Members& pose) {
  const auto q = pose.numbers("q", 4), t = pose.numbers("t", 3);
  const float squared = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
  if (!(squared > 0.9f && squared < 1.1f)) fail_input(pose.where("q"), "is not a unit quaternion");
  if (!(t[2] * kMaxRho > 0.999f && t[2] * kMinRho < 1.001f))  // as in track tables
    fail_input(pose.where("t"), "does not lie between 50 mm and 100 m in front of the camera");
  return {unit_of({q[0], q[1], q[2], q[3]}), {t[0], t[1], t[2]}};
}

void parse_points(const Members& root, const std::string& source, FitFile* fit) {
  const Json* points = root.find("points");
  if (points == nullptr) return;
  if (!points->is_array()) fail_input(root.where("points"), "is not a list");
  for (const Json& item : *points) {
    const Members point(source + ": 'points'", &item);
    const auto is_set = [&point](const char* name) {
      const Json* flag = point.find(name);
      return flag != nullptr && flag->is_boolean() && flag->get<bool>();
    };
    fit->points.push_back({point.string("landmark"),
                           {point.number("x"), point.number("y")},
                           {point.number("dx"), point.number("dy")},
                           is_set("used"),
                           is_set("at_landmark")});
  }
}

Json object_of(const NamedValues& values) {
  Json out = Json::object();
  for (const auto& [name, value] : values) out[name] = value;
  return out;
}

/// The text of an object with a member a line; what has more than eight parts has a line a part.
std::string lines_of(const Json& object) {
  std::string out;
  for (const auto& [name, value] : object.items()) {
    out += (out.empty() ? "{\n  " : ",\n  ") + json_text(name) + ": ";
    if (!value.is_structured() || value.size() <= 8) {
      out += json_text(value);
      continue;
    }
    std::string parts;
    for (const auto& [key, part] : value.items())
      parts += (parts.empty() ? "\n    " : ",\n    ") + (value.is_object() ? json_text(key) + ": " : "") +
               json_text(part);
    out += (value.is_object() ? "{" : "[") + parts + (value.is_object() ? "\n  }" : "\n  ]");
  }
  return out + "\n}\n";
}

}  // namespace

Quat unit_of(Quat q) {
  const float squared = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
  return magnitude(squared - 1) < 1e-6f ? q : normalised(q);
}

bool is_nearly_unit(Quat q) {
  const float squared = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
  return squared > 0.25f && squared < 4;
}

FitFile parse_fit(const std::string& source, const std::string& text) {
  const Json json = parse_json(source, text);
  const Members root(source, &json);
  if (root.number("version") != 1.0f) fail_input(root.where("version"), "is not 1");
  FitFile fit;
  fit.model_crc = parse_crc(root);
  fit.width = static_cast<int>(root.number("width", 1, 65535));
  fit.height = static_cast<int>(root.number("height", 1, 65535));
  const Members camera(root.where("camera"), root.find("camera"));
  constexpr float kMost = kLargestFocalPx;
  fit.camera = {camera.number("f", kSmallestFocalPx, kMost), camera.number("cx", -kMost, kMost),
                camera.number("cy", -kMost, kMost)};
  if (camera.find("k1") != nullptr) fit.camera.k1 = camera.number("k1");
  if (camera.find("k2") != nullptr) fit.camera.k2 = camera.number("k2");
  if (camera.find("aspect") != nullptr) fit.camera.aspect = camera.number("aspect", kLeastAspect, kMostAspect);
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
  if (const Json* unseen = root.find("unseen"); unseen != nullptr && unseen->is_array())
    for (const Json& name : *unseen)
      if (name.is_string()) fit.unseen.push_back(name.get<std::string>());
  parse_points(root, source, &fit);
  return fit;
}

std::string fit_text(const FitFile& fit) {
  const Quat& q = fit.pose.q;
  const Vec3& t = fit.pose.t;
  const Camera& c = fit.camera;
  Json points = Json::array();
  for (const FitPoint& p : fit.points)
    points.push_back(Json::object({{"landmark", p.landmark},
                                   {"x", p.x.x},
                                   {"y", p.x.y},
                                   {"dx", p.residual.x},
                                   {"dy", p.residual.y},
                                   {"used", p.used},
                                   {"at_landmark", p.is_landmark}}));
  return lines_of(Json::object(
      {{"version", 1},
       {"model_crc", fit.model_crc},
       {"width", fit.width},
       {"height", fit.height},
       {"camera",
        Json::object(
            {{"f", c.f}, {"cx", c.cx}, {"cy", c.cy}, {"k1", c.k1}, {"k2", c.k2}, {"aspect", c.aspect}})},
       {"pose", Json::object({{"q", {q.w, q.x, q.y, q.z}}, {"t", {t.x, t.y, t.z}}})},
       {"parameters", object_of(fit.parameters)},
       {"sd", object_of(fit.sd)},
       {"unseen", fit.unseen},
       {"rms_px", fit.rms_px},
       {"inliers", fit.inliers},
       {"landmark_error", fit.landmark_error},
       {"points", points}}));
}

std::vector<std::uint16_t> parameters_named(const Model& model, const std::string& name) {
  const std::uint16_t one = model.find_parameter(name.c_str());
  if (one != kNone) return {one};
  // ARKit's jawLeft and jawRight, mouthLeft and mouthRight are opposite motions, not sides of one.
  if (name == "jaw" || name == "mouth") return {};
  const std::uint16_t left = model.find_parameter((name + "Left").c_str());
  const std::uint16_t right = model.find_parameter((name + "Right").c_str());
  if (left == kNone || right == kNone) return {};
  return {left, right};
}

void GivenParameters::add(const std::string& name, const std::vector<std::uint16_t>& parameters) {
  for (const std::uint16_t k : parameters) {
    const auto [given, is_new] = names_.emplace(k, name);
    if (!is_new) fail_input(source_, "'" + given->second + "' and '" + name + "' give the same parameter");
  }
}

std::vector<std::string> apply(const NamedValues& values, const std::string& source, const Model& model,
                               float* q) {
  std::vector<std::string> unmatched;
  GivenParameters given(source);
  for (const auto& [name, value] : values) {
    const auto found = parameters_named(model, name);
    given.add(name, found);
    for (const std::uint16_t k : found) {
      const Parameter& p = model.parameters()[k];
      if (!(value >= p.minimum && value <= p.maximum))
        fail_input(source, "'" + name + "' is outside its limits " + short_text(p.minimum) + " and " +
                               short_text(p.maximum));
      q[k] = value;
    }
    if (found.empty()) unmatched.push_back(name);
  }
  return unmatched;
}

std::vector<float> all_parameters(const FitFile& fit, const std::string& source, const Model& model) {
  std::vector<float> q(model.parameters().count, 0.0f);
  (void)apply(fit.parameters, source, model, q.data());
  return q;
}

void list_unmatched(const std::vector<std::string>& names, const std::string& source, std::ostream& err) {
  if (names.empty()) return;
  err << source << ": the model has no parameter";
  for (std::size_t i = 0; i < names.size(); ++i) err << (i > 0 ? ", " : " ") << names[i];
  err << "\n";
}

void list_clamped(const std::vector<std::string>& names, const std::string& source, std::ostream& err,
                  const std::string& hint) {
  if (names.empty()) return;
  err << source << ": outside the model's limits, clamped:";
  for (const std::string& name : names) err << " " << name;
  err << hint << "\n";
}

}  // namespace pliant::host
