#include "face/aligner_table.hpp"

#include <doctest/doctest.h>

#include <limits>

#include "aligner_pattern.hpp"
#include "baked_face.hpp"
#include "model_builder.hpp"
#include "pliant/face_aligner.hpp"

namespace aligner_table_test {

using namespace pliant;
using aligner_pattern::Bytes;

namespace {

Status status_of(Bytes& bytes) {
  AlignerTable table;
  return AlignerTable::open(bytes.span(), &table);
}

template <class Change>
Status with(const Change& change) {
  Bytes bytes = aligner_pattern::table();
  change(bytes);
  aligner_pattern::seal(bytes);
  return status_of(bytes);
}

}  // namespace

TEST_CASE("a table cut at any byte does not open") {
  Bytes bytes = aligner_pattern::table();
  const std::size_t size = bytes.size;
  REQUIRE(status_of(bytes) == Status::ok);
  for (bytes.size = 0; bytes.size < size; ++bytes.size)
    REQUIRE(status_of(bytes) == (bytes.size == 0 ? Status::not_found : Status::truncated));
  bytes.words.push_back(0);
  bytes.size = size + 3;  // padding behind a table is no error
  CHECK(status_of(bytes) == Status::ok);
}

TEST_CASE("a table with a flipped bit does not open") {
  Bytes bytes = aligner_pattern::table();
  for (std::size_t k = 0; k < bytes.size; ++k) {
    const int bit = static_cast<int>(k % 8);
    bytes.data()[k] = static_cast<std::uint8_t>(bytes.data()[k] ^ (1 << bit));
    REQUIRE(status_of(bytes) != Status::ok);
    bytes.data()[k] = static_cast<std::uint8_t>(bytes.data()[k] ^ (1 << bit));
  }
  CHECK(status_of(bytes) == Status::ok);
}

TEST_CASE("a table at an odd address is misaligned") {
  Bytes bytes = aligner_pattern::table();
  AlignerTable table;
  CHECK(AlignerTable::open({bytes.data() + 1, bytes.size - 1}, &table) == Status::misaligned);
}

TEST_CASE("values out of range do not open, even with the right checksum") {
  using namespace aligner_pattern;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  CHECK(with([](Bytes&) {}) == Status::ok);
  CHECK(with([](Bytes& b) { b.at<AlignerHeader>(0).magic += 1; }) == Status::bad_magic);
  CHECK(with([](Bytes& b) { b.at<AlignerHeader>(0).version += 1; }) == Status::bad_version);
  CHECK(with([](Bytes& b) { b.at<AlignerHeader>(0).stage_count = 0; }) == Status::bad_table);
  CHECK(with([](Bytes& b) { b.at<AlignerHeader>(0).landmark_count = 69; }) == Status::bad_table);
  CHECK(with([](Bytes& b) { b.data()[sizeof(AlignerHeader) + 1] = 17; }) == Status::bad_table);
  CHECK(with([](Bytes& b) { b.data()[sizeof(AlignerHeader) + 50] = 68; }) == Status::bad_table);
  CHECK(with([](Bytes& b) { stage(b, 0).first_byte += 1; }) == Status::bad_table);
  CHECK(with([](Bytes& b) { stage(b, 1).first_byte = 0xfffffffc; }) == Status::bad_table);
  CHECK(with([](Bytes& b) { stage(b, 1).cells = 9; }) == Status::bad_table);
  CHECK(with([](Bytes& b) { stage(b, 1).crop_px = 7; }) == Status::bad_table);
  CHECK(with([](Bytes& b) { stage(b, 1).crop_px = kMostCropPx + 1; }) == Status::bad_table);
  CHECK(with([](Bytes& b) { stage(b, 1).stride = 0; }) == Status::bad_table);
  CHECK(with([](Bytes& b) { stage(b, 0).components = 33; }) == Status::bad_table);
  CHECK(with([](Bytes& b) { stage(b, 0).blocks = 4; }) == Status::bad_table);
  CHECK(with([&](Bytes& b) { stage(b, 1).mm_per_px = nan; }) == Status::bad_table);
  CHECK(with([](Bytes& b) { stage(b, 1).prior = -1; }) == Status::bad_table);
  CHECK(with([&](Bytes& b) { weight(b, 1, 0) = nan; }) == Status::bad_table);
  CHECK(with([](Bytes& b) { weight(b, 1, 2 * kLandmarks) = 2e3f; }) == Status::bad_table);
  CHECK(with([](Bytes& b) { weight(b, 1, 4 * kLandmarks + 1) = 1.5f; }) == Status::bad_table);
  CHECK(with([&](Bytes& b) { weight(b, 0, 4) = nan; }) == Status::bad_table);
  CHECK(with([](Bytes& b) { check(b).score.at[3] = 1.5f; }) == Status::bad_table);
  CHECK(with([](Bytes& b) { check(b).score.high = -1; }) == Status::bad_table);
  CHECK(with([&](Bytes& b) { check(b).usual[0] = nan; }) == Status::bad_table);
  CHECK(with([](Bytes& b) { check(b).usual[7] = 2e3f; }) == Status::bad_table);
  CHECK(with([](Bytes& b) { check(b).first_byte += 4; }) == Status::bad_table);
  CHECK(with([](Bytes& b) { add_text(b, 1); }) == Status::ok);
  CHECK(with([](Bytes& b) { add_text(b, 2e3f); }) == Status::bad_table);
  CHECK(with([](Bytes& b) {
          add_text(b, 1);
          check(b).text_byte += 4;
        }) == Status::bad_table);
}

TEST_CASE("each landmark belongs to a part of the face, and its counterpart to the part on the other side") {
  int count[kFaceParts] = {};
  for (int n = 0; n < 68; ++n) {
    const int part = part_of_landmark(n), other = part_of_landmark(mirrored_landmark_number(n));
    REQUIRE(part >= 0);
    REQUIRE(part < kFaceParts);
    CHECK(other == (part < 2 ? 1 - part : part));
    ++count[part];
  }
  CHECK(count[0] == 11);
  CHECK(count[1] == 11);
  CHECK(count[2] == 9);
  CHECK(count[3] == 37);
}

TEST_CASE("the parts of a table lie one behind the other") {
  Bytes bytes = aligner_pattern::table(2, -1);
  AlignerTable table;
  REQUIRE(AlignerTable::open(bytes.span(), &table) == Status::ok);
  CHECK(table.landmark_count() == 51);
  CHECK(table.landmark_numbers()[50] == 67);
  REQUIRE(table.stage_count() == 2);
  const GlobalWeights global = table.global(0);
  CHECK(global.mean[100] == 2);
  CHECK(global.mean[101] == -1);
  CHECK(global.information[150] == 1);
  const LocalWeights local = table.local(1);
  CHECK(local.bias[101] == -1);
  CHECK(local.information[152] == 1);
  CHECK(local.rows + 2 * 51 * block_bytes(table.stage(1)) ==
        reinterpret_cast<const std::int8_t*>(table.check_weights().scale));
  const AlignerStage& first = table.stage(0);
  const auto of_global = reinterpret_cast<const std::int8_t*>(local.scale) -
                         (global.basis + first.components * first.blocks * first.blocks * block_bytes(first));
  CHECK(of_global >= 0);
  CHECK(of_global < 4);
  const auto* const end = reinterpret_cast<const std::int8_t*>(bytes.data() + bytes.size);
  const auto padding = end - (table.check_weights().rows + 51 * block_bytes(table.stage(1)));
  CHECK(padding >= 0);
  CHECK(padding < 4);
}

TEST_CASE("an aligner has room for the landmarks of its table: without one, for the most that one may have") {
  using namespace aligner_pattern;
  Bytes table = aligner_pattern::table();
  const Model& model = baked_face().model;
  const std::size_t most = measured_bytes<FaceAligner>(model, Span<const std::uint8_t>{}),
                    samples = (kMostAlignerLandmarks - kLandmarks) * sizeof(Vec3) * model.cascade().count;
  CHECK(measured_bytes<FaceAligner>(model, table.span()) + samples <= most);
  for (const int count : {0, 3, 69, 255, 256, 0xffff}) {
    table.at<AlignerHeader>(0).landmark_count = static_cast<std::uint16_t>(count);
    seal(table);
    InArena<FaceAligner> aligner(model, table.span());
    CHECK(aligner->status() == Status::bad_table);
  }
}

}  // namespace aligner_table_test
