#pragma once
// The model fitted to matches and to blocks of a frame, and verified there (docs/algorithms.md, section 7.17).
#include <cstddef>
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/fit.hpp"
#include "pliant/frame.hpp"
#include "pliant/lens.hpp"
#include "pliant/model.hpp"
#include "print/match_consensus.hpp"
#include "print/print_check.hpp"
#include "print/print_motion.hpp"
#include "print/print_table.hpp"

namespace pliant {

/// A frame and its camera.
struct PrintPicture {
  const FrameView& frame;
  const Camera& camera;
};

/// Matches, and the one whose view is fitted: only those that suggest a similar view are.
struct SeededMatches {
  Span<const SurfaceMatch> all;
  std::size_t seed = 0;
};

/// How near its place a match must lie, as a fraction of the surface's extent.
enum class MatchTolerance : std::uint8_t { vote, rigid, bent };

/// Fits of one model. Pose and parameters are kept from one to the next.
class PrintFit {
 public:
  /// Pose and parameters.
  struct Shape {
    View view;
    Span<float> q;
  };

  void lay_out(Arena& arena, const Model& model, const PrintTable& table);
  /// Of the frames to come.
  Status set_camera(const Camera& camera, int width, int height) {
    return Lens::make(camera, width, height, &lens_);
  }

  /// Present parameters, all of the model's.
  Span<float> q() { return q_; }
  void rest();
  const Lens& lens() const { return lens_; }
  Vec3 point_at_rest(Vec2 uv) { return fitter_.cascade().surface_point(uv, rest_.data); }
  /// The surface's extent, px.
  float extent_px(const View& view) const { return view.s * table_.extent_mm(); }
  float tolerance_mm(MatchTolerance tolerance) const;

  /// Fits pose, and with `bends` parameters, to the matches near their places. \return false where they do not determine it.
  bool to_matches(const SeededMatches& matches, const PrintPicture& in, MatchTolerance tolerance, bool bends,
                  View* view);
  /// Fits pose and parameters to where blocks of the albedo are found.
  bool to_blocks(const PrintPicture& in, View* view);
  /// Fits the pose to how the surface has moved since the view was found: with the scene, then as the pictures show. Where one of
  /// them does not determine it, it stays.
  void to_motion(const SceneMotion& scene, const SmallPictures& pictures, const PrintPicture& now,
                 View* view);
  /// Of the last fit: root mean square residual, px, the larger the more the shape is bent; and points with weight, count.
  float residual_px() const;
  std::size_t used() const { return report_.used; }

  PrintAgreement verify(const View& view, const FrameView& frame);
  /// Tilts the view to the other side (mirrored_tilt), where what bent towards the camera bends away: turns the sign of the
  /// parameters, too. The matches that agree with the view stay where they are seen: what they show may be far from the model's
  /// origin, as the front of a box is.
  View tilted_back(const SeededMatches& matches, const View& view);
  /// Image positions of the matches that agree with the view, px, at most `fitted_points`.
  Span<const Correspondence> agreeing(const SeededMatches& matches, const View& view,
                                      MatchTolerance tolerance);
  /// Places of the first round that the camera sees where the shape is that at rest. Where the present one, which may fold a part
  /// away, is another, its pose may be wrong as well: then those that can face one camera.
  int expected_places(const Pose& pose);
  /// Whether the surface is rigid, and nearly all of it can face one camera.
  bool shows_all();

 private:
  bool fit_to(Span<const Correspondence> points, const PrintPicture& in, bool bends, View* view);
  float bent() const;

  Model model_;
  PrintTable table_;
  Lens lens_;
  Fitter fitter_;
  FitReport report_;
  Span<Correspondence> points_;
  Span<float> rest_, q_;          // parameters: zeros, and the present ones
  Span<std::uint8_t> is_frozen_;  // zeros: no parameter is free
};

/// Spacing of a block's samples for a surface of this extent in the frame, px.
float print_block_px(float extent_px);

}  // namespace pliant
