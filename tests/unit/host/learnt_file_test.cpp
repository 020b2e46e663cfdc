// The file of learnt tables, and its way into a model table.
#include "host/io/learnt_file.hpp"

#include <doctest/doctest.h>

#include "cli_run.hpp"
#include "host/io/failure.hpp"

namespace learnt_file_test {

using namespace pliant;
using namespace pliant::host;
using namespace cli_run;

namespace {

const std::string kFace = PLIANT_FIXTURES "/face";

LearntTables some_tables() {
  return {{1, 2, 3, 4, 5}, {9, 8, 7}, {6, 5, 4, 3}};
}

std::vector<std::uint8_t> bytes_of(Span<const std::uint8_t> table) {
  return {table.begin(), table.end()};
}

}  // namespace

TEST_CASE("a learnt file gives back all tables, or the one that it has") {
  const Folder folder;
  const LearntTables both = read_learnt(folder.put("both.bin", format_learnt(some_tables())));
  CHECK(both.detector == some_tables().detector);
  CHECK(both.aligner == some_tables().aligner);
  CHECK(both.parts == some_tables().parts);
  const LearntTables one = read_learnt(folder.put("one.bin", format_learnt({{}, {7}, {}})));
  CHECK(one.detector.empty());
  CHECK(one.aligner == std::vector<std::uint8_t>{7});
}

TEST_CASE("a learnt file that is cut, longer, or has a flipped bit is refused with its name") {
  const Folder folder;
  const std::string good = format_learnt(some_tables());
  for (std::size_t bytes = 0; bytes < good.size(); ++bytes) {
    const std::string path = folder.put("cut.bin", good.substr(0, bytes));
    CHECK_THROWS_WITH_AS(read_learnt(path), doctest::Contains("cut.bin: is"), Failure);
  }
  CHECK_THROWS_WITH_AS(read_learnt(folder.put("long.bin", good + "x")),
                       doctest::Contains("long.bin: has bytes"), Failure);
  for (std::size_t bit = 0; bit < good.size() * 8; ++bit) {
    std::string bad = good;
    bad[bit / 8] = static_cast<char>(bad[bit / 8] ^ (1 << bit % 8));
    CHECK_THROWS_AS(read_learnt(folder.put("bad.bin", bad)), Failure);
  }
  CHECK_THROWS_AS(read_learnt(folder / "missing.bin"), Failure);
}

TEST_CASE("bake puts learnt tables into the model, and info prints their bytes") {
  const Folder folder;
  const std::string learnt = folder.put("l.bin", format_learnt(some_tables())), table = folder / "m.plm";
  REQUIRE(run_words({"bake", kFace, "-o", table, "--size", "16", "--learnt", learnt}).code == 0);
  const ModelFile file(table);
  CHECK(bytes_of(file.model().detector()) == some_tables().detector);
  CHECK(bytes_of(file.model().aligner()) == some_tables().aligner);
  CHECK(bytes_of(file.model().parts()) == some_tables().parts);
  CHECK(reinterpret_cast<std::uintptr_t>(file.model().aligner().data) % 4 == 0);
  const Ran r = run_words({"info", table});
  CHECK(contains(r.out, "  detector                       5\n"));
  CHECK(contains(r.out, "  aligner                        3\n"));
  REQUIRE(run_words({"bake", kFace, "-o", table, "--size", "16", "--learnt", "none"}).code == 0);
  const ModelFile without(table);
  CHECK(without.model().detector().empty());
  CHECK(without.model().aligner().empty());
}

TEST_CASE("bake refuses a bad learnt file by name, and a source's own learnt.bin is found") {
  const Folder folder;
  const std::string bad = folder.put("bad.bin", "no tables");
  check_refused({"bake", kFace, "-o", folder / "m.plm", "--learnt", bad},
                {"bad.bin", "no file of learnt tables"});
  const std::string source = folder / "face";
  fs::copy(kFace, source);
  folder.put("face/learnt.bin", format_learnt({{1, 2}, {}, {}}));
  REQUIRE(run_words({"bake", source, "-o", folder / "m.plm", "--size", "16"}).code == 0);
  const ModelFile file(folder / "m.plm");
  CHECK(file.model().detector().count == 2);
  CHECK(file.model().aligner().empty());
}

}  // namespace learnt_file_test
