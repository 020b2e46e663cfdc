// ARKit's coefficients: every name once, in order, in range, and from the parameter that means the same.
#include "host/io/arkit.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <set>
#include <sstream>

#include "cli_run.hpp"
#include "host/bake/arkit_names.hpp"
#include "host/io/csv.hpp"

namespace arkit_test {

using namespace pliant;
using namespace pliant::host;
using namespace cli_run;

namespace {

std::size_t column_of(const std::string& name) {
  for (std::size_t k = 0; k < kArkitCount; ++k)
    if (name == kArkitNames[k]) return k;
  FAIL("no coefficient " << name);
  return 0;
}

/// The built-in face with one parameter moved.
struct Face {
  ModelFile file{PLIANT_BAKED_FACE};
  ArkitExpression arkit{file.model()};
  std::vector<float> q = std::vector<float>(file.model().parameters().count, 0.0f);

  const Parameter& parameter(const char* name) const {
    const std::uint16_t k = file.model().find_parameter(name);
    REQUIRE(k != kNone);
    return file.model().parameters()[k];
  }
  float& value(const char* name) { return q[file.model().find_parameter(name)]; }
  float coefficient(const char* name) const { return arkit.coefficients(q)[column_of(name)]; }
};

}  // namespace

TEST_CASE("every name of ARKit's is there once, in the order of its documentation") {
  const std::set<std::string> names(kArkitNames.begin(), kArkitNames.end());
  CHECK(names.size() == 52);
  for (const std::string& name : names) {
    CAPTURE(name);
    CHECK(bake::usefulness_rank(name) < bake::usefulness_rank("noNameOfTheirs"));
  }
  const char* const in_order[] = {"eyeBlinkLeft", "eyeBlinkRight", "jawForward", "jawOpen",
                                  "mouthClose",   "browDownLeft",  "cheekPuff",  "tongueOut"};
  const std::size_t at[] = {0, 7, 14, 17, 18, 41, 46, 51};
  for (std::size_t k = 0; k < std::size(at); ++k) CHECK(std::string(kArkitNames[at[k]]) == in_order[k]);
}

TEST_CASE("each expression of the built-in face drives the coefficient of its name, and no other") {
  Face f;
  std::size_t columns = 0;
  for (std::size_t k = 0; k < kArkitCount; ++k) {
    const std::uint16_t p = f.file.model().find_parameter(kArkitNames[k]);
    if (p == kNone) continue;
    CAPTURE(kArkitNames[k]);
    ++columns;
    f.q.assign(f.q.size(), 0.0f);
    f.q[p] = 0.25f * f.file.model().parameters()[p].maximum;
    const auto c = f.arkit.coefficients(f.q);
    for (std::size_t j = 0; j < kArkitCount; ++j)
      CHECK(c[j] == (j == k ? doctest::Approx(0.25) : doctest::Approx(0)));
  }
  CHECK(columns == 34);
  CHECK(f.arkit.absent().size() == 52 - 34 - 2);  // two more from pairs
  CHECK(f.arkit.left_out().empty());
}

TEST_CASE("coefficients run from 0 at rest to 1 at the maximum, and pairs have the mean of both sides") {
  Face f;
  for (const float c : f.arkit.coefficients(f.q)) CHECK(c == 0);
  REQUIRE(f.parameter("jawOpen").maximum < 0.5f);
  f.value("jawOpen") = f.parameter("jawOpen").maximum;
  CHECK(f.coefficient("jawOpen") == 1);
  f.value("browInnerUpLeft") = 0.6f;
  CHECK(f.coefficient("browInnerUp") == doctest::Approx(0.3));
  f.value("browInnerUpRight") = 0.2f;
  CHECK(f.coefficient("browInnerUp") == doctest::Approx(0.4));
  f.value("faceWidth") = 3;  // identity has no coefficient
  for (std::size_t k = 0; k < f.q.size(); ++k) f.q[k] = k % 2 == 0 ? 100.0f : -100.0f;
  for (const float c : f.arkit.coefficients(f.q)) CHECK((c >= 0 && c <= 1));
}

TEST_CASE("the gaze drives both eyes of its side, and nothing else") {
  const Face f;
  const auto at = [&](float left, float up, const char* name) {
    return f.arkit.coefficients(
        f.q, {std::sin(left) * std::cos(up), std::sin(up), std::cos(left) * std::cos(up)})[column_of(name)];
  };
  CHECK(at(0.3f, 0, "eyeLookOutLeft") == doctest::Approx(0.5));
  CHECK(at(0.3f, 0, "eyeLookInRight") == doctest::Approx(0.5));
  CHECK(at(-0.3f, 0, "eyeLookInLeft") == doctest::Approx(0.5));
  CHECK(at(-0.3f, 0, "eyeLookOutRight") == doctest::Approx(0.5));
  CHECK(at(0.2f, 0.225f, "eyeLookUpLeft") == doctest::Approx(0.5));
  CHECK(at(0.2f, -0.225f, "eyeLookDownRight") == doctest::Approx(0.5));
  CHECK(at(-1.2f, 1, "eyeLookInLeft") == 1);
  CHECK(at(-1.2f, 1, "eyeLookUpRight") == 1);
  for (const char* name :
       {"eyeLookOutLeft", "eyeLookInRight", "eyeLookDownLeft", "eyeLookDownRight", "jawOpen"})
    CHECK(at(-0.4f, 0.2f, name) == 0);
  for (const float c : f.arkit.coefficients(f.q)) CHECK(c == 0);  // not seen
}

TEST_CASE("names that a model lacks are 0 and listed, and so are expressions that ARKit lacks") {
  const Sequence s;
  const ModelFile file(s.model);
  const ArkitExpression arkit(file.model());
  CHECK(arkit.absent().size() == 51);
  CHECK(arkit.left_out() == std::vector<std::string>{"browUpLeft", "browUpRight"});
  auto words = s.track_words();
  words.push_back("--arkit");
  const Ran r = run_words(words);
  REQUIRE(r.code == 0);
  CHECK(contains(r.err, "always 0: eyeBlinkLeft"));
  CHECK(contains(r.err, "not ARKit's: browUpLeft browUpRight"));
  const CsvTable table(s / "t.csv", read_file(s / "t.csv"));
  REQUIRE(table.columns().size() == 17 + 52);
  for (std::size_t k = 0; k < kArkitCount; ++k) CHECK(table.columns()[17 + k] == kArkitNames[k]);
  const auto plain_words = s.track_words();
  REQUIRE(run_words(plain_words).code == 0);
  const CsvTable plain(s / "t.csv", read_file(s / "t.csv"));
  const std::uint16_t jaw = file.model().find_parameter("jawOpen");
  const float maximum = file.model().parameters()[jaw].maximum;
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    CHECK(table.number(row, table.column("mouthClose")) == 0);
    CHECK(table.number(row, table.column("jawOpen")) ==
          doctest::Approx(double(plain.number(row, plain.column("jawOpen")) / maximum)).epsilon(1e-4));
  }
}

TEST_CASE("a model without any expression of ARKit's is refused by name") {
  const Sequence s;
  TexturedModel other;
  other.with_expressions = false;
  const auto bytes = other.bytes();
  auto words = s.track_words();
  words[1] = s.put("other.plm", {bytes.begin(), bytes.end()});
  words.push_back("--arkit");
  check_refused(words, {"other.plm", "ARKit"});
  CHECK_FALSE(s.has("t.csv"));
}

}  // namespace arkit_test
