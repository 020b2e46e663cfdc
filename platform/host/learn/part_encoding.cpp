// The table of part readers from learnt numbers: rows of int8, each with its largest weight at 127.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "host/learn/part_learning.hpp"
#include "pliant/model.hpp"

namespace pliant::host::learn {

namespace {

template <class T>
void put(std::vector<std::uint8_t>& bytes, const T& value) {
  const auto* const first = reinterpret_cast<const std::uint8_t*>(&value);
  bytes.insert(bytes.end(), first, first + sizeof(T));
}

double largest_of(const double* row, std::size_t count) {
  double largest = 1e-12;
  for (std::size_t k = 0; k < count; ++k) largest = std::max(largest, std::abs(row[k]));
  return largest;
}

void put_floats(std::vector<std::uint8_t>& bytes, const std::vector<double>& values) {
  for (const double v : values) put(bytes, static_cast<float>(v));
}

void put_weights(std::vector<std::uint8_t>& bytes, const LearntPart& part) {
  put_floats(bytes, part.start);
  std::vector<double> information = part.information;
  for (std::size_t k = 1; k < information.size(); k += 3)
    information[k] *= 0.999;  // rounding keeps it definite
  put_floats(bytes, information);
  const auto scale = [&](std::size_t stage, std::size_t row) {
    const std::size_t inputs = part_bytes(part.record, stage);
    return largest_of(part.stages[stage].rows.data() + row * inputs, inputs) / 127;
  };
  for (std::size_t k = 0; k < part.stages.size(); ++k) {
    for (std::size_t row = 0; row < part.start.size(); ++row) put(bytes, static_cast<float>(scale(k, row)));
    put_floats(bytes, part.stages[k].bias);
  }
  for (std::size_t k = 0; k < part.stages.size(); ++k) {
    const std::size_t inputs = part_bytes(part.record, k);
    for (std::size_t row = 0; row < part.start.size(); ++row)
      for (std::size_t i = 0; i < inputs; ++i)
        put(bytes,
            static_cast<std::int8_t>(std::lround(part.stages[k].rows[row * inputs + i] / scale(k, row))));
  }
  bytes.resize((bytes.size() + 3) / 4 * 4);
}

}  // namespace

std::vector<std::uint8_t> encode_parts(const std::vector<LearntPart>& parts) {
  std::vector<std::uint8_t> bytes;
  PartHeader header{kPartMagic, kPartVersion, 0, 0, static_cast<std::uint16_t>(parts.size()), 0};
  put(bytes, header);
  auto first = static_cast<std::uint32_t>(sizeof header + parts.size() * sizeof(PartRecord));
  for (const LearntPart& part : parts) {
    PartRecord record = part.record;
    record.first_byte = first;
    put(bytes, record);
    first += static_cast<std::uint32_t>(part_weight_bytes(record));
  }
  for (const LearntPart& part : parts) put_weights(bytes, part);
  header.total_bytes = static_cast<std::uint32_t>(bytes.size());
  std::memcpy(bytes.data(), &header, sizeof header);
  constexpr std::size_t summed = offsetof(PartHeader, part_count);
  header.crc32 = crc32(bytes.data() + summed, bytes.size() - summed);
  std::memcpy(bytes.data(), &header, sizeof header);
  return bytes;
}

}  // namespace pliant::host::learn
