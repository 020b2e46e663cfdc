#pragma once
// One pass of alignment over a face: an upright crop at the present pose, blocks around its landmarks, and
// the displacements that a table predicts from them. Runtime and training run the same code.
#include "face/aligner_table.hpp"
#include "face/face_motion.hpp"
#include "face/face_picture.hpp"
#include "face/face_shape.hpp"
#include "face/gradient_map.hpp"
#include "pliant/face_box.hpp"

namespace pliant {

/// What the last stage's blocks say about a face.
struct AlignerEvidence {
  float appearance = 0;    ///< weighted sum of the blocks (CheckWeights)
  float text = 0;          ///< the text form; below 0 on text
  float displacement = 0;  ///< root mean square of the displacements left, mm
  float parameters = 0;    ///< mean square of the parameters, in standard deviations
  float least_part = 0;    ///< how far the least part is below what is usual, standard deviations; at most 0
};

/// The frame, the face in it, and the crop.
class AlignerPass {
 public:
  void lay_out(Arena& arena, const Model& model, std::size_t landmarks,
               AlignerUse use = AlignerUse::alignment);
  /// Of a spread alignment: what `take_picture` fills, and samples. Taken again for each frame.
  void lay_out_scratch(Arena& arena);

  /// The landmarks ibugNN of these numbers. Done once.
  /// \return how many of them the model has; 0 if it lacks an outer eye corner or a mouth corner.
  std::size_t choose_landmarks(const Model& model, const std::uint8_t* numbers, std::size_t count);
  std::size_t table_index(std::size_t k) const { return index_[k]; }          ///< of landmark k in `numbers`
  std::uint16_t model_index(std::size_t k) const { return model_index_[k]; }  ///< of landmark k in the model

  /// Starts at a pose, and takes the picture around the face. \return false if that is nowhere.
  bool start(const FrameView& frame, const Lens& lens, const View& view, const float* q,
             const std::uint8_t* is_free);
  /// Of the frames' pixels, as Camera::aspect; 1 unless set. All image positions are then of square pixels: y over the aspect.
  void set_aspect(float aspect) { picture_.set_aspect(aspect); }
  /// The same picture of another frame, at the present pose.
  bool take_picture(const FrameView& frame);
  /// Keeps what `follow` compares. No other call of this object may come between.
  void keep_picture() { motion().keep(picture_); }
  /// The picture of a later frame, with the face moved as it has since the picture that was kept. \return as `take_picture`.
  bool follow(const FrameView& frame);

  /// Cuts out the crop of a stage at the present pose.
  void prepare(const AlignerStage& stage);
  const CropMap& map() const { return map_; }
  /// How far the face of `prepare` is turned: 0 to the left of the picture, 1 to its right, 0.5 frontal.
  float gate() const { return gate_; }
  /// Block around a position in the crop of `prepare`. \param x  px of the frame. \return the block's middle, crop px.
  Vec2 describe_around(Vec2 x, const AlignerStage& stage, std::uint8_t* out) const;
  /// Block (i, j) of a global stage's grid.
  void describe_place(int i, int j, const AlignerStage& stage, std::uint8_t* out) const;

  /// Runs one stage: `prepare`, displacements, and a step.
  void run_stage(const AlignerTable& table, std::size_t stage);
  /// The last stage's displacements at the present pose, without a step, and what its blocks say.
  AlignerEvidence weigh(const AlignerTable& table);
  /// Of landmark k, after `weigh`: its projection, and the position that the last stage predicts; px of the frame.
  Vec2 image(std::size_t k) const { return image_[k]; }
  Vec2 target(std::size_t k) const { return target_[k]; }

  FaceShape& shape() { return shape_; }

 private:
  Vec2 predict_local(const AlignerTable& table, const AlignerStage& stage, const LocalWeights& weights,
                     std::size_t index, Vec2 x) const;
  void predict_components(const AlignerStage& stage, const GlobalWeights& weights);
  Vec2 predict_global(const AlignerStage& stage, const GlobalWeights& weights, std::size_t index,
                      Vec2 x) const;

  FaceMotion& motion();

  FacePicture picture_;
  FaceMotion* motion_ = nullptr;  // null: in the memory of the gradients
  GradientMap gradients_;
  FaceShape shape_;
  CropMap map_;
  float gate_ = 0.5f;
  std::uint8_t *block_ = nullptr, *mirrored_ = nullptr;
  std::uint16_t *index_ = nullptr, *model_index_ = nullptr;
  Vec2 *image_ = nullptr, *target_ = nullptr;
  float* components_ = nullptr;
};

}  // namespace pliant
