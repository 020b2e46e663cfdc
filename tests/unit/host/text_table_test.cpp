// Tables of text, and one line for every defect of them.
#include "host/bake/text_table.hpp"

#include <doctest/doctest.h>

#include <functional>

#include "host/bake/source_error.hpp"
#include "scratch_folder.hpp"

namespace text_table_test {

using namespace pliant;
using namespace pliant::host::bake;

namespace {

/// What goes wrong, or "" when nothing does.
std::string error_of(const std::function<void()>& action) {
  try {
    action();
    return "";
  } catch (const SourceError& e) {
    return e.what();
  }
}

}  // namespace

TEST_CASE(
    "a text table gives its rows by line, without comments, and takes the rest of a line in an open column") {
  const Folder folder("text");
  const auto path =
      folder.put("a.txt", "# units: mm\nname  x more...\n\nfirst 1.5 a b # c\n  second -2 d\n");
  const TextTable table(path, {"name", "x", "more..."});
  REQUIRE(table.rows().size() == 2);
  CHECK(table.rows()[0].line == 4);
  CHECK(table.number(table.rows()[0], 1) == 1.5f);
  CHECK(table.words(table.rows()[0], 2) == std::vector<std::string>{"a", "b"});
  CHECK(table.rows()[1].cells[0] == "second");
}

TEST_CASE("each defect of a text table is one line that names the file and the line") {
  const Folder folder("defects");
  const auto path = (folder.path / "a.txt").string();
  const auto error = [&](const std::string& text) {
    folder.put("a.txt", text);
    return error_of([&] {
      const TextTable table(path, {"name", "x"});
      for (const TextRow& row : table.rows()) table.number(row, 1);
    });
  };
  CHECK(error("name x\na 1\n") == "");
  CHECK(error("\xef\xbb\xbfname x\r\na 1\r\n") == "");
  CHECK(error("# a comment\rname x\ra 1\r") == "");  // a carriage return alone ends lines, too
  CHECK(error("name x\r\ra 1\r\nb\r") == path + ":4: no value for column 'x'");
  CHECK(error("name x\r\r\na 1\r\r\nb\r\r\n") == path + ":3: no value for column 'x'");  // as text twice
  CHECK(error("") == path + ": has no table");
  CHECK(error("name\na 1\n") == path + ":1: expected a column 'x'");
  CHECK(error("name,x\na,1\n") ==
        path + ":1: expected a column 'name': blanks are between columns, not commas");
  CHECK(error("name x y\na 1 2\n") == path + ":1: unknown column 'y'");
  CHECK(error("name x\n\na\n") == path + ":3: no value for column 'x'");
  CHECK(error("name x\na 1 2\n") == path + ":2: '2' is one value too many");
  CHECK(error("name x\na nan\n") == path + ":2: 'nan' in column 'x' is not a number");
  CHECK(error("name x\na inf\n") == path + ":2: 'inf' in column 'x' is not a number");
  CHECK(error("name x\na +1e-60\n") == "");
  CHECK(error("name x\na 0x10\n") == path + ":2: '0x10' in column 'x' is not a number");
  CHECK(error("name x\na 1,5\n") == path + ":2: '1,5' in column 'x' is not a number");
  CHECK(error_of([&] { TextTable(path + "x", {"name"}); }) == path + "x: cannot be read");
  CHECK(error_of([&] { TextTable(folder.path.string(), {"name"}); }) ==
        folder.path.string() + ": cannot be read");
}

}  // namespace text_table_test
