#pragma once
/// \file face_aligner.hpp
/// Alignment: pose and parameters of a face in one frame, from a face box or from a nearby pose; no landmarks
/// are needed. Verification: how probably such a pose is right.
#include <cstddef>
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/camera.hpp"
#include "pliant/face_box.hpp"
#include "pliant/frame.hpp"
#include "pliant/model.hpp"
#include "pliant/status.hpp"

namespace pliant {

/// Result of an alignment or of a verification.
struct AlignedFace {
  Camera camera;    ///< as given
  Pose pose;        ///< of the model
  float score = 0;  ///< probability that this is a face, aligned right: 0 to 1
  /// Expected mean error of the landmarks, as a fraction of the distance of the outer eye corners.
  float landmark_error = 0;
  /// Of the part of the face (an eye, the nose, the mouth) that looks least like one: how far it is below the mean of faces that
  /// are aligned right, in standard deviations; at most 0. With the built-in face's tables about -2.5 where a mask covers the mouth
  /// (docs/algorithms.md, section 7.14).
  float least_part = 0;
};

/// Options of one alignment.
struct AlignOptions {
  /// One flag a parameter of the model: nonzero, it is estimated; else it keeps its value in q, or the nearer limit of its range,
  /// as in a Tracker. Null: all are estimated.
  const std::uint8_t* is_free = nullptr;
  /// Of an alignment in a box: by how much the face is turned in the image, clockwise, radians; an error of 30 degrees is allowed
  /// (DetectedFace). What is not finite counts as 0.
  float roll = 0;
  /// Of an alignment over several frames: its score is taken twice, after the last stage and in one more step, the last, which may
  /// be taken in a later frame. The larger one counts, unless the second is below 0.3: light that hides the face in one of the two
  /// frames need not speak against the alignment.
  bool is_scored_twice = false;
};

/// Aligns one model to faces in frames, by the learnt table of a model or another one (docs/algorithms.md,
/// sections 7.13 and 7.14).
///
/// A stage reads gradient histograms around the projected landmarks in an upright picture of the face, and a
/// table turns them into displacements of the landmarks. One regularised Gauss-Newton step follows, in pose
/// and parameters. The landmarks are those named ibugNN, so that one table serves all face models. Bytes:
/// about 140 KiB for the built-in face.
class FaceAligner {
 public:
  /// Arena layout (create_in, measured_bytes), with the model's own learnt table, whose checksum Model::open has computed.
  void lay_out(Arena& arena, const Model& model) { lay_out(arena, model, model.aligner()); }
  /// The same in a third of the memory: what an alignment keeps from frame to frame. Each frame's calls need `lay_out_scratch`
  /// before them. Until the first one, calls return capacity.
  void lay_out_spread(Arena& arena, const Model& model);
  /// The rest, in memory that may be used otherwise after the frame's calls. If it has no room, or measures, they return capacity.
  /// Nothing happens after another layout.
  void lay_out_scratch(Arena& scratch);
  /// Bytes of it.
  static std::size_t scratch_bytes(const Model& model);
  /// The same for `verify`, and for alignments that leave no more parameters free than the model has expressions (others return
  /// capacity), in half of the memory: what the fields are at each landmark is not kept from step to step.
  void lay_out_for_known_person(Arena& arena, const Model& model);
  /// The same with another table.
  /// \param table  a learnt table, aligned to 4 bytes; it must outlive this object. A bad one is told by `status`.
  void lay_out(Arena& arena, const Model& model, Span<const std::uint8_t> table);

  /// Whether this object can align: ok, not_found (the model has no table, or too few of its landmarks),
  /// misaligned, truncated, bad_magic, bad_version, bad_checksum or bad_table; capacity (laid out spread, and
  /// without scratch). All calls below return this status where it is not ok.
  Status status() const;

  /// Aligns the model to the face in a box, from a frontal pose, turned by the roll, and the mean face.
  /// \param camera     intrinsics and lens of the frame; pixels need not be square (Camera::aspect).
  /// \param q          all parameters: the result. Those held by `options` are read and keep their value, within their range.
  /// \param landmarks  image positions of all landmarks of the model, px, in its order; may be empty.
  /// \return `status`, or with nothing changed: bad_argument (an unreadable frame, a box or camera that is
  ///         not finite or not positive, a principal point beyond 100,000 px, null q or face, too few
  ///         `landmarks`), not_found (the box is outside the frame, or the camera sees no face of that size).
  /// Cost: bounded, whatever the size of frame and face.
  Status align(const FrameView& frame, const FaceBox& box, const Camera& camera, AlignedFace* face, float* q,
               Span<Vec2> landmarks = {}, const AlignOptions& options = {});

  /// Begins an alignment as `align`, whose steps `advance` takes in this frame and in later ones: so its work
  /// can be spread. Any other call of this object ends it.
  /// \param q      all parameters; those held by `options` are read.
  /// \param steps  out: how many there are, at most 10. Each costs about the same.
  /// \return as `align`.
  Status begin(const FrameView& frame, const FaceBox& box, const Camera& camera, const float* q, int* steps,
               const AlignOptions& options = {});
  /// Takes steps of the alignment begun. In a later frame the face may have moved by up to a third of its box's side: it is
  /// followed by comparing the two frames. The last step writes the results. Each call takes the picture anew around the face, so
  /// that several calls in one frame end a little elsewhere than `align`.
  /// \return as `align`, where not_found ends the alignment; size_mismatch (another size than in `begin`);
  ///         not_started (no alignment, or all its steps were taken).
  Status advance(const FrameView& frame, int steps, AlignedFace* face, float* q, Span<Vec2> landmarks = {});

  /// Aligns from a pose and parameters near the right ones: after five points, or in a later frame.
  /// \param q  all parameters: start and result.
  /// \return as `align`.
  Status refine(const FrameView& frame, const Camera& camera, const Pose& start, AlignedFace* face, float* q,
                Span<Vec2> landmarks = {}, const AlignOptions& options = {});

  /// Score, landmark error and least part of a given pose and parameters. Moves nothing. Cost: about a fifth of an alignment.
  /// \return as `align`.
  Status verify(const FrameView& frame, const Camera& camera, const Pose& pose, const float* q,
                AlignedFace* face);

 private:
  struct State;  // in the arena
  State* state_ = nullptr;
};

}  // namespace pliant
