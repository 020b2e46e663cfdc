// The counters of commands.
#include <doctest/doctest.h>

#include <sstream>

#include "host/commands/command.hpp"

namespace progress_test {

using namespace pliant::host;

TEST_CASE("each stage has a counter of its own, also one that begins again or with another end") {
  std::ostringstream out, err;
  Console console{out, err, true};
  {
    StageProgress progress(console);
    progress.show("files", 1, 2);
    progress.show("files", 2, 2);
    progress.show("shapes", 1, 3);
    progress.show("shapes", 3, 3);
    progress.show("shapes", 1, 3);
    progress.show("shapes", 2, 5);
    progress.finish();
    progress.show("shapes", 4, 5);
  }
  const std::string end = "\x1b[K";
  CHECK(err.str() == "\rfiles 1 of 2" + end + "\rfiles 2 of 2" + end + "\n\rshapes 1 of 3" + end +
                         "\rshapes 3 of 3" + end + "\n\rshapes 1 of 3" + end + "\n\rshapes 2 of 5" + end +
                         "\n\rshapes 4 of 5" + end + "\n");
  CHECK(out.str().empty());
}

TEST_CASE("without a terminal there is no counter") {
  std::ostringstream out, err;
  Console console{out, err, false};
  { StageProgress(console).show("files", 1, 2); }
  CHECK(err.str().empty());
}

}  // namespace progress_test
