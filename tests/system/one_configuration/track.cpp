// track_cpp face.plm points.csv frames.y4m: tracks a grey film of 320 x 240 with the defaults of the library. Prints pose,
// parameters and landmarks of every frame, as `pliant track --landmarks` writes them.
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "pliant/pliant.hpp"

using pliant::Status;

alignas(pliant::Arena::kAlignment) static unsigned char memory[4 << 20];
static pliant::Tracker tracker;

int main(int count, char** words) {
  if (count != 4) return 2;
  std::ifstream file(words[1], std::ios::binary);
  std::vector<char> table((std::istreambuf_iterator<char>(file)), {});
  pliant::Model model;
  if (pliant::Model::open(table.data(), table.size(), &model) != Status::ok) return 1;
  const pliant::TrackerLimits limits;
  pliant::Arena arena(memory, sizeof memory);
  if (pliant::create_in(arena, tracker, model, limits) != Status::ok) return 1;

  std::ifstream csv(words[2]);
  std::vector<std::string> names;
  std::vector<pliant::NamedPoint> points;
  std::string name, x, y;
  std::getline(csv, name);  // the header
  while (std::getline(csv, name, ',') && std::getline(csv, x, ',') && std::getline(csv, y)) {
    names.push_back(name);
    points.push_back({nullptr, {std::stof(x), std::stof(y)}});
  }
  for (std::size_t k = 0; k < points.size(); ++k) points[k].name = names[k].c_str();

  std::ifstream film(words[3], std::ios::binary);
  std::vector<char> pixels(320 * 240);
  pliant::FrameView frame{reinterpret_cast<std::uint8_t*>(pixels.data()), 320, 240, 320};
  std::getline(film, name);  // the film has a line before it, and every frame has one
  for (; std::getline(film, name) && film.read(pixels.data(), 320 * 240); ++frame.sequence) {
    frame.time_ns = (frame.sequence * 1000000000ll + 15) / 30;
    pliant::FrameResult result;
    const Status status = frame.sequence == 0
                              ? tracker.start_from_landmarks(frame, {points.data(), points.size()})
                              : tracker.update(frame, &result);
    if (status != Status::ok) return 1;
    const pliant::Pose& p = tracker.result().pose;
    for (const float value : {p.q.w, p.q.x, p.q.y, p.q.z, p.t.x, p.t.y, p.t.z})
      std::printf(",%.9g", value + 0.0);
    for (const float value : tracker.parameters()) std::printf(",%.9g", value + 0.0);
    for (std::size_t k = 0; k < model.landmarks().count; ++k) {
      pliant::Vec2 at;
      if (tracker.landmark(k, &at) != Status::ok) return 1;
      std::printf(",%.4f,%.4f", double{at.x}, double{at.y});
    }
    std::puts("");
  }
}
