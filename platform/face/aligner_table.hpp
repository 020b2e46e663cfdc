#pragma once
// The learnt table of alignment. One little-endian block, read in place. `open` checks
// every size, index and number once; whatever opens is safe to use.
//
// Layout: AlignerHeader, the numbers of the landmarks (a byte each, padded to 4), AlignerStages,
// AlignerCheck, then the weights that stages and check refer to.
#include <cstddef>
#include <cstdint>

#include "face/gradient_map.hpp"
#include "pliant/arena.hpp"
#include "pliant/geometry.hpp"
#include "pliant/status.hpp"

namespace pliant {

constexpr std::uint32_t kAlignerMagic = 0x314e4c41, kAlignerVersion = 2;  // "ALN1"
constexpr int kMostAlignerLandmarks = 68, kMostAlignerStages = 8, kMostAlignerComponents = 32;
constexpr int kMostBlocks = 4;  // a side of the grid of blocks of a global stage
constexpr int kMostBlockBytes = kMostBlockCells * kMostBlockCells * kBlockChannels;

/// First bytes of the table.
struct AlignerHeader {
  std::uint32_t magic, version, total_bytes;
  std::uint32_t crc32;  // of everything behind this field
  std::uint16_t landmark_count, stage_count;
};

/// Landmarks that an alignment with this table needs room for: read before it is checked, so that a measuring arena counts the
/// same. Without a table it is the most that one may have.
std::size_t landmark_room(Span<const std::uint8_t> table);

/// What a stage does. A local stage (components = 0) predicts the displacement of each landmark from the
/// block around it. A global stage predicts all displacements from blocks on a grid over the crop, through a
/// few linear components.
struct AlignerStage {
  float mm_per_px;           // of the crop: the face's millimetres a pixel
  std::uint16_t crop_px;     // a side of the crop
  std::uint8_t cells;        // a side of a block
  std::uint8_t cell_px;      // a side of a cell
  std::uint8_t blocks;       // a side of the grid of blocks; 0 in a local stage
  std::uint8_t components;   // 0: local
  std::uint8_t refines;      // 1: refinement from a nearby pose runs this stage too
  std::uint8_t stride;       // the step goes towards every stride-th landmark: early steps need no more
  float prior;               // weight of the parameters' prior against the displacements' information
  std::uint32_t first_byte;  // of its weights
};

constexpr int kCheckKnots = 16;
constexpr int kCheckFeatures = 4;  // 1, appearance, displacement, parameters
constexpr int kFaceParts = 4;      // each eye with its brow, nose, mouth

/// Verification: a weighted sum of features, then a curve through `at` at equal distances from `low` to `high`.
struct AlignerCurve {
  float weight[kCheckFeatures];
  float low, high;
  float at[kCheckKnots];
};

/// The appearance is a weighted sum of the bytes of the last stage's blocks. On faces that are aligned right each part has a mean
/// (of a landmark) and a deviation (of the sum). The text form is another such sum: it is below 0 on text, and about 0 elsewhere.
struct AlignerCheck {
  AlignerCurve score, error;
  float usual[2 * kFaceParts];  // the means, then 1 / deviation each
  std::uint32_t first_byte;  // of the appearance's weights
  std::uint32_t text_byte;   // of those of the text form; 0: none
};

// The weights of local stages and of the appearance change with the yaw. Those stored are for a face that is
// turned to the left of the picture. A face turned to the right is the mirror image of such a face: its
// weights are those of the landmark on the other side, and read the mirrored block. Between both, the two
// results are mixed (gate).

/// Displacement of landmark k, mm in the crop's axes: scale * (row . block) + bias, the first of them mixed
/// by the gate.
struct LocalWeights {
  const float *scale, *bias;  // two a landmark: x, y
  const float* information;   // three a landmark: xx, xy, yy, 1/mm^2
  const float* blend;         // one a landmark: fraction of the last displacement that its position gets
  const std::int8_t* rows;    // two a landmark
};

/// Component c: scale * (basis . blocks) + bias. Displacement of landmark k along an axis: mean + sum of
/// output * component.
struct GlobalWeights {
  const float *scale, *bias;  // a component
  const float* mean;          // two a landmark
  const float* information;   // three a landmark
  const std::int8_t* output;  // `components` for each of two a landmark
  const std::int8_t* basis;   // a row a component
};

/// Appearance or text form: sum of scale * (row . block) + bias over the landmarks.
struct CheckWeights {
  const float *scale, *bias;  // a landmark
  const std::int8_t* rows;    // a landmark
};

/// Number of the landmark on the other side of the face, by the iBUG scheme.
int mirrored_landmark_number(int number);
/// The part of the face that it belongs to: 0 right eye and brow, 1 left, 2 nose, 3 mouth and jaw.
int part_of_landmark(int number);
/// Whether the sizes and numbers of a stage are in range. The offset of its weights is not checked.
bool is_valid(const AlignerStage& stage);
/// Bytes of one block of a stage.
constexpr std::size_t block_bytes(const AlignerStage& s) {
  return static_cast<std::size_t>(s.cells) * s.cells * kBlockChannels;
}
/// Bytes of all blocks of a grid.
constexpr std::size_t grid_bytes(const AlignerStage& s) {
  return block_bytes(s) * s.blocks * s.blocks;
}
/// Bytes of a stage's weights; each part is padded to 4 bytes.
std::size_t weight_bytes(const AlignerStage& stage, std::size_t landmarks);
std::size_t check_weight_bytes(const AlignerStage& last, std::size_t landmarks);

/// A checked table.
class AlignerTable {
 public:
  /// \return not_found (no bytes), misaligned, truncated, bad_magic, bad_version, bad_checksum, bad_table;
  ///         `table` is then as before.
  static Status open(Span<const std::uint8_t> bytes, AlignerTable* table, bool is_summed = false);

  std::size_t landmark_count() const { return landmarks_; }
  std::size_t stage_count() const { return stages_.count; }
  const std::uint8_t* landmark_numbers() const { return numbers_; }  ///< NN of ibugNN each; ascending
  const AlignerStage& stage(std::size_t k) const { return stages_[k]; }
  const AlignerCheck& check() const { return *check_; }
  LocalWeights local(std::size_t stage) const;
  GlobalWeights global(std::size_t stage) const;
  CheckWeights check_weights() const { return check_weights(check_->first_byte); }
  bool tells_text() const { return check_->text_byte != 0; }
  CheckWeights text_weights() const { return check_weights(check_->text_byte); }  ///< \pre tells_text()
  /// Index of the landmark on the other side of the face; k itself in the middle.
  std::size_t mirrored(std::size_t k) const { return mirrored_[k]; }

 private:
  CheckWeights check_weights(std::uint32_t first_byte) const;

  const std::uint8_t* bytes_ = nullptr;
  std::size_t landmarks_ = 0;
  const std::uint8_t* numbers_ = nullptr;
  std::uint8_t mirrored_[kMostAlignerLandmarks] = {};
  Span<const AlignerStage> stages_;
  const AlignerCheck* check_ = nullptr;
};

}  // namespace pliant
