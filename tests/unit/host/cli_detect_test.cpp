// `pliant detect` and `pliant learn` as a user runs them, without learnt tables.
#include "cli_run.hpp"
#include "host/io/image.hpp"
#include "host/io/learnt_file.hpp"

using namespace pliant::host;
using namespace cli_run;

namespace {

std::string picture(const Folder& folder, const char* name, int width, int height) {
  return folder.put(name, encode_png(Image(width, height, 1, 90)));
}

}  // namespace

TEST_CASE("detect refuses a model without learnt tables, and damaged tables, by the model's name") {
  const Folder folder;
  const std::string model = folder.put("m.plm", model_bytes()), image = picture(folder, "p.png", 64, 64);
  check_refused({"detect", model, "--image", image}, {"m.plm", "no learnt tables"});
  const std::string learnt = folder.put("l.bin", format_learnt({{1, 2, 3, 4}, {5, 6, 7, 8}}));
  const std::string face = folder / "f.plm";
  REQUIRE(run_words({"bake", PLIANT_FIXTURES "/face", "-o", face, "--size", "16", "--learnt", learnt}).code ==
          0);
  check_refused({"detect", face, "--image", image}, {"f.plm"});
}

TEST_CASE("learn refuses folders without pictures, and a part that there is not") {
  const Folder folder;
  const std::string model = folder.put("m.plm", model_bytes());
  const std::string landmarks = folder.put("landmarks.csv", "name,landmark,x,y\n");
  check_refused({"learn", model, "--faces", folder / "none", "--others", folder / "", "-o", folder / "l.bin"},
                {"landmarks.csv"});
  CHECK(run_words({"learn", model, "--faces", folder / "", "--others", folder / "", "-o", folder / "l.bin",
                   "--only", "eyes"})
            .code == 2);
  check_refused({"learn", model, "--faces", folder / "", "--others", folder / "", "-o", folder / "l.bin",
                 "--only", "detector"},
                {"l.bin"});
  CHECK_FALSE(folder.has("l.bin"));
}
