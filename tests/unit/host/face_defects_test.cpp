// One line that names file and line for every defect of the built-in face's tables, and of options.
#include <doctest/doctest.h>

#include <fstream>
#include <functional>
#include <sstream>

#include "host/bake/bake.hpp"
#include "scratch_folder.hpp"

namespace face_defects_test {

using namespace pliant;
using namespace pliant::host::bake;

namespace fs = std::filesystem;

namespace {

/// The face's own tables with one file changed by an edit.
std::string error_after(const std::string& file, const std::function<std::string(std::string)>& edit) {
  const Folder folder("face");
  for (const auto& entry : fs::directory_iterator(PLIANT_FIXTURES "/face"))
    fs::copy(entry.path(), folder.path / entry.path().filename());
  std::ifstream in(folder.path / file);
  std::stringstream text;
  text << in.rdbuf();
  in.close();
  const std::string changed = edit(text.str());
  if (changed == text.str()) return "the edit of " + file + " changed nothing";
  fs::remove(folder.path / file);
  if (!changed.empty()) folder.put(file, changed);
  BakeOptions options;
  options.source = folder.path.string();
  options.size = 16;
  std::vector<std::uint8_t> table{1, 2, 3};
  std::string error;
  const bool baked = host::bake::bake(options, table, error);
  CHECK(baked == error.empty());
  if (!baked) CHECK(table == std::vector<std::uint8_t>{1, 2, 3});
  CHECK(error.find('\n') == std::string::npos);
  const std::size_t start = error.find(file);
  return start == std::string::npos ? error : error.substr(start);
}

/// The first `from` becomes `to`.
std::function<std::string(std::string)> swap(const std::string& from, const std::string& to) {
  return [=](std::string text) {
    const std::size_t at = text.find(from);
    return at == std::string::npos ? text : text.replace(at, from.size(), to);
  };
}

bool is_at_line(const std::string& error, const std::string& file, const std::string& what) {
  const std::string start = file + ":";
  return error.compare(0, start.size(), start) == 0 &&
         std::isdigit(static_cast<unsigned char>(error[start.size()])) &&
         error.find(what) != std::string::npos;
}

}  // namespace

TEST_CASE(
    "each defect of a face's tables is one line that names file and line, and the table stays as it was") {
  struct Defect {
    const char *file, *from, *to, *what;
  };
  const Defect defects[] = {
      {"points.txt", "      u       v", "      u", "expected a column 'v'"},
      {"points.txt", "16.00", "nan", "'nan' in column 'x' is not a number"},
      {"points.txt", "lid_margin.1 ", "lid_margin.0 ", "appears twice"},
      {"points.txt", "   16.00", "  -16.00", "not in the left half"},
      {"patches.txt", "orbit.2-15", "orbit.2-16", "unknown point 'orbit.16'"},
      {"patches.txt", "orbit.2-15", "orbit.2-x", "is not a range of points"},
      {"patches.txt", "orbit.2-15", "orbit.2-14", "not as long as the last"},
      {"patches.txt", "eye surface", "eye bone", "neither surface nor hole"},
      {"parameters.txt", "identity   no", "person     no", "neither identity nor expression"},
      {"parameters.txt", "identity   no", "identity   maybe", "sided is yes or no"},
      {"parameters.txt", "faceDepth", "faceWidth", "appears twice"},
      {"parameters.txt", "-3      3       1", "1       3       1", "needs minimum <= 0 <= maximum"},
      {"groups.txt", "lip_line.0-6", "lip_line.0-66", "unknown point"},
      {"followers.txt", "ball_1.0-15", "ball_1.0-14", "not as many leaders as points"},
      {"hinges.txt", "1      0      0 ", "1      1      0 ", "the axis is not a unit vector"},
      {"identity.txt", "faceWidth       stretch", "faceWidht       stretch", "unknown parameter 'faceWidht'"},
      {"identity.txt", "faceWidth       stretch", "faceWidth       twist", "kind 'twist' is none of"},
      {"identity.txt", "m_nasion", "m_nasian", "unknown point 'm_nasian'"},
      {"identity.txt", "1000   all", "1000   everyone", "unknown group 'everyone'"},
      {"identity.txt", " 1000 ", " -1 ", "a radius is not negative"},
      {"expressions.txt", "lip_line.9-12", "lip_line.9-12,", "unknown point ''"},
      {"landmarks.txt", "jaw.12", "jaw.11-12", "more than one point"},
      {"landmarks.txt", "jaw.12 ", "jaw.99 ", "unknown point 'jaw.99'"},
      {"curves.txt", " lid ", " lit ", "kind 'lit' is none of"},
      {"curves.txt", "orbit.2-6", "orbit.2", "a curve has at least two points"},
      {"paint.txt", "fill  all", "fell  all", "unknown layer 'fell'"},
      {"paint.txt", "fill  all", "fill  ears", "unknown region 'ears'"},
      {"paint.txt", "orbit.2-6,orbit.7", "orbit.2", "hairs need a line"},
      {"paint.txt", " 900 ", " 9e30 ", "the amount is not from 0 to 100000"},
      {"paint.txt", " 188 ", " 3e38 ", "the tone is not from 0 to 255"},
      {"paint.txt", " 0.5 ", " 1e9 ", "the amount is not from 0 to 1"},
      {"landmarks.txt", "0.45", "20", "the fraction is not from 0 to 1"},
      {"landmarks.txt", "0.45", "-0.1", "the fraction is not from 0 to 1"},
      {"followers.txt", "lid_margin.0-15   1", "lid_margin.0-15   99", "the fraction is not from -10 to 10"},
      {"paint.txt", " 6.5 ", " 1e30 ", "the length is not from 0 to 1000"},
      {"points.txt", "16.00", "1e30", "more than 10 m from the origin"},
      {"parameters.txt", "faceDepth", "faceDepthThatHasAMuchTooLongName", "is longer than 27 letters"},
      {"landmarks.txt", "\nibug00", "\nibug00ThatHasAMuchTooLongName", "is longer than 27 letters"},
      {"curves.txt", "lid_upper_left", "lid_upper_left_with_a_long_name", "is longer than 27 letters"},
  };
  for (const Defect& d : defects) {
    const std::string error = error_after(d.file, swap(d.from, d.to));
    CHECK_MESSAGE(is_at_line(error, d.file, d.what), (std::string(d.what) + " expected, got: " + error));
  }
}

TEST_CASE("a missing file or row gives one line that names the file") {
  const auto remove = [](const std::string&) { return std::string(); };
  for (const char* file : {"patches.txt", "parameters.txt", "groups.txt", "followers.txt", "hinges.txt",
                           "identity.txt", "expressions.txt", "landmarks.txt", "curves.txt", "paint.txt"})
    CHECK(error_after(file, remove) == std::string(file) + ": cannot be read");
  CHECK(error_after("points.txt", remove) == "points.txt and others) nor OBJ files");
  CHECK(error_after("hinges.txt", swap("jawOpen ", "jawShut ")) ==
        "hinges.txt: no row for parameter 'jawOpen'");
  CHECK(error_after("identity.txt", swap("\nfaceWidth ", "\n#faceWidth ")) ==
        "identity.txt: no row for parameter 'faceWidth'");
  CHECK(error_after("points.txt", swap("\nring_c.4 ", "\nlonely 30 40 10 0.9 0.9\nring_c.4 ")) ==
        "points.txt: point 'lonely' belongs to no patch");
  const std::string twice = error_after("landmarks.txt", swap("\nibug01", "\nibug00"));
  CHECK_MESSAGE(twice.find("the landmark 'ibug00' appears twice") != std::string::npos, twice);
  const std::string thrown =
      error_after("expressions.txt", swap("\njawOpen", "\njawOpen shift m_nasion 30 all 0 -1e30 0\njawOpen"));
  CHECK_MESSAGE(thrown.find("the parameter 'jawOpen' moves a vertex by more than 200 m") != std::string::npos,
                thrown);
  // A point dragged across its neighbours makes the chart fold over.
  const std::string folded = error_after("points.txt", [](std::string text) {
    const std::size_t row = text.find("ring_c.4 "), end = text.find('\n', row);
    return text.replace(row, end - row, "ring_c.4 34 43 13 0.95 0.9");
  });
  CHECK_MESSAGE(folded.find("points.txt: the chart (u,v) has a fold-over near point '") == 0, folded);
}

TEST_CASE("impossible options are refused") {
  BakeOptions options;
  options.source = PLIANT_FIXTURES "/face";
  std::vector<std::uint8_t> table;
  std::string error;
  options.bits = 12;
  CHECK_FALSE(host::bake::bake(options, table, error));
  options.bits = 16;
  options.size = 8;
  CHECK_FALSE(host::bake::bake(options, table, error));
  CHECK(table.empty());
}

}  // namespace face_defects_test
