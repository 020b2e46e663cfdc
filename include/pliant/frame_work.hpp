#pragma once
/// \file frame_work.hpp
/// The work of a frame, counted in loops.
#include <cstdint>

namespace pliant {

/// Counts of the loops of a tracked frame whose number of turns depends on what the frame shows. They are equal on every machine.
/// `pliant plan` prints their bounds, and the other work of a frame.
struct FrameWork {
  std::uint32_t searches = 0;        ///< of templates, and of patches of the previous frame
  std::uint32_t search_steps = 0;    ///< of all these searches, and for each as many as its preparation takes
  std::uint32_t captures = 0;        ///< places where a template was to be captured for a key frame
  std::uint32_t rows = 0;            ///< observations in linearisations; a spring counts as two
  std::uint32_t measured_rows = 0;   ///< observations of which only the residual was taken, for a trial step
  std::uint32_t factorisations = 0;  ///< of the normal equations
  std::uint32_t forces = 0;          ///< observations whose image forces were compared, for rejection
  std::uint32_t coarse_pixels = 0;   ///< of thumbnails, compared for the coarse translation
  /// A key frame, an estimate of the person, a check of the track, a step of a second look; instructions, as WorkCosts.
  float rare = 0;
};

/// Tuning of WorkCosts, instructions of x86-64: those of a function, over the turns of its loop, counted by callgrind on the
/// recorded face with profiles S, M and L, which differ in window, unknowns and samples (docs/evaluation.md, Work of a frame).
struct WorkCostTuning {
  float search_step_pixel = 18;      ///< of a step of a search: each pixel of the template
  float row_unknowns = 0.45f;        ///< of an observation: each pair of unknowns
  float row_sample = 37, row = 950;  ///< of an observation: each sample of its surface point, and the rest
  float measured_sample = 15;        ///< the same of an observation that is measured only
  float measured = 90;               ///< the rest of that
  float factorisation_unknowns = 0.52f;  ///< of a factorisation: each triple of unknowns
  float force = 9500;                    ///< of an observation in the rejection of image forces
  float coarse_pixel = 4.2f;             ///< of a pixel of the coarse translation
  float captured_sample = 550;  ///< of a place where a template is captured: each sample of its point
};
inline constexpr WorkCostTuning kWorkCostTuning{};  ///< the values in use

/// Instructions that one turn of each loop takes on x86-64. Elsewhere they serve to weigh the loops against each other.
struct WorkCosts {
  float search_step = 0;    ///< a step of a template search
  float row = 0;            ///< an observation in a linearisation
  float measured_row = 0;   ///< an observation of which only the residual is taken
  float factorisation = 0;  ///< a factorisation of the normal equations
  float force = 0;          ///< an observation in the rejection of image forces
  float coarse_pixel = 0;   ///< a pixel of thumbnails compared
  float capture = 0;        ///< a place where a template is captured; a part of FrameWork::rare

  /// \param window    side of a template, px. \param unknowns  of the solve. \param samples  of one surface point.
  static constexpr WorkCosts of(float window, float unknowns, float samples) {
    const WorkCostTuning& t = kWorkCostTuning;
    return {t.search_step_pixel * window * window,
            t.row_unknowns * unknowns * unknowns + t.row_sample * samples + t.row,
            t.measured_sample * samples + t.measured,
            t.factorisation_unknowns * unknowns * unknowns * unknowns,
            t.force,
            t.coarse_pixel,
            t.captured_sample * samples};
  }
  /// Instructions of a frame's solves.
  constexpr float of_solves(const FrameWork& w) const {
    return row * static_cast<float>(w.rows) + measured_row * static_cast<float>(w.measured_rows) +
           factorisation * static_cast<float>(w.factorisations) + force * static_cast<float>(w.forces);
  }
  /// Of all that a frame's budget bounds.
  constexpr float of(const FrameWork& w) const {
    return search_step * static_cast<float>(w.search_steps) + of_solves(w) +
           coarse_pixel * static_cast<float>(w.coarse_pixels) + w.rare;
  }
};

}  // namespace pliant
