#pragma once
// A small aligner's table made by hand, for tests that need no learnt one.
#include <cstddef>
#include <cstring>
#include <vector>

#include "face/aligner_table.hpp"
#include "pliant/model.hpp"

namespace aligner_pattern {

/// A table in aligned memory.
struct Bytes {
  std::vector<std::uint32_t> words;
  std::size_t size = 0;

  std::uint8_t* data() { return reinterpret_cast<std::uint8_t*>(words.data()); }
  pliant::Span<const std::uint8_t> span() { return {data(), size}; }
  template <class T>
  T& at(std::size_t byte) {
    return *reinterpret_cast<T*>(data() + byte);
  }
};

constexpr std::size_t kLandmarks = 51;
constexpr std::size_t kStagesAt = sizeof(pliant::AlignerHeader) + 52;
constexpr std::size_t kCheckAt = kStagesAt + 2 * sizeof(pliant::AlignerStage);

inline pliant::AlignerStage& stage(Bytes& bytes, std::size_t k) {
  return bytes.at<pliant::AlignerStage>(kStagesAt + k * sizeof(pliant::AlignerStage));
}
inline pliant::AlignerCheck& check(Bytes& bytes) {
  return bytes.at<pliant::AlignerCheck>(kCheckAt);
}
/// Float k of the weights of a stage.
inline float& weight(Bytes& bytes, std::size_t of_stage, std::size_t k) {
  return bytes.at<float>(stage(bytes, of_stage).first_byte + 4 * k);
}

/// Writes the checksum.
inline void seal(Bytes& bytes) {
  using pliant::AlignerHeader;
  const std::size_t first = offsetof(AlignerHeader, landmark_count);
  bytes.at<AlignerHeader>(0).crc32 = pliant::crc32(bytes.data() + first, bytes.size - first);
}

/// A global and a local stage that want every landmark where it is, moved by (dx, dy) mm of the crop. The score is the
/// probability that the curve gives to a sum of 0.
inline Bytes table(float dx = 0, float dy = 0) {
  using namespace pliant;
  const AlignerStage global{2.4f, 48, 2, 8, 3, 2, 0, 3, 2, 0}, local{1.6f, 104, 2, 4, 0, 0, 1, 1, 1, 0};
  const std::size_t global_at = kCheckAt + sizeof(AlignerCheck);
  const std::size_t local_at = global_at + weight_bytes(global, kLandmarks);
  const std::size_t check_at = local_at + weight_bytes(local, kLandmarks);
  Bytes bytes;
  bytes.size = check_at + check_weight_bytes(local, kLandmarks);
  bytes.words.assign((bytes.size + 3) / 4, 0);
  bytes.at<AlignerHeader>(0) = {
      kAlignerMagic, kAlignerVersion, static_cast<std::uint32_t>(bytes.size), 0, kLandmarks, 2};
  for (std::size_t k = 0; k < kLandmarks; ++k)
    bytes.data()[sizeof(AlignerHeader) + k] = static_cast<std::uint8_t>(17 + k);
  stage(bytes, 0) = global;
  stage(bytes, 0).first_byte = static_cast<std::uint32_t>(global_at);
  stage(bytes, 1) = local;
  stage(bytes, 1).first_byte = static_cast<std::uint32_t>(local_at);
  AlignerCheck& c = check(bytes);
  c.score.low = c.error.low = -1;
  c.score.high = c.error.high = 1;
  for (int k = 0; k < kCheckKnots; ++k) c.score.at[k] = 0.75f;
  for (int k = 0; k < kCheckKnots; ++k) c.error.at[k] = 0.05f;
  c.first_byte = static_cast<std::uint32_t>(check_at);
  for (std::size_t k = 0; k < kLandmarks; ++k) {
    // After scale and bias: mean, then information; after scale: bias, then information, then blend.
    weight(bytes, 0, 4 + 2 * k) = dx;
    weight(bytes, 0, 4 + 2 * k + 1) = dy;
    weight(bytes, 0, 4 + 2 * kLandmarks + 3 * k) = 1;
    weight(bytes, 0, 4 + 2 * kLandmarks + 3 * k + 2) = 1;
    weight(bytes, 1, 2 * kLandmarks + 2 * k) = dx;
    weight(bytes, 1, 2 * kLandmarks + 2 * k + 1) = dy;
    weight(bytes, 1, 4 * kLandmarks + 3 * k) = 1;
    weight(bytes, 1, 4 * kLandmarks + 3 * k + 2) = 1;
  }
  seal(bytes);
  return bytes;
}

/// Gives a table a text form: each landmark that is seen adds `bias`.
inline void add_text(Bytes& bytes, float bias) {
  using namespace pliant;
  check(bytes).text_byte = static_cast<std::uint32_t>(bytes.size);
  bytes.size += check_weight_bytes(stage(bytes, 1), kLandmarks);
  bytes.words.resize((bytes.size + 3) / 4, 0);
  bytes.at<AlignerHeader>(0).total_bytes = static_cast<std::uint32_t>(bytes.size);
  for (std::size_t k = 0; k < kLandmarks; ++k)
    bytes.at<float>(check(bytes).text_byte + 4 * (kLandmarks + k)) = bias;
  seal(bytes);
}

}  // namespace aligner_pattern
