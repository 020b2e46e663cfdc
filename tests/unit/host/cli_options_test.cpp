// Options of `pliant track` and `pliant bake` that do not fit each other, the model or the source.
#include <doctest/doctest.h>

#include "cli_run.hpp"
#include "host/io/image.hpp"

namespace cli_options_test {

using namespace pliant;
using namespace pliant::host;
using namespace cli_run;

TEST_CASE("options of a track that contradict each other, or have nothing to act on, are refused") {
  const Folder folder;
  const auto refused = [&](std::vector<std::string> more) {
    std::vector<std::string> words{"track", PLIANT_BAKED_FACE, "--frames", folder / "none.y4m",
                                   "--out", folder / "t.csv"};
    words.insert(words.end(), more.begin(), more.end());
    const Ran r = run_words(words);
    return r.code == 2 && contains(r.err, more[0]);
  };
  CHECK(refused({"--landmarks", "--model-landmarks"}));
  CHECK(refused({"--box-of", "opencv"}));
  CHECK(refused({"--marker-exclusion-px", "4"}));
  CHECK(refused({"--cues", ""}));
  CHECK(refused({"--cues", "patches"}));
  for (const char* cues :
       {"flow", "flow,edge", "edge,flow", "patch,", ",patch", "patch,,flow", "patch,patch"})
    CHECK(refused({"--cues", cues}));
  for (const char* cues : {"edge", "patch,edge", "patch,flow", "patch,flow,edge"}) {
    CHECK(refused({"--cues", cues, "--profile", "s"}));
    CHECK_FALSE(refused({"--cues", cues}));
  }
  CHECK_FALSE(refused({"--cues", "patch", "--profile", "s"}));
  CHECK(refused({"--mesh-operations", "4", "--profile", "s"}));
  CHECK_FALSE(refused({"--mesh-operations", "0", "--profile", "s"}));
  CHECK_FALSE(refused({"--mesh-operations", "4", "--profile", "m"}));
}

TEST_CASE("a track by edges of a model that has no curves says so") {
  const Sequence s;
  const ModelFile file(s.model);
  REQUIRE(file.model().curves().count == 0);
  const struct {
    const char *cues, *said;
  } cases[] = {
      {"edge", ": its only edge is its silhouette, which a flat surface lacks; patch finds its texture\n"},
      {"patch,edge", ": its only edge is its silhouette, which a flat surface lacks\n"},
      {"patch", ""}};
  for (const auto& c : cases) {
    CAPTURE(c.cues);
    auto words = s.track_words();
    words.insert(words.end(), {"--count", "2", "--cues", c.cues});
    const Ran r = run_words(words);
    CHECK(r.code == 0);
    CHECK(r.err == (*c.said == '\0' ? "" : "--cues: " + s.model + " has no curves" + c.said));
  }
  auto words = s.track_words();
  words[1] = PLIANT_BAKED_FACE;
  words.insert(words.end(), {"--count", "2", "--cues", "patch,edge"});
  CHECK_FALSE(contains(run_words(words).err, "--cues"));
}

TEST_CASE("a box that is smaller than a pixel, or beyond a million, is refused as such") {
  const Sequence s;
  const std::string picture = s / "picture.png";
  write_file(picture, encode_png(Image(64, 64, 1, 128)));
  for (const char* box :
       {"0,0,1e30,1e30", "-1e7,0,9,9", "9,9,1e-30,1e-30", "9,9,0.5,9", "9,9,9,-9", "9,9,0,0"}) {
    CAPTURE(box);
    const std::vector<std::vector<std::string>> commands{
        {"track", s.model, "--frames", s.video, "--out", s / "t.csv", "--box", box},
        {"fit", s.model, "--image", picture, "-o", s / "f.json", "--box", box},
        {"points", s.model, "--image", picture, "-o", s / "p.html", "--start", box}};
    for (const auto& words : commands) {
      const Ran r = run_words(words);
      CHECK(r.code == 2);
      CHECK(contains(r.err, words[6] + ": "));
      CHECK(contains(r.err, std::string(": ") + box + "\n"));
    }
  }
}

TEST_CASE("an operand that is empty is bad usage, as where a variable of a script is empty") {
  for (const auto& words : {std::vector<std::string>{"info", ""}, {"bake", "", "-o", "x.plm"}}) {
    const Ran r = run_words(words);
    CHECK(r.code == 2);
    CHECK(contains(r.err, ": an operand is empty\n"));
  }
}

TEST_CASE("a focal length that hardly a camera has is told of, in one line") {
  const Sequence s;
  const struct {
    const char *focal, *said;
  } cases[] = {{"4", "--focal 4 is implausibly short for pictures of 200x160 pixels"},
               {"40000", "--focal 40000 is implausibly long for pictures of 200x160 pixels"},
               {"60", ""},
               {"3000", ""}};
  for (const auto& c : cases) {
    CAPTURE(c.focal);
    auto words = s.track_words();
    words.back() = c.focal;
    words.insert(words.end(), {"--count", "1"});
    const Ran track = run_words(words);
    const Ran fit = run_words(
        {"fit", s.model, "--points", s.points, "--size", "200x160", "--focal", c.focal, "-o", s / "f.json"});
    const Ran found = run_words({"track", PLIANT_DETECTING_FACE, "--frames", s.video, "--count", "1",
                                 "--focal", c.focal, "--out", s / "t.csv"});
    for (const Ran& r : {track, fit, found}) {
      CAPTURE(r.err);
      CHECK(contains(r.err, "implausibly") == (*c.said != '\0'));
      CHECK(contains(r.err, c.said));
    }
  }
}

TEST_CASE(
    "bake refuses a choice of parameters that the source has none of, and a list with an empty name or one "
    "twice") {
  const Folder folder;
  const std::string sheet = PLIANT_FIXTURES "/sheet", table = folder / "x.plm";
  const auto with = [&](const char* option, const char* value) {
    return std::vector<std::string>{"bake", sheet, "-o", table, "--size", "16", option, value};
  };
  check_refused(with("--identities", "3"), {"--identities: " + sheet + " has no identities"});
  for (const char* expressions : {"3", "jawOpen"})
    check_refused(with("--expressions", expressions), {"--expressions: " + sheet + " has no expressions"});
  for (const char* list : {"", "a,", ",a", "a,,b", "a,a", "a,b,a", "3,"}) {
    CAPTURE(list);
    const Ran r = run_words(with("--expressions", list));
    CHECK(r.code == 2);
    CHECK(contains(r.err, "--expressions: "));
  }
  CHECK_FALSE(folder.has("x.plm"));
  CHECK(run_words(with("--identities", "0")).code == 0);
  CHECK(run_words(with("--stretch", "0.00009")).code == 2);
  CHECK(run_words(with("--stretch", "0.0001")).code == 0);
  auto bending = with("--expressions", "1");
  bending.insert(bending.end(), {"--modes", "2"});
  CHECK(run_words(bending).code == 0);
}

}  // namespace cli_options_test
