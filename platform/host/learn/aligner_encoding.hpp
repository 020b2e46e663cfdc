#pragma once
/// \file aligner_encoding.hpp
/// Learnt weights of alignment as real numbers, and their encoding as the table that the library reads.
#include <array>
#include <cstdint>
#include <vector>

#include "face/aligner_table.hpp"
#include "host/io/aligned_table.hpp"

namespace pliant::host::learn {

/// Weights of a local stage, L landmarks, blocks of D bytes. Displacements in mm.
struct LearntLocal {
  std::vector<double> rows;         ///< 2 L x D: x and y of each landmark
  std::vector<double> bias;         ///< 2 L
  std::vector<double> information;  ///< 3 L: xx, xy, yy
  std::vector<double> blend;        ///< L
};

/// Weights of a global stage, K components of D bytes.
struct LearntGlobal {
  std::vector<double> basis;        ///< K x D
  std::vector<double> bias;         ///< K
  std::vector<double> output;       ///< 2 L x K
  std::vector<double> mean;         ///< 2 L
  std::vector<double> information;  ///< 3 L
};

/// One stage; `local` or `global` is empty.
struct LearntStage {
  AlignerStage shape{};
  LearntLocal local;
  LearntGlobal global;
};

/// Weights of verification.
struct LearntCheck {
  AlignerCurve score{}, error{};
  std::array<float, kFaceParts> part_mean{}, part_scale{};
  std::vector<double> rows;  ///< L x D of the last stage
  std::vector<double> bias;  ///< L
  std::vector<double> text_rows, text_bias;  ///< of the text form, as many; empty: none
};

/// An opened table with its own memory.
class OpenAlignerTable {
 public:
  explicit OpenAlignerTable(const std::vector<std::uint8_t>& bytes);
  const AlignerTable& operator*() const { return table_; }
  const AlignerTable* operator->() const { return &table_; }

 private:
  AlignedTable bytes_;
  AlignerTable table_;
};

/// A check without weights: whatever it is given, score 1 and error 0.
LearntCheck blank_check(std::size_t landmarks, const AlignerStage& last);

/// The table. Weights become int8 with one scale a row.
/// \param numbers  of the landmarks, ascending. \param stages  the last one is local.
std::vector<std::uint8_t> encode_aligner(const std::vector<int>& numbers,
                                         const std::vector<LearntStage>& stages, const LearntCheck& check);

}  // namespace pliant::host::learn
