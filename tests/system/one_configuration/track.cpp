// track_cpp face.plm points.csv frames.y4m: prints pose, parameters and landmarks of every frame as `pliant track` does.
#include <cstdio>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "pliant/pliant.hpp"

int main(int, char** words) {
  std::ostringstream file;
  file << std::ifstream(words[1], std::ios::binary).rdbuf();
  const std::string bytes = file.str();
  std::vector<std::uint32_t> table(bytes.size() / 4 + 1);  // a table starts at a multiple of four bytes
  bytes.copy(reinterpret_cast<char*>(table.data()), bytes.size());
  pliant::Model model;
  if (pliant::Model::open(table.data(), bytes.size(), &model) != pliant::Status::ok) return 1;

  static pliant::Tracker tracker;
  const pliant::TrackerLimits limits;
  std::vector<std::max_align_t> memory(pliant::measured_bytes<pliant::Tracker>(model, limits) / sizeof(std::max_align_t) + 1);
  pliant::Arena arena(memory.data(), memory.size() * sizeof(std::max_align_t));
  if (pliant::create_in(arena, tracker, model, limits) != pliant::Status::ok) return 1;

  std::ifstream csv(words[2]);
  std::vector<std::string> names;
  std::vector<pliant::NamedPoint> points;
  std::string line;
  std::getline(csv, line);  // landmark,x,y
  for (std::string x, y; std::getline(csv, line, ',') && std::getline(csv, x, ',') && std::getline(csv, y);) {
    names.push_back(line);
    points.push_back({nullptr, {std::stof(x), std::stof(y)}});
  }
  for (std::size_t k = 0; k < points.size(); ++k) points[k].name = names[k].c_str();

  std::ifstream film(words[3], std::ios::binary);
  std::vector<std::uint8_t> pixels(std::size_t{limits.width} * limits.height);
  std::getline(film, line);  // the header of the film; FRAME is the header of each frame
  for (std::uint32_t k = 0; std::getline(film, line) && film.read(reinterpret_cast<char*>(pixels.data()), static_cast<std::streamsize>(pixels.size())); ++k) {
    const pliant::FrameView frame{pixels.data(), limits.width, limits.height, limits.width, 1, (k * 1000000000ll + 15) / 30, k};
    pliant::FrameResult result;
    const pliant::Status status = k == 0 ? tracker.start_from_landmarks(frame, {points.data(), points.size()}) : tracker.update(frame, &result);
    if (status != pliant::Status::ok) return 1;
    const pliant::Pose& pose = tracker.result().pose;
    for (const float x : {pose.q.w, pose.q.x, pose.q.y, pose.q.z, pose.t.x, pose.t.y, pose.t.z}) std::printf("%.9g,", double(x + 0.0f));
    for (const float x : tracker.estimator().parameters()) std::printf("%.9g,", double(x + 0.0f));
    for (std::size_t i = 0; i < model.landmarks().count; ++i) {
      pliant::Vec2 x;
      if (tracker.landmark(i, &x) != pliant::Status::ok) return 1;
      std::printf("%.4f,%.4f%s", double(x.x), double(x.y), i + 1 < model.landmarks().count ? "," : "\n");
    }
  }
}
