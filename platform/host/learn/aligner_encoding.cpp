#include "host/learn/aligner_encoding.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "host/io/failure.hpp"
#include "pliant/model.hpp"

namespace pliant::host::learn {

namespace {

class Bytes {
 public:
  template <class T>
  void put(const T& value) {
    const auto* const first = reinterpret_cast<const std::uint8_t*>(&value);
    bytes_.insert(bytes_.end(), first, first + sizeof(T));
  }
  void put_floats(const std::vector<double>& values) {
    for (const double v : values) put(static_cast<float>(v));
  }
  void pad() { bytes_.resize((bytes_.size() + 3) / 4 * 4); }
  std::size_t size() const { return bytes_.size(); }
  std::vector<std::uint8_t> take() { return std::move(bytes_); }
  template <class T>
  void replace(std::size_t at, const T& value) {
    std::memcpy(bytes_.data() + at, &value, sizeof(T));
  }

 private:
  std::vector<std::uint8_t> bytes_;
};

/// Rows of int8, each with its largest weight at 127.
struct Quantised {
  std::vector<double> scale;
  std::vector<std::int8_t> rows;

  Quantised(const std::vector<double>& weights, std::size_t columns) {
    for (std::size_t first = 0; first < weights.size(); first += columns) {
      double largest = 1e-12;
      for (std::size_t k = 0; k < columns; ++k) largest = std::max(largest, std::abs(weights[first + k]));
      scale.push_back(largest / 127);
      for (std::size_t k = 0; k < columns; ++k)
        rows.push_back(static_cast<std::int8_t>(std::lround(weights[first + k] / scale.back())));
    }
  }
};

void put_rows(Bytes& bytes, const std::vector<std::int8_t>& rows) {
  for (const std::int8_t r : rows) bytes.put(r);
  bytes.pad();
}

/// Off-diagonal entries shrink a little, so that rounding cannot make a matrix indefinite.
std::vector<double> safe_information(std::vector<double> w) {
  for (std::size_t k = 1; k < w.size(); k += 3) w[k] *= 0.999;
  return w;
}

void put_local(Bytes& bytes, const LearntLocal& w, std::size_t block) {
  const Quantised q(w.rows, block);
  bytes.put_floats(q.scale);
  bytes.put_floats(w.bias);
  bytes.put_floats(safe_information(w.information));
  bytes.put_floats(w.blend);
  put_rows(bytes, q.rows);
}

void put_check(Bytes& bytes, const std::vector<double>& rows, const std::vector<double>& bias,
               std::size_t block) {
  const Quantised q(rows, block);
  bytes.put_floats(q.scale);
  bytes.put_floats(bias);
  put_rows(bytes, q.rows);
}

/// A component's scale holds the scale of its column of outputs too.
void put_global(Bytes& bytes, const LearntGlobal& w, std::size_t row) {
  const std::size_t components = w.bias.size(), outputs = w.mean.size();
  const Quantised q(w.basis, row);
  std::vector<double> scale = q.scale, bias = w.bias;
  std::vector<std::int8_t> output(w.output.size());
  for (std::size_t c = 0; c < components; ++c) {
    double largest = 1e-12;
    for (std::size_t o = 0; o < outputs; ++o)
      largest = std::max(largest, std::abs(w.output[o * components + c]));
    for (std::size_t o = 0; o < outputs; ++o)
      output[o * components + c] =
          static_cast<std::int8_t>(std::lround(127 * w.output[o * components + c] / largest));
    scale[c] *= largest / 127;
    bias[c] *= largest / 127;
  }
  bytes.put_floats(scale);
  bytes.put_floats(bias);
  bytes.put_floats(w.mean);
  bytes.put_floats(safe_information(w.information));
  put_rows(bytes, output);
  put_rows(bytes, q.rows);
}

}  // namespace

void seal_aligner(std::uint8_t* table, std::size_t size) {
  constexpr std::size_t first = offsetof(AlignerHeader, landmark_count);
  const std::uint32_t crc = crc32(table + first, size - first);
  std::memcpy(table + offsetof(AlignerHeader, crc32), &crc, sizeof crc);
}

OpenAlignerTable::OpenAlignerTable(const std::vector<std::uint8_t>& bytes) : words_((bytes.size() + 3) / 4) {
  std::memcpy(words_.data(), bytes.data(), bytes.size());
  require(AlignerTable::open({reinterpret_cast<const std::uint8_t*>(words_.data()), bytes.size()}, &table_),
          "the aligner's table");
}

LearntCheck blank_check(std::size_t landmarks, const AlignerStage& last) {
  LearntCheck check;
  check.score.low = check.error.low = 0;
  check.score.high = check.error.high = 1;
  for (float& at : check.score.at) at = 1;
  check.rows.assign(landmarks * block_bytes(last), 0);
  check.bias.assign(landmarks, 0);
  return check;
}

std::vector<std::uint8_t> encode_aligner(const std::vector<int>& numbers,
                                         const std::vector<LearntStage>& stages, const LearntCheck& check) {
  Bytes bytes;
  const std::size_t landmarks = numbers.size();
  bytes.put(AlignerHeader{kAlignerMagic, kAlignerVersion, 0, 0, static_cast<std::uint16_t>(landmarks),
                          static_cast<std::uint16_t>(stages.size())});
  for (const int n : numbers) bytes.put(static_cast<std::uint8_t>(n));
  bytes.pad();
  const std::size_t stages_at = bytes.size();
  for (const LearntStage& s : stages) bytes.put(s.shape);
  const std::size_t check_at = bytes.size();
  bytes.put(AlignerCheck{});
  for (std::size_t k = 0; k < stages.size(); ++k) {
    AlignerStage shape = stages[k].shape;
    shape.first_byte = static_cast<std::uint32_t>(bytes.size());
    bytes.replace(stages_at + k * sizeof(AlignerStage), shape);
    if (shape.components == 0)
      put_local(bytes, stages[k].local, block_bytes(shape));
    else
      put_global(bytes, stages[k].global, block_bytes(shape) * shape.blocks * shape.blocks);
  }
  AlignerCheck written{check.score, check.error, {}, static_cast<std::uint32_t>(bytes.size()), 0};
  std::copy(check.part_mean.begin(), check.part_mean.end(), written.usual);
  std::copy(check.part_scale.begin(), check.part_scale.end(), written.usual + kFaceParts);
  const std::size_t block = block_bytes(stages.back().shape);
  put_check(bytes, check.rows, check.bias, block);
  if (!check.text_rows.empty()) {
    written.text_byte = static_cast<std::uint32_t>(bytes.size());
    put_check(bytes, check.text_rows, check.text_bias, block);
  }
  bytes.replace(check_at, written);
  bytes.replace(offsetof(AlignerHeader, total_bytes), static_cast<std::uint32_t>(bytes.size()));
  std::vector<std::uint8_t> out = bytes.take();
  seal_aligner(out.data(), out.size());
  return out;
}

}  // namespace pliant::host::learn
