#include "host/learn/aligner_encoding.hpp"

#include <algorithm>
#include <cmath>

#include "host/io/failure.hpp"
#include "host/io/table_checksum.hpp"
#include "host/learn/weight_table.hpp"

namespace pliant::host::learn {

namespace {

void put_rows(WeightTable& table, const std::vector<std::int8_t>& rows) {
  table.put_bytes(rows);
  table.pad();
}

void put_local(WeightTable& table, const LearntLocal& w, std::size_t block) {
  const QuantisedRows q(w.rows, block);
  table.put_floats(q.scale);
  table.put_floats(w.bias);
  table.put_floats(safe_information(w.information));
  table.put_floats(w.blend);
  put_rows(table, q.bytes);
}

void put_check(WeightTable& table, const std::vector<double>& rows, const std::vector<double>& bias,
               std::size_t block) {
  const QuantisedRows q(rows, block);
  table.put_floats(q.scale);
  table.put_floats(bias);
  put_rows(table, q.bytes);
}

/// A component's scale holds the scale of its column of outputs too.
void put_global(WeightTable& table, const LearntGlobal& w, std::size_t row) {
  const std::size_t components = w.bias.size(), outputs = w.mean.size();
  const QuantisedRows q(w.basis, row);
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
  table.put_floats(scale);
  table.put_floats(bias);
  table.put_floats(w.mean);
  table.put_floats(safe_information(w.information));
  put_rows(table, output);
  put_rows(table, q.bytes);
}

}  // namespace

OpenAlignerTable::OpenAlignerTable(const std::vector<std::uint8_t>& bytes) : bytes_(bytes) {
  require(AlignerTable::open(bytes_.span(), &table_), "the aligner's table");
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
  WeightTable table;
  const std::size_t landmarks = numbers.size();
  table.put(AlignerHeader{kAlignerMagic, kAlignerVersion, 0, 0, static_cast<std::uint16_t>(landmarks),
                          static_cast<std::uint16_t>(stages.size())});
  for (const int n : numbers) table.put(static_cast<std::uint8_t>(n));
  table.pad();
  const std::size_t stages_at = table.size();
  for (const LearntStage& s : stages) table.put(s.shape);
  const std::size_t check_at = table.size();
  table.put(AlignerCheck{});
  for (std::size_t k = 0; k < stages.size(); ++k) {
    AlignerStage shape = stages[k].shape;
    shape.first_byte = static_cast<std::uint32_t>(table.size());
    table.replace(stages_at + k * sizeof(AlignerStage), shape);
    if (shape.components == 0)
      put_local(table, stages[k].local, block_bytes(shape));
    else
      put_global(table, stages[k].global, block_bytes(shape) * shape.blocks * shape.blocks);
  }
  AlignerCheck written{check.score, check.error, {}, static_cast<std::uint32_t>(table.size()), 0};
  std::copy(check.part_mean.begin(), check.part_mean.end(), written.usual);
  std::copy(check.part_scale.begin(), check.part_scale.end(), written.usual + kFaceParts);
  const std::size_t block = block_bytes(stages.back().shape);
  put_check(table, check.rows, check.bias, block);
  if (!check.text_rows.empty()) {
    written.text_byte = static_cast<std::uint32_t>(table.size());
    put_check(table, check.text_rows, check.text_bias, block);
  }
  table.replace(check_at, written);
  table.replace(offsetof(AlignerHeader, total_bytes), static_cast<std::uint32_t>(table.size()));
  set_checksum<AlignerHeader>(table.bytes());
  return table.bytes();
}

}  // namespace pliant::host::learn
