// A grid of cells that are large against the tolerance, so that a vertex seldom has to be compared with those of a second cell.
#include "host/bake/places.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "host/bake/at.hpp"
#include "host/io/bounding_box.hpp"

namespace pliant::host::bake {

namespace {

/// Tuning of the places. Each constant: unit, reason, experiment.
struct PlaceTuning {
  /// Distance of two vertices at one place, fraction of the diagonal. A file with six digits rounds coordinates as large as the
  /// diagonal by up to 0.5e-5 of it. On a sheet of paper it is 4 micrometres. Not tuned.
  double same_place = 1e-5;
  /// Side of a cell over that distance. The places of a cell are that distance apart, so that this bounds their number. Round
  /// value, not tuned.
  double cell = 16;
};
constexpr PlaceTuning kTuning;

using Coordinates = std::array<double, 3>;

class PlaceGrid {
 public:
  explicit PlaceGrid(double tolerance) : tolerance_(tolerance), cell_(kTuning.cell * tolerance) {}

  /// The number of the place of p, which may be a new one.
  int place_of(const Coordinates& p) {
    int found = static_cast<int>(places_.size());
    // The cells within the tolerance: one or two along each axis.
    const Coordinates low = cell_of(p, -tolerance_), high = cell_of(p, tolerance_);
    for (unsigned corner = 0; corner < 8; ++corner) {
      Coordinates cell = low;
      bool is_new = true;
      for (std::size_t k = 0; k < 3; ++k) {
        if ((corner >> k & 1) == 0) continue;
        is_new &= high[k] != low[k];
        cell[k] = high[k];
      }
      if (is_new) found = std::min(found, first_near(p, cell));
    }
    if (found < static_cast<int>(places_.size())) return found;
    cells_[cell_of(p, 0)].push_back(found);
    places_.push_back(p);
    return found;
  }

 private:
  /// Numbers of the cell at p, displaced along each axis.
  Coordinates cell_of(const Coordinates& p, double by) const {
    Coordinates cell;
    for (std::size_t k = 0; k < 3; ++k) cell[k] = std::floor((p[k] + by) / cell_);
    return cell;
  }

  /// The first place of a cell that is near p; their number if there is none.
  int first_near(const Coordinates& p, const Coordinates& cell) const {
    const auto entry = cells_.find(cell);
    if (entry != cells_.end())
      for (const int place : entry->second) {
        const Coordinates& q = places_[at(place)];
        const double x = p[0] - q[0], y = p[1] - q[1], z = p[2] - q[2];
        if (x * x + y * y + z * z <= tolerance_ * tolerance_) return place;
      }
    return static_cast<int>(places_.size());
  }

  const double tolerance_, cell_;
  std::vector<Coordinates> places_;
  std::map<Coordinates, std::vector<int>> cells_;  // places by the cell that they are in
};

}  // namespace

std::vector<int> places_of(const std::vector<Vec3>& position) {
  const BoundingBox<Vec3> box(position);
  constexpr double kLeast = 1e-30;  // mm, where all vertices are at one place
  PlaceGrid grid(std::max(kLeast, kTuning.same_place * static_cast<double>(length(box.size()))));
  std::vector<int> place_of;
  for (const Vec3 p : position)
    place_of.push_back(
        grid.place_of({static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)}));
  return place_of;
}

}  // namespace pliant::host::bake
