// `pliant render --grid`: people by expressions on one picture; and the people that come with the built-in face.
#include <doctest/doctest.h>

#include <algorithm>

#include "baked_face.hpp"
#include "cli_run.hpp"
#include "host/io/csv.hpp"
#include "host/io/fit_file.hpp"
#include "host/io/image.hpp"

namespace cli_grid_test {

using namespace cli_run;

namespace {

constexpr int kWidth = 60, kHeight = 80, kGap = 2;

/// The picture in one column and row of a grid.
Image cell(const Image& grid, int columns, int column, int rows, int row) {
  const int left = grid.width - columns * (kWidth + kGap) + column * (kWidth + kGap);
  const int top = grid.height - rows * (kHeight + kGap) + row * (kHeight + kGap);
  Image out(kWidth, kHeight, 1);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) *out.at(x, y) = grid.at(left + x, top + y)[0];
  return out;
}

/// Mean grey level where a picture is not paper.
double mean_face(const Image& image, int* pixels = nullptr) {
  double sum = 0;
  int count = 0;
  for (const std::uint8_t value : image.pixels)
    if (value < 230) sum += value, ++count;
  if (pixels != nullptr) *pixels = count;
  return sum / std::max(count, 1);
}

}  // namespace

TEST_CASE("a grid shows each person in a column and each expression in a row") {
  const Folder f;
  const std::string model = f.put("m.plm", model_bytes());
  const std::string people = f.put("people.csv", "name,width,tone\nwide,3,1\nnarrow,-3,1\nnarrow,-3,0.5\n");
  const std::string moods = f.put("moods.csv", "name,jawOpen,width\nrest,0,3\nopen,1,3\n");
  const Ran r = run_words(
      {"render", model, "--grid", f / "g.png", "--people", people, "--params", moods, "--size", "60x80"});
  CHECK(r.err == "");
  REQUIRE(r.code == 0);
  const Image grid = read_image(f / "g.png");
  int wide = 0, narrow = 0;
  mean_face(cell(grid, 3, 0, 2, 0), &wide);
  const double bright = mean_face(cell(grid, 3, 1, 2, 0), &narrow), dark = mean_face(cell(grid, 3, 2, 2, 0));
  CHECK(narrow > 400);
  CHECK(wide > 1.1 * narrow);   // the identity is that of the people, whatever the expressions say
  CHECK(dark < 0.65 * bright);  // not half of it: the brightest surface is white
  for (int c = 0; c < 3; ++c) CHECK(cell(grid, 3, c, 2, 0).pixels != cell(grid, 3, c, 2, 1).pixels);
}

TEST_CASE("an empty cell of a grid's tables is neutral, and nothing of the row above") {
  const Folder f;
  const std::string model = f.put("m.plm", model_bytes());
  const auto grid = [&](const char* person, const char* mood) {
    const std::string people =
        f.put("people.csv", "name,width,tone\nwide,3,1\nmean," + std::string(person) + "\n");
    const std::string moods =
        f.put("moods.csv", "name,jawOpen,qw,qy\nopen,1,0.8,0.6\nrest," + std::string(mood) + "\n");
    const Ran r = run_words(
        {"render", model, "--grid", f / "g.png", "--people", people, "--params", moods, "--size", "60x80"});
    CAPTURE(r.err);
    REQUIRE(r.code == 0);
    return read_image(f / "g.png").pixels;
  };
  CHECK(grid(",", ",,") == grid("0,1", "0,1,0"));
}

TEST_CASE("grid says which parameters it clamps") {
  const Folder f;
  const std::string model = f.put("m.plm", model_bytes()),
                    people = f.put("people.csv", "name,width\nmean,0\n"),
                    moods = f.put("moods.csv", "name,jawOpen\nopen,9\n");
  const Ran r = run_words({"render", model, "--grid", f / "g.png", "--people", people, "--params", moods});
  CHECK(r.code == 0);
  CHECK(contains(r.err, "moods.csv"));
  CHECK(contains(r.err, "jawOpen"));
}

TEST_CASE("grid refuses bad words with 2 and bad input with 1 and a line that names it") {
  const Folder f;
  const std::string model = f.put("m.plm", model_bytes());
  const std::string rows = f.put("rows.csv", "name,jawOpen\na,0\n");
  const auto words = [&](const std::string& people, const std::string& moods) {
    return std::vector<std::string>{"render",   model,  "--grid",   f / "g.png",
                                    "--people", people, "--params", moods};
  };
  CHECK(run_words({"render", model, "--grid", f / "g.png", "--params", rows}).code == 2);
  CHECK(run_words({"render", model, "--people", rows, "--params", rows, "-o", f / "v.y4m"}).code == 2);
  auto more = words(rows, rows);
  more.insert(more.end(), {"-o", f / "v.y4m"});
  CHECK(run_words(more).code == 2);
  check_refused(words(f / "none.csv", rows), {"none.csv", "No such file"});
  check_refused(words(rows, f.put("n.csv", "jawOpen\n1\n")), {"n.csv", "'name'"});
  check_refused(words(f.put("e.csv", "name\n"), rows), {"e.csv", "no rows"});
  check_refused(words(rows, f.put("bad.csv", "name,jawOpen\na,wide\n")), {"bad.csv: line 2", "jawOpen"});
  CHECK_FALSE(f.has("g.png"));
  const Ran r = run_words(words(f.put("u.csv", "name,hair\na,1\n"), rows));
  CHECK(r.code == 0);
  CHECK(contains(r.err, "no parameter hair"));
}

TEST_CASE("the built-in face has seven people and five expressions, and their parameters exist") {
  const Model& model = baked_face().model;
  for (const char* name : {"people", "expressions"}) {
    CAPTURE(name);
    const std::string path = std::string(PLIANT_FIXTURES "/people/") + name + ".csv";
    const CsvTable table(path, read_file(path));
    CHECK(table.row_count() == (std::string(name) == "people" ? 7 : 5));
    for (std::size_t c = 0; c < table.columns().size(); ++c) {
      const std::string& column = table.columns()[c];
      const auto parameters = parameters_named(model, column);
      const bool is_other = column == "name" || column == "tone" || column[0] == 'q';
      CAPTURE(column);
      CHECK((is_other || !parameters.empty()));
      for (const std::uint16_t k : parameters)
        for (std::size_t row = 0; row < table.row_count(); ++row) {
          CHECK(table.number(row, c) >= model.parameters()[k].minimum);
          CHECK(table.number(row, c) <= model.parameters()[k].maximum);
        }
    }
  }
}

}  // namespace cli_grid_test
