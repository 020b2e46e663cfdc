#pragma once
/// \file person_rows.hpp
/// The observations of a frame as equations of the frame's pose and expression, of the start's error of
/// rotation, and of the identity (docs/algorithms.md, section 7.20).
#include "pliant/cascade.hpp"
#include "pliant/estimator.hpp"
#include "track/person_equations.hpp"

namespace pliant {

/// Tuning of the rows. Each constant: unit, reason, experiment.
struct PersonRowsTuning {
  /// mm. Error of the model, added to the noise of templates and of edges: that of the frame's own solve.
  float patch_error_mm = 1, edge_error_mm = 1.7f;
  /// Square of a residual, in squared deviations, at which a row has half its weight. Round value, not tuned.
  float half_weight_square = 4;
  /// Area of the surface's image in its key frame over that of one that faces the camera, below which a
  /// template says nothing of depth. Round value, not tuned.
  float least_area = 0.05f;
  /// Cosine between surface normal and the direction to the camera, at least, of a template's place in the frame. Nearer to
  /// the silhouette a window shows what is behind it, too, and its place tells of a flatter face. On rendered heads
  /// that turn the errors at 95 % without it, with 0.45, 0.5 and 0.6 were 3.67, 3.63, 3.74 and 3.74 degrees from detection,
  /// 3.02, 2.72, 2.74 and 2.95 from landmarks.
  float least_facing = 0.45f;
  /// rad. Standard deviation of a frame's own rotation: free, since a flatter head would have turned farther.
  float turn_sd = 0.17f;
};
inline constexpr PersonRowsTuning kPersonRowsTuning{};

/// Unknowns in this order: rotation, log scale and translation of the frame (kPoseUnknowns); its free
/// expressions; rotation of the model against its start (3, in the axes of Pose::q); identity parameters.
class PersonRows {
 public:
  void lay_out(Arena& arena, const Model& model);

  /// Chooses the unknowns. \param is_free  of each parameter; expressions that are not free have no unknown.
  void start(const Model& model, const std::uint8_t* is_free);
  std::size_t count() const { return kPoseUnknowns + expressions_ + kept(); }
  /// Unknowns that last: the rotation, and the identity.
  std::size_t kept() const { return 3 + identities_; }
  std::uint16_t identity(std::size_t k) const { return parameters_[expressions_ + k]; }

  /// Bytes of `begin`.
  static std::size_t scratch_bytes(const Model& model);
  /// Starts a frame. The memory lasts until its last row. \param q  all parameters; must stay.
  void begin(Arena& scratch, const Model& model, const View& view, const float* q);
  /// Adds an observation of the surface at (u,v). \param surface  there, at begin's q.
  /// \param key  the view in which the point's template was captured: there it stays where it was seen,
  ///        whatever the identity; null: the point is a place of the face, as that of an edge is.
  void add(const Observation& o, Vec2 uv, const SurfaceFrame& surface, const View* key,
           PersonEquations& equations);
  /// Adds what is known of the frame's own unknowns.
  void add_priors(PersonEquations& equations) const;

 private:
  bool faces_camera(const Projector& projector) const;
  void set_columns(Vec2 uv, const View* key, const Projector::Derivatives& d);
  Vec2 slid(const Projector::Derivatives& d, Vec2 in_key) const;
  void add_along(Vec2 direction, Vec2 residual, float variance, PersonEquations& equations);

  // Until the next start.
  std::uint16_t* parameters_ = nullptr;  // of the unknowns: expressions, then identity
  std::uint16_t* unknown_of_ = nullptr;  // of each parameter; kNone: it has none
  std::size_t expressions_ = 0, identities_ = 0;
  // Of a frame.
  Cascade* cascade_ = nullptr;
  Vec3* samples_ = nullptr;
  Vec2* columns_ = nullptr;
  float* row_ = nullptr;
  View view_;
  const float* q_ = nullptr;
  // Of an observation.
  SurfaceFrame surface_;
  Projector::Derivatives in_key_;
  Mat2 from_key_;  // inverse of d image / d (u,v) in the key frame
};

}  // namespace pliant
