#pragma once
/// \file frame_work.hpp
/// The work of a frame, counted in loops.
#include <cstdint>

namespace pliant {

/// How often those loops of a tracked frame ran whose length depends on what the frame shows. Equal on every machine. `pliant plan`
/// prints the bounds, and what else a frame does.
struct FrameWork {
  std::uint32_t searches = 0;        ///< of templates: by their own picture, or that of the frame before
  std::uint32_t search_steps = 0;    ///< of all these
  std::uint32_t captures = 0;        ///< places where a template was to be captured for a key frame
  std::uint32_t rows = 0;            ///< observations in linearisations
  std::uint32_t measured_rows = 0;   ///< observations of which only the residual was taken, for a trial step
  std::uint32_t factorisations = 0;  ///< of the normal equations
};

/// Instructions of x86-64 that one turn of each loop takes, counted by callgrind on the recorded face (docs/evaluation.md, Work of a
/// frame). They weigh the loops against each other on other processors as well.
struct WorkCosts {
  float search_step = 0;    ///< as in FrameWork, and so are the others
  float row = 0;            ///< one observation
  float measured_row = 0;   ///< one observation
  float factorisation = 0;  ///< one

  /// \param window    side of a template, px. \param unknowns  of the solve. \param samples  of one surface point.
  static constexpr WorkCosts of(float window, float unknowns, float samples) {
    return {18 * window * window, 0.45f * unknowns * unknowns + 37 * samples + 500, 18 * samples + 90,
            0.65f * unknowns * unknowns * unknowns};
  }
  /// Of the solves alone.
  constexpr float of_solves(const FrameWork& w) const {
    return row * static_cast<float>(w.rows) + measured_row * static_cast<float>(w.measured_rows) +
           factorisation * static_cast<float>(w.factorisations);
  }
};

}  // namespace pliant
