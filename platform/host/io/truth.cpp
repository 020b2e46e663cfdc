#include "host/io/truth.hpp"

#include <algorithm>

#include "host/io/csv.hpp"
#include "host/io/failure.hpp"
#include "host/io/files.hpp"
#include "host/io/fit_file.hpp"
#include "host/io/statistics.hpp"

namespace pliant::host {

TruthComparison::TruthComparison(const std::string& path, const Model& model) {
  const CsvTable table(path, read_file(path));
  const std::size_t frame = table.column("frame");
  const std::size_t q[4] = {table.column("qw"), table.column("qx"), table.column("qy"), table.column("qz")};
  struct Columns {
    std::optional<std::size_t> x, y;
  };
  std::vector<Columns> landmarks;
  bool has_landmarks = false;
  for (const Landmark& l : model.landmarks()) {
    landmarks.push_back(
        {table.find_column(std::string("x_") + l.name), table.find_column(std::string("y_") + l.name)});
    has_landmarks = has_landmarks || (landmarks.back().x && landmarks.back().y);
  }
  if (!has_landmarks && !model.landmarks().empty())
    fail_input(path, "has no columns x_NAME,y_NAME of the model's landmarks");
  for (std::size_t r = 0; r < table.row_count(); ++r) {
    Row row;
    if (table.cell(r, q[0]).empty()) continue;
    row.q = {table.number(r, q[0]), table.number(r, q[1]), table.number(r, q[2]), table.number(r, q[3])};
    if (!is_nearly_unit(row.q)) fail_input(table.where(r), "the quaternion is not of unit length");
    row.q = normalised(row.q);
    for (const Columns& c : landmarks) {
      const bool is_there = c.x && c.y && !table.cell(r, *c.x).empty() && !table.cell(r, *c.y).empty();
      row.landmarks.push_back(is_there ? std::optional<Vec2>({table.number(r, *c.x), table.number(r, *c.y)})
                                       : std::nullopt);
    }
    rows_[table.whole_number(r, frame)] = std::move(row);
  }
}

void TruthComparison::add(std::size_t frame, const Pose& pose,
                          const std::vector<std::optional<Vec2>>& landmarks, ImageSize size) {
  const auto found = rows_.find(frame);
  if (found == rows_.end()) return;
  const Row& truth = found->second;
  const Vec3 turn = log_rotation(normalised(pose.q * conjugate(truth.q)));
  rotation_deg_.push_back(static_cast<double>(length(turn)) * 57.29577951308232);
  for (std::size_t k = 0; k < truth.landmarks.size() && k < landmarks.size(); ++k) {
    if (!truth.landmarks[k] || !landmarks[k]) continue;
    distance_sum_ += static_cast<double>(length(*landmarks[k] - *truth.landmarks[k]));
    ++distance_count_;
    const Vec2 last = {static_cast<float>(size.width - 1), static_cast<float>(size.height - 1)},
               x = *truth.landmarks[k];
    if (x.x < 0 || x.y < 0 || x.x > last.x || x.y > last.y) ++outside_count_;
  }
}

double TruthComparison::mean_landmark_px() const {
  return distance_count_ == 0 ? 0 : distance_sum_ / static_cast<double>(distance_count_);
}

double TruthComparison::median_rotation_deg() const {
  return median(rotation_deg_);
}

}  // namespace pliant::host
