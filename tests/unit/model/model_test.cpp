#include "pliant/model.hpp"

#include <doctest/doctest.h>

#include "model_builder.hpp"
#include "pliant/fit.hpp"
#include "pliant/fold_over.hpp"
#include "random.hpp"

namespace model_test {

using namespace pliant;

namespace {
void reseal(std::vector<std::uint32_t>& words) {
  words[3] = crc32(words.data() + 4, words.size() * 4 - 16);
}
Status open(const std::vector<std::uint32_t>& words, Model* model) {
  return Model::open(words.data(), words.size() * 4, model);
}
/// Whether a part of a model lies within its table.
template <class T>
bool lies_in(const std::vector<std::uint32_t>& words, Span<const T> part) {
  const auto* const first = reinterpret_cast<const unsigned char*>(part.data);
  const auto* const table = reinterpret_cast<const unsigned char*>(words.data());
  const std::size_t bytes = 4 * words.size();
  return part.empty() || (first >= table && first <= table + bytes &&
                          part.count <= static_cast<std::size_t>(table + bytes - first) / sizeof(T));
}
/// Whether the egg's table, changed, is accepted; else it is refused as a bad table.
bool opens(const std::function<void(ModelBuilder&)>& change) {
  ModelBuilder b = egg_model(2);
  change(b);
  Model model;
  const auto words = b.table();
  const Status status = open(words, &model);
  CHECK((status == Status::ok || status == Status::bad_table));
  return status == Status::ok;
}

}  // namespace

TEST_CASE("the checksum is the well-known CRC-32") {
  CHECK(crc32("123456789", 9) == 0xcbf43926u);
  for (std::size_t first = 0; first <= 9; ++first)
    CHECK(crc32(&"123456789"[first], 9 - first, crc32("123456789", first)) == 0xcbf43926u);
}

TEST_CASE("a table is opened in place and gives back what was put in") {
  const auto words = egg_model().table();
  Model model;
  REQUIRE(open(words, &model) == Status::ok);
  CHECK(model.parameters().count == 10);
  CHECK(model.cascade().count == 11);
  CHECK(model.find_parameter("jawOpen") == 8);
  CHECK(model.find_parameter("jawope") == kNone);
  CHECK(model.find_landmark("p88") == 80);
  CHECK(model.base_uv().count == 81);
  CHECK(model.base_corners().count == 3 * 128);
  CHECK(model.is_on_surface({0.3f, 1}));
  CHECK_FALSE(model.is_on_surface({0.3f, 1.01f}));
  CHECK(model.crc() == words[3]);
}

TEST_CASE("every cut of a table is refused and changes nothing") {
  const auto words = egg_model(1).table();
  Model model;
  for (std::size_t bytes = 0; bytes < words.size() * 4; bytes += bytes < 600 ? 1 : 97) {
    CHECK(Model::open(words.data(), bytes, &model) == Status::truncated);
    CHECK(model.parameters().count == 0);
  }
}

TEST_CASE("every flipped bit is noticed") {
  auto words = egg_model(1).table();
  Model model;
  for (std::size_t bit = 0; bit < words.size() * 32; bit += bit < 4000 ? 1 : 601) {
    words[bit / 32] ^= 1u << (bit % 32);
    CHECK(open(words, &model) != Status::ok);
    words[bit / 32] ^= 1u << (bit % 32);
  }
  CHECK(open(words, &model) == Status::ok);
}

TEST_CASE("a hostile table with a right checksum never gets through with an index out of range") {
  const auto good = egg_model(2).table();
  Random random(3);
  int refused = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    auto words = good;
    const int changes = 1 + random.below(3);
    for (int k = 0; k < changes; ++k) {
      // The directory and the records matter; samples may be anything.
      const auto at = static_cast<std::size_t>(
          4 + random.below(random.below(4) == 0 ? static_cast<int>(words.size()) - 4 : 200));
      words[at] = random.below(2) == 0 ? static_cast<std::uint32_t>(random.bits())
                                       : words[at] ^ (1u << random.below(32));
    }
    reseal(words);
    Model model;
    if (open(words, &model) != Status::ok) {
      ++refused;
      continue;
    }
    for (const CascadeRecord& r : model.cascade()) {
      if (r.field != kNone) CHECK(r.field < model.fields().count);
      for (std::uint16_t p : r.parameter)
        if (p != kNone) CHECK(p < model.parameters().count);
    }
    for (std::uint16_t c : model.base_corners()) CHECK(c < model.base_uv().count);
    CHECK((lies_in(words, model.parameters()) && lies_in(words, model.fields()) &&
           lies_in(words, model.cascade()) && lies_in(words, model.base_uv()) &&
           lies_in(words, model.base_corners()) && lies_in(words, model.landmarks())));
  }
  CHECK(refused > 300);
}

