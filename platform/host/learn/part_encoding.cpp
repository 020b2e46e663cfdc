// The table of part readers from learnt numbers.
#include "host/io/table_checksum.hpp"
#include "host/learn/part_learning.hpp"
#include "host/learn/weight_table.hpp"

namespace pliant::host::learn {

namespace {

void put_weights(WeightTable& table, const LearntPart& part) {
  table.put_floats(part.start);
  table.put_floats(safe_information(part.information));
  std::vector<QuantisedRows> stages;
  for (std::size_t k = 0; k < part.stages.size(); ++k) {
    stages.emplace_back(part.stages[k].rows, part_bytes(part.record, k));
    table.put_floats(stages.back().scale);
    table.put_floats(part.stages[k].bias);
  }
  for (const QuantisedRows& rows : stages) table.put_bytes(rows.bytes);
  table.pad();
}

}  // namespace

std::vector<std::uint8_t> encode_parts(const std::vector<LearntPart>& parts) {
  WeightTable table;
  table.put(PartHeader{kPartMagic, kPartVersion, 0, 0, static_cast<std::uint16_t>(parts.size()), 0});
  auto first = static_cast<std::uint32_t>(sizeof(PartHeader) + parts.size() * sizeof(PartRecord));
  for (const LearntPart& part : parts) {
    PartRecord record = part.record;
    record.first_byte = first;
    table.put(record);
    first += static_cast<std::uint32_t>(part_weight_bytes(record));
  }
  for (const LearntPart& part : parts) put_weights(table, part);
  table.replace(offsetof(PartHeader, total_bytes), static_cast<std::uint32_t>(table.size()));
  set_checksum<PartHeader>(table.bytes());
  return table.bytes();
}

}  // namespace pliant::host::learn
