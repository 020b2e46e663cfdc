#pragma once
// One pass of alignment over a face: an upright crop at the present pose, blocks around its landmarks, and the displacements
// that a table predicts from them. Runtime and training run the same code.
#include "face/aligner_table.hpp"
#include "face/face_picture.hpp"
#include "face/face_shape.hpp"
#include "face/gradient_block.hpp"

namespace pliant {

/// What the last stage's blocks say about a face.
struct AlignerEvidence {
  float appearance = 0;    ///< weighted sum of the blocks (CheckWeights)
  float displacement = 0;  ///< root mean square of the displacements left, mm
  float parameters = 0;    ///< mean square of the parameters, in standard deviations
};

/// The frame, the face in it, and the crop.
class AlignerPass {
 public:
  void lay_out(Arena& arena, const Model& model, std::size_t landmarks);

  /// The landmarks: index in the table of each, and its name's number. Done once.
  /// \return how many of the table's landmarks the model has.
  std::size_t choose_landmarks(const Model& model, const AlignerTable& table);
  std::size_t table_index(std::size_t k) const { return index_[k]; }
  std::uint16_t model_index(std::size_t k) const { return model_index_[k]; }  ///< of the model's landmark

  /// Takes the picture around the face of `view`.
  void start(const FrameView& frame, const Lens& lens, const View& view, const float* q,
             const std::uint8_t* is_free);

  /// Projects the landmarks and cuts out the crop of a stage.
  void prepare(const AlignerStage& stage);
  const CropMap& map() const { return map_; }

  /// Block around landmark k in the crop of `prepare`. \return its middle, crop px.
  Vec2 describe_landmark(std::size_t k, const AlignerStage& stage, std::uint8_t* out) const;
  /// Block (i, j) of a global stage's grid.
  void describe_place(int i, int j, const AlignerStage& stage, std::uint8_t* out) const;

  /// Targets of a stage, after `prepare`.
  void predict(const AlignerTable& table, std::size_t stage);
  /// Moves the face towards the targets.
  void step(const AlignerStage& stage) { shape_.step(targets_, stage.prior, stage.iterations); }
  /// `prepare` and `predict` of the last stage at the present pose, and what they say.
  AlignerEvidence weigh(const AlignerTable& table);

  const LandmarkTarget& target(std::size_t k) const { return targets_[k]; }
  FaceShape& shape() { return shape_; }
  const FaceShape& shape() const { return shape_; }

 private:
  void predict_local(const AlignerTable& table, std::size_t stage, const CheckWeights* check,
                     AlignerEvidence* out);
  void predict_global(const AlignerTable& table, std::size_t stage);
  void set_target(std::size_t k, Vec2 x, const float* information, float mm_per_px);

  FacePicture picture_;
  GradientBlocks blocks_;
  FaceShape shape_;
  CropMap map_;
  std::uint8_t *crop_ = nullptr, *block_ = nullptr;
  std::uint16_t *index_ = nullptr, *model_index_ = nullptr;
  LandmarkTarget* targets_ = nullptr;
  std::int32_t* components_ = nullptr;
};

}  // namespace pliant