TEST_CASE("a section that ends beyond the table is refused, one that ends where the table does is not") {
  const auto good = egg_model(2).table();
  const auto size = static_cast<std::uint32_t>(4 * good.size());
  constexpr std::size_t kDirectory = sizeof(table::Header) / 4, kEntry = sizeof(table::Section) / 4;
  const auto status_with = [&](std::size_t section, std::uint32_t offset, std::uint32_t count) {
    auto words = good;
    words[kDirectory + kEntry * section + 1] = offset;
    words[kDirectory + kEntry * section + 2] = count;
    reseal(words);
    Model model;
    return open(words, &model);
  };
  for (std::size_t k = 0; k < good[4]; ++k) {
    const auto kind = static_cast<table::Kind>(good[kDirectory + kEntry * k]);
    const std::uint32_t offset = good[kDirectory + kEntry * k + 1], count = good[kDirectory + kEntry * k + 2];
    CAPTURE(k);
    CHECK(status_with(k, offset, count) == Status::ok);
    if (kind == table::Kind::samples) {  // bytes; what they are does not matter
      CHECK(status_with(k, offset, size - offset) == Status::ok);
      CHECK(status_with(k, offset, size - offset + 1) == Status::bad_table);
      CHECK(status_with(k, size, 1) == Status::bad_table);
    }
    if (count == 0) continue;
    CHECK(status_with(k, size + 4, count) == Status::bad_table);
    CHECK(status_with(k, offset, 0xffffffff) == Status::bad_table);
  }
}

TEST_CASE("null, misaligned, foreign and future tables are told apart") {
  auto words = egg_model(1).table();
  Model model;
  CHECK(Model::open(nullptr, 100, &model) == Status::bad_argument);
  CHECK(Model::open(words.data(), words.size() * 4, nullptr) == Status::bad_argument);
  CHECK(Model::open(reinterpret_cast<unsigned char*>(words.data()) + 2, 100, &model) == Status::misaligned);
  for (const std::uint32_t version : {0u, 3u, 5u, 6u, table::kVersion + 1, 0xFFFFFFFFu}) {
    words[1] = version;
    CHECK(open(words, &model) == Status::bad_version);
  }
  for (const std::uint32_t version : {1u, 2u, 4u}) {  // without learnt tables, springs, readers of parts
    words[1] = version;
    CHECK(open(words, &model) == Status::ok);
  }
  words[0] ^= 1;
  CHECK(open(words, &model) == Status::bad_magic);
}

TEST_CASE("each broken record is a bad table") {
  const auto refuse = [](const std::function<void(ModelBuilder&)>& damage) {
    ModelBuilder b = egg_model(2);
    damage(b);
    const auto words = b.table();
    Model model;
    CHECK(open(words, &model) == Status::bad_table);
  };
  refuse([](ModelBuilder& b) { b.parameters[1].sd = 0; });
  refuse([](ModelBuilder& b) { b.parameters[1].minimum = 0.5f; });
  refuse([](ModelBuilder& b) { b.parameters[1] = b.parameters[0]; });
  refuse([](ModelBuilder& b) { b.fields[0].width = 1; });
  refuse([](ModelBuilder& b) { b.fields[0].u1 = b.fields[0].u0; });
  refuse([](ModelBuilder& b) { b.fields[0].first_byte = 1u << 30; });
  refuse([](ModelBuilder& b) { b.cascade[2].source[0] = 2; });
  refuse([](ModelBuilder& b) { b.cascade[2].parameter[0] = 99; });
  refuse([](ModelBuilder& b) { b.cascade[2].operation = static_cast<Operation>(42); });
  refuse([](ModelBuilder& b) { b.cascade[2].weight = b.cascade[2].field; });
  refuse([](ModelBuilder& b) { b.cascade.clear(); });
  refuse([](ModelBuilder& b) { b.corners[5] = 1000; });
  refuse([](ModelBuilder& b) { b.vertices[5].x = 2; });
  refuse([](ModelBuilder& b) { b.landmarks[0].name[0] = 0; });
}

TEST_CASE("numbers that would overflow later are refused when the table is opened") {
  CHECK(opens([](ModelBuilder& b) { b.fields[1].scale[0] = 1e6f / 40000; }));
  CHECK_FALSE(opens([](ModelBuilder& b) { b.fields[1].scale[0] = 1e6f / 32000; }));
  CHECK_FALSE(opens([](ModelBuilder& b) { b.fields[1].offset[2] = 3e38f; }));
  CHECK_FALSE(opens([](ModelBuilder& b) { b.parameters[1].maximum = 1e7f; }));
  CHECK_FALSE(opens([](ModelBuilder& b) { b.parameters[1].sd = 1e-30f; }));
  CHECK_FALSE(opens([](ModelBuilder& b) { b.cascade[2].pivot[0] = -1e30f; }));
  CHECK_FALSE(opens([](ModelBuilder& b) { b.fields[1].u1 = b.fields[1].u0 + 1e-7f; }));
}

TEST_CASE("a table has at most 4096 landmarks: indices and what is kept for each are bounded") {
  const auto opens_with = [](std::size_t landmarks) {
    return opens([&](ModelBuilder& b) {
      while (b.landmarks.size() < landmarks)
        b.landmark("extra" + std::to_string(b.landmarks.size()), 0.5f, 0.5f);
    });
  };
  CHECK(opens_with(4096));
  CHECK_FALSE(opens_with(4097));
}

TEST_CASE("a model that was never opened is refused where an object is made of it") {
  alignas(Arena::kAlignment) unsigned char block[4096];
  Arena arena(block, sizeof block);
  const Model closed;
  CHECK_FALSE(closed.is_open());
  CHECK_FALSE(closed.is_on_surface({0.5f, 0.5f}));
  CHECK(closed.find_parameter("jawOpen") == kNone);
  Cascade cascade;
  Fitter fitter;
  FoldOverTest fold_over;
  CHECK(create_in(arena, cascade, closed) == Status::bad_argument);
  CHECK(create_in(arena, fitter, closed, FitLimits{}) == Status::bad_argument);
  CHECK(create_in(arena, fold_over, closed) == Status::bad_argument);
  CHECK(arena.used_bytes() == 0);
}

}  // namespace model_test
