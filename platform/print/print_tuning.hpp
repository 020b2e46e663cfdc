#pragma once
// Tuning of the search for a print. Chosen on the poster of `fixtures/sheet` with `pliant bench print`, and
// judged on other prints (docs/evaluation.md, Start by print). What other values give was not recorded,
// except where it is told.
#include <cstddef>
#include <cstdint>

#include "pliant/corners.hpp"

namespace pliant {

/// Tuning of the search for a print. Each constant: unit, reason, experiment.
struct PrintTuning {
  /// Corners, in the print as in the frame: side of a cell and least distance, px, least measure (grey/px)^2,
  /// and least ratio of the eigenvalues. Round values.
  int corner_cell_px = 8;
  float corner_distance_px = 5, least_corner = 6, least_corner_ratio = 0.05f;
  /// Levels of the frame that are searched, and corners of the first, count; each further one has half as many. Time and memory
  /// of a search grow with them. Round values.
  int levels = 3;
  std::size_t corners = 320;
  /// One failed search in so many takes corners from all tiles of the frame, so many a side, out of so many times as many
  /// candidates. A ball with the craters of the moon, before a lawn and a bush, has 0 to 5 right matches with the strongest corners
  /// and is not found in 40 frames; with these it is in their first frame. With an interval of 2 small, bent or tilted prints get
  /// fewer searches with the strongest corners in five frames.
  int spread_interval = 3;
  std::size_t corner_tiles = 8, corner_candidates = 8;
  /// Bits that may differ in a match. Wrong matches cost time only: views are voted for and verified. 70, with one match a corner,
  /// leaves too few on a small print (another print, 66 px high: found in 3 of 8 instead of all); with two 74 finds as much as 80.
  int most_distance = 80;
  /// Places of the surface that a corner is matched with, the nearest ones. Of frames of four surfaces in hard films
  /// (docs/experiments.md, Start by print) 147 were found with one, if it was a tenth nearer than any other, 166 with the nearest
  /// one, 182 with two, 173 with three; with three a search takes 1.4 times as long.
  std::size_t matches_per_corner = 2;
  /// Distance in (u,v) from which on two keypoints are of different places. Round value, not tuned.
  float same_place = 0.04f;
  /// What the parts of a search cost, in the cells that bound it (TrackerLimits::search_work; some 5,000 instructions each): pixels
  /// whose corners are found for one cell, cells of a descriptor, keypoints that a corner is compared with, and matches that a
  /// match is compared with, for one cell. Round values, not tuned.
  std::uint32_t pixels_per_cell = 50, cells_per_descriptor = 4, keypoints_per_cell = 100,
                pairs_per_cell = 100;
  /// The same of a fit, cells, besides those for each record of the cascade: 9.8 million instructions with 10 records, 25.7 million
  /// with 39.
  std::uint32_t fit_cells = 900, fit_cells_per_record = 110;
  /// Views that are fitted at most, those with most votes first, and solutions of each. Of the same frames 170 were found with 3
  /// views, 179 with 5, 182 with 8.
  std::size_t most_views = 5, solutions = 3;
  /// Matches and blocks that are fitted at most, count: time and memory of the fit. Fits to blocks, after those to corners, count:
  /// each finds blocks from a better view than the one before. Round values.
  std::size_t fitted_points = 96;
  int block_passes = 4;
  /// Further ones of the best solution, count, at most (docs/algorithms.md, section 7.17). A can with a word, small text and spots
  /// began up to 10 px off, of 330, after four, and stayed so. Round value.
  int settling_passes = 12;
  /// Blocks that a check compares, count, at most, a round value; and times as many places that are tried until so many face the
  /// camera. With one time 8 to 12 blocks of a ball can be compared, and most of its right views have too few.
  std::size_t blocks = 48, block_rounds = 4;
  /// Frames from one check of a running track to the next: halves its cost. Round value, not tuned.
  int check_interval_frames = 2;

  /// What a fit costs, cells. \param records  of the model's cascade.
  constexpr std::uint32_t cells_of_fit(std::size_t records) const {
    return fit_cells + fit_cells_per_record * static_cast<std::uint32_t>(records);
  }
  /// Fits of a solution, at most: of its pose to the matches of the view, of all to matches twice, and to blocks.
  constexpr std::size_t fits_of_solution() const { return 3 + static_cast<std::size_t>(block_passes); }
};
inline constexpr PrintTuning kPrintTuning{};

/// The choice of corners, for prints and frames alike.
inline CornerOptions print_corner_options() {
  CornerOptions o;
  o.cell_px = kPrintTuning.corner_cell_px;
  o.min_score = kPrintTuning.least_corner;
  o.quality = 0;
  o.min_ratio = kPrintTuning.least_corner_ratio;
  o.min_distance_px = kPrintTuning.corner_distance_px;
  return o;
}

}  // namespace pliant
