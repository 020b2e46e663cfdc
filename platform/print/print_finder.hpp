#pragma once
// Finds a surface in a frame by its print (docs/algorithms.md, section 7.17): matches, views that they agree
// on, the model fitted to them, and verification. A search is divided into parts, of which each frame does some.
#include <cstddef>
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/model.hpp"
#include "print/match_consensus.hpp"
#include "print/print_fit.hpp"
#include "print/print_matcher.hpp"
#include "print/print_tuning.hpp"

namespace pliant {

/// Where a surface was found.
struct FoundPrint {
  View view;
  PrintAgreement agreement;
  bool is_clear = false;  ///< no other pose explains the frame as well
  /// How many places of the first round come to sight in a track that is right, unless something is in front of them or they are
  /// outside the frame.
  int expected = 0;
  /// Whether it is rigid and flat, so that a wrong pose hides no part of it.
  bool shows_all = false;
};

/// The search, frame by frame. Lives in the memory of the tracking, while there is no track.
class PrintFinder {
 public:
  /// \param width, height  of the frames, px.
  void lay_out(Arena& arena, const Model& model, int width, int height);
  /// What PrintTable::open says.
  Status status() const { return status_; }
  /// Whether the next call begins a search.
  bool is_idle() const { return stage_ == Stage::none; }

  /// Does parts of the search until `work` is done (cells, TrackerLimits::search_work), but at least one, and goes on in the next
  /// call. What a search of several calls has found in its first frame is carried to the present one in a call of its own.
  /// \param q  out: all parameters, if the surface is found.
  /// \return not_found: nothing yet.
  Status search(const FrameView& frame, std::uint32_t work, const Camera& camera, float* q,
                FoundPrint* found);

 private:
  enum class Stage : std::uint8_t { none, matching, gathering, voting, fitting, settling, carrying };
  /// A solution of a view, and its verification.
  struct Candidate {
    View view;
    std::size_t seed = 0;   // the match that suggested it
    float residual_px = 0;  // PrintFit::residual_px
    PrintAgreement agreement;
    bool is_accepted = false;
  };
  /// How far the fits are.
  struct Progress {
    std::size_t view = 0, solution = 0;
    int settling = 0;  // fits of it
    View rigid;        // the view, with the surface at rest
    Candidate present, best, other;
  };

  CornerChoice choice() const;
  std::uint32_t step(const PrintPicture& in);
  void gather(const PrintMatch& match);
  std::uint32_t vote(const Camera& camera);
  int fit_next(const PrintPicture& in);
  int fit_solution(const PrintPicture& in);
  int fit_to_blocks(const PrintPicture& in, View* view);
  bool begin_view(const PrintPicture& in);
  void end_solution();
  void end_view();
  void settle(const PrintPicture& in);
  bool conclude(const PrintPicture& now, bool is_quick, FoundPrint* found);
  bool carry(const PrintPicture& now);
  bool waits(const FoundPrint& found, bool is_quick);
  bool is_clear() const;
  SeededMatches matches_of(std::size_t seed) const { return {{matches_.data, match_count_}, seed}; }
  ScaledMatches scaled_matches() const {
    return {{matches_.data, match_count_}, {order_.data, match_count_}};
  }
  static bool is_better(const Candidate& a, const Candidate& b);
  bool keep(const Candidate& candidate);

  Status status_ = Status::not_found;
  PrintMatcher matcher_;
  SceneMotion motion_;  // since the frame that is searched
  PrintFit* fit_ = nullptr;
  Stage stage_ = Stage::none;
  std::uint32_t fit_cells_ = 0;  // what a fit costs
  Span<SurfaceMatch> matches_;
  Span<std::uint16_t> order_;                // of the matches, by scale
  std::size_t match_count_ = 0, voted_ = 0;  // matches that are gathered, and that have voted
  Span<ViewVotes> views_;
  std::size_t view_count_ = 0;
  Progress* now_ = nullptr;
  Span<float> best_q_;       // parameters of the best solution
  int doubtful_frames_ = 0;  // in succession, the better ones twice
  int failed_searches_ = 0;  // modulo the interval of spread corners
};

/// Whether blocks enough agree for a start, and for one without further frames.
bool is_accepted(const PrintAgreement& agreement);
bool is_sure(const PrintAgreement& agreement);
/// Whether blocks enough agree that the view is worth a fit tilted to the other side. Where a fit failed, none do.
bool is_promising(const PrintAgreement& agreement);

}  // namespace pliant
