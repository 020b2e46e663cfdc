#include "host/render/animation_file.hpp"

#include <cstdio>
#include <cstring>
#include <filesystem>

#include "host/io/failure.hpp"
#include "host/io/files.hpp"
#include "host/io/glb.hpp"
#include "host/render/shown_mesh.hpp"

namespace pliant::host {

namespace {

/// A pose in glTF's axes, metres: the camera's axes rotated by 180 degrees about x. The model's axes are glTF's already.
Vec3 translation_of(const Pose& pose) {
  return 0.001f * Vec3{pose.t.x, -pose.t.y, -pose.t.z};
}
Quat rotation_of(const Pose& pose) {
  return {pose.q.w, pose.q.x, -pose.q.y, -pose.q.z};
}

Json list(Vec3 v) {
  return {v.x, v.y, v.z};
}
Json list(Quat q) {
  return {q.x, q.y, q.z, q.w};
}

Json mesh_of(GlbFile& file, const MeshData& mesh, const Morphs& morphs, int material) {
  Json targets, names, weights;
  for (const MorphTarget& target : morphs.targets) {
    const int position = file.add(target.position, GlbFile::Use::vertices);
    targets.push_back(
        Json::object({{"POSITION", position}, {"NORMAL", file.add(target.normal, GlbFile::Use::vertices)}}));
    names.push_back(target.name);
    weights.push_back(0);
  }
  Json primitive;
  primitive["attributes"] = Json::object({{"POSITION", file.add(morphs.position, GlbFile::Use::vertices)},
                                          {"NORMAL", file.add(morphs.normal, GlbFile::Use::vertices)},
                                          {"TEXCOORD_0", file.add(mesh.uv)}});
  primitive["indices"] = file.add(mesh.faces);
  primitive["material"] = material;
  Json out;
  if (!targets.empty()) {
    primitive["targets"] = std::move(targets);
    out["weights"] = std::move(weights);
    out["extras"]["targetNames"] = std::move(names);
  }
  out["primitives"][0] = std::move(primitive);
  return out;
}

/// Samplers and channels of the one node.
struct Channels {
  Json samplers, channels;  // lists, or null if empty
  void add(int input, int output, const char* path) {
    channels.push_back(Json::object(
        {{"sampler", samplers.size()}, {"target", Json::object({{"node", 0}, {"path", path}})}}));
    samplers.push_back(Json::object({{"input", input}, {"output", output}, {"interpolation", "LINEAR"}}));
  }
};

constexpr char kFrameName[] = "frame_";

/// Bad input: the folder has a frame from `count` on, which this animation would leave beside its own.
void check_folder(const std::string& folder, std::size_t count) {
  std::error_code error;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (name.rfind(kFrameName, 0) != 0 || entry->path().extension() != ".obj") continue;
    const std::string digits = entry->path().stem().string().substr(std::strlen(kFrameName));
    const bool is_frame = !digits.empty() && digits.find_first_not_of("0123456789") == std::string::npos;
    if (is_frame && (digits.size() > 9 || std::stoul(digits) >= count))
      fail_input(folder, "has " + name + " of a longer animation, which would stay beside the " +
                             std::to_string(count) +
                             " frames of this one: remove it, or name another folder");
  }
}

/// Null if nothing moves.
Json animation_of(GlbFile& file, const Morphs& morphs, const Model& model, const Retargeted& track) {
  std::vector<float> times, weights;
  std::vector<Vec3> translations;
  std::vector<Quat> rotations;
  for (const RetargetFrame& frame : track.frames) {
    times.push_back(static_cast<float>(frame.time_s - track.frames.front().time_s));
    const auto w = morph_weights(model, morphs, frame.state.q);
    weights.insert(weights.end(), w.begin(), w.end());
    translations.push_back(translation_of(frame.state.pose));
    Quat q = rotation_of(frame.state.pose);
    if (!rotations.empty()) {  // of the two quaternions of a rotation the one closer to the previous
      const Quat& p = rotations.back();
      if (p.w * q.w + p.x * q.x + p.y * q.y + p.z * q.z < 0) q = {-q.w, -q.x, -q.y, -q.z};
    }
    rotations.push_back(q);
  }
  Channels out;
  const int input = file.add(times);
  if (!morphs.targets.empty()) out.add(input, file.add(weights), "weights");
  if (track.has_pose) {
    out.add(input, file.add(translations, GlbFile::Use::plain), "translation");
    out.add(input, file.add(rotations), "rotation");
  }
  if (out.channels.empty()) return {};
  return Json::object({{"name", "track"}, {"channels", out.channels}, {"samplers", out.samplers}});
}

}  // namespace

std::string animation_glb(const MeshData& mesh, const Morphs& morphs, const Model& model,
                          const Retargeted& track, const std::string& picture, bool is_lit) {
  GlbFile file;
  Json root;
  root["scene"] = 0;
  root["scenes"][0]["nodes"] = Json::array({0});
  root["meshes"][0] = mesh_of(file, mesh, morphs, file.add_material(picture, is_lit));
  Json& node = root["nodes"][0];
  node = Json::object({{"name", "head"}, {"mesh", 0}, {"scale", metres_per_millimetre()}});
  if (track.has_pose) {  // for viewers that do not play animations
    node["translation"] = list(translation_of(track.frames.front().state.pose));
    node["rotation"] = list(rotation_of(track.frames.front().state.pose));
  }
  Json animation = animation_of(file, morphs, model, track);
  if (!animation.is_null()) root["animations"][0] = std::move(animation);
  return file.bytes(std::move(root));
}

void write_obj_frames(const std::string& folder, MeshData mesh, MorphSurface& surface,
                      const Retargeted& track, const std::function<void(std::size_t)>& progress) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) fail_input(folder, "cannot be made: " + error.message());
  check_folder(folder, track.frames.size());
  for (std::size_t k = 0; k < track.frames.size(); ++k) {
    const RetargetFrame& frame = track.frames[k];
    mesh.position = surface.positions(frame.state.q);
    mesh.normal = compute_normals(mesh.position, mesh.faces);
    const Quat& q = frame.state.pose.q;
    const Vec3& t = frame.state.pose.t;
    char head[200], name[40];
    std::snprintf(head, sizeof head,
                  "# time %.6g s; head qw qx qy qz %.6g %.6g %.6g %.6g tx ty tz %.6g %.6g %.6g\n",
                  frame.time_s, static_cast<double>(q.w), static_cast<double>(q.x), static_cast<double>(q.y),
                  static_cast<double>(q.z), static_cast<double>(t.x), static_cast<double>(t.y),
                  static_cast<double>(t.z));
    std::snprintf(name, sizeof name, "%s%05zu.obj", kFrameName, k);
    write_file((std::filesystem::path(folder) / name).string(),
               (track.has_pose ? head : "") + obj_text(mesh));
    progress(k + 1);
  }
}

}  // namespace pliant::host
