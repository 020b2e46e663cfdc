#pragma once
// Finds a surface in a frame by its print (docs/algorithms.md, section 7.17): matches, views that they agree
// on, the model fitted to them, and verification.
#include <cstddef>
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/fit.hpp"
#include "pliant/lens.hpp"
#include "pliant/model.hpp"
#include "print/match_consensus.hpp"
#include "print/print_check.hpp"
#include "print/print_matcher.hpp"

namespace pliant {

/// Where a surface was found.
struct FoundPrint {
  View view;
  PrintAgreement agreement;
  bool is_clear = false;  ///< no other pose explains the frame as well
  /// How many places of the first round come to sight in a track that is right, unless something is in front of them or they are
  /// outside the frame.
  int expected = 0;
};

/// The search, frame by frame. Lives in the memory of the tracking, while there is no track.
class PrintFinder {
 public:
  /// \param width, height  of the frames, px.
  void lay_out(Arena& arena, const Model& model, int width, int height);
  /// What PrintTable::open says.
  Status status() const { return status_; }

  /// Searches as far as `work` allows (cells, TrackerLimits::search_work), and goes on in the next call:
  /// corners of one frame are matched until they are done. What is found there is carried to the present frame, and verified.
  /// \param q  out: all parameters, if the surface is found.
  /// \return not_found: nothing yet.
  Status search(const FrameView& frame, std::uint32_t work, const Camera& camera, float* q,
                FoundPrint* found);

 private:
  /// A frame and its camera.
  struct Picture {
    const FrameView& frame;
    const Camera& camera;
  };
  /// A fit and its verification.
  struct Candidate {
    View view;
    std::size_t seed = 0;   // the match that suggested it
    float residual_px = 0;  // rms, the larger the more the shape is bent
    PrintAgreement agreement;
    bool is_accepted = false;
  };
  /// The best two of all views.
  struct Solutions {
    Candidate best, other;
  };

  CornerChoice choice() const;
  void gather();
  bool fit_views(Span<const ViewVotes> views, const Picture& in, FoundPrint* found);
  PixelBox box_of_matches(const View& view);
  bool carry(const Picture& now, FoundPrint* found);
  void settle(const Picture& in, View* best, PrintAgreement* best_agreement);
  bool waits(const FoundPrint& found, bool is_quick);
  void fit_solutions(const View& start, const Picture& in, Solutions* solutions);
  View tilted_back(const View& view, bool bends);
  static bool is_better(const Candidate& a, const Candidate& b);
  static bool keep(const Candidate& candidate, Solutions* solutions);
  static bool is_clear(const Solutions& solutions);
  Candidate fit_candidate(const View& start, const Picture& in);
  bool fit(const Picture& in, bool bends, float tolerance, View* view, FitReport* report);
  bool fit_to_blocks(const Picture& in, float spacing, bool bends, View* view, FitReport* report);
  bool fit_to(Span<const Correspondence> points, const Picture& in, bool bends, View* view,
              FitReport* report);
  Span<const Correspondence> points_near(const View& view, float tolerance);
  PrintAgreement verify(const View& view, const FrameView& frame);
  float bent_of(Span<const float> q) const;
  int expected_places(const Pose& pose);
  float extent_px(const View& view) const { return view.s * matcher_.table().extent_mm(); }

  Model model_;
  Status status_ = Status::not_found;
  Lens lens_;  // of this frame's camera
  PrintMatcher matcher_;
  Fitter fitter_;
  Span<SurfaceMatch> matches_;
  std::size_t match_count_ = 0;
  std::size_t seed_ = 0;     // the match whose view is fitted
  int doubtful_frames_ = 0;  // in succession, the better ones twice
  int failed_searches_ = 0;  // modulo the interval of spread corners
  Span<Correspondence> points_;
  Span<float> rest_, q_, found_q_;  // parameters: zeros, of the present fit, and of the best one
  Span<std::uint8_t> is_frozen_;    // zeros: no parameter is free
};

/// Whether blocks enough agree for a start, and for one without further frames.
bool is_accepted(const PrintAgreement& agreement);
bool is_sure(const PrintAgreement& agreement);
/// Whether blocks enough agree that the view is worth a fit tilted to the other side. Where a fit failed, none do.
bool is_promising(const PrintAgreement& agreement);
/// Spacing of a block's samples for a surface of this extent in the frame, px.
float print_block_px(float extent_px);

}  // namespace pliant
