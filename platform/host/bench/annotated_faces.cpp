#include "host/bench/annotated_faces.hpp"

#include <cmath>
#include <limits>

#include "host/io/csv.hpp"
#include "host/io/files.hpp"
#include "host/io/ibug_names.hpp"
#include "host/learn/photographs.hpp"

namespace pliant::host {

std::vector<AnnotatedFace> read_held_out_faces(const std::string& folder) {
  std::vector<AnnotatedFace> faces;
  for (learn::AnnotatedPicture& read : learn::read_annotated(folder, learn::Portion::held_out)) {
    faces.push_back({std::move(read.name), std::move(read.picture), {}});
    for (const learn::AnnotatedLandmark& l : read.landmarks) faces.back().landmarks[l.name] = l.x;
  }
  return faces;
}

std::vector<NamedLandmarks> read_annotated_frames(const std::string& path) {
  const CsvTable table(path, read_file(path));
  const std::size_t frame = table.column("frame"), landmark = table.column("landmark"), x = table.column("x"),
                    y = table.column("y");
  std::vector<NamedLandmarks> frames;
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    const std::size_t k = table.whole_number(row, frame);
    if (frames.size() <= k) frames.resize(k + 1);
    frames[k][table.cell(row, landmark)] = {table.number(row, x), table.number(row, y)};
  }
  return frames;
}

float eye_distance(const NamedLandmarks& truth) {
  const auto right = truth.find("ibug36"), left = truth.find("ibug45");
  return right == truth.end() || left == truth.end() ? 0 : length(right->second - left->second);
}

double landmark_error(const NamedLandmarks& found, const NamedLandmarks& truth) {
  double sum = 0;
  int count = 0;
  for (const auto& [name, x] : truth) {
    const auto at = found.find(name);
    if (ibug_number(name) < 17 || at == found.end()) continue;
    sum += static_cast<double>(length(at->second - x));
    ++count;
  }
  const auto eyes = static_cast<double>(eye_distance(truth));
  return count > 0 && eyes > 0 ? sum / count / eyes : std::numeric_limits<double>::quiet_NaN();
}

NamedLandmarks turned(const NamedLandmarks& landmarks, float radians, Vec2 about) {
  const float cosine = std::cos(radians), sine = std::sin(radians);
  NamedLandmarks out;
  for (const auto& [name, x] : landmarks) {
    const Vec2 d = x - about;
    out[name] = about + Vec2{cosine * d.x - sine * d.y, sine * d.x + cosine * d.y};
  }
  return out;
}

NamedLandmarks moved(const NamedLandmarks& landmarks, float scale, Vec2 shift) {
  NamedLandmarks out;
  for (const auto& [name, x] : landmarks) out[name] = scale * x + shift;
  return out;
}

}  // namespace pliant::host
