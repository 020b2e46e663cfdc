// The pages that the command writes: what is in them, that they need nothing else, and what is refused. How they behave in a
// browser is tried by tests/pages.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <sstream>

#include "cli_run.hpp"
#include "host/io/csv.hpp"
#include "host/io/fit_file.hpp"
#include "host/io/image.hpp"
#include "host/io/json.hpp"
#include "host/io/page.hpp"
#include "host/render/svg_chart.hpp"

namespace cli_pages_test {

using namespace cli_run;

namespace {

/// The JSON that a page holds for its script.
Json data_of(const std::string& page) {
  const std::string open = "<script type=\"application/json\" id=\"data\">";
  const std::size_t at = page.find(open);
  REQUIRE(at != std::string::npos);
  const std::size_t first = at + open.size();
  return parse_json("page", page.substr(first, page.find("</script>", first) - first));
}

const Json& point(const Json& data, const std::string& name) {
  for (const Json& p : data.at("points"))
    if (p.at("name") == name) return p;
  FAIL("no point " << name);
  return data;
}

double number(const Json& of, const char* name) {
  return of.at(name).get<double>();
}

/// A page without the letters of its pictures, which may spell anything.
std::string without_pictures(std::string page) {
  const std::string open = ";base64,";
  for (std::size_t at = page.find(open); at != std::string::npos; at = page.find(open, at + open.size()))
    page.erase(at + open.size(), page.find('"', at) - at - open.size());
  return page;
}

std::string grey_pgm(int width, int height) {
  return "P5\n" + std::to_string(width) + " " + std::to_string(height) + "\n255\n" +
         std::string(static_cast<std::size_t>(width * height), '\x7f');
}

std::string address_bytes(const std::string& address) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  std::uint32_t group = 0;
  int bits = 0;
  for (std::size_t i = address.find(',') + 1; i < address.size() && address[i] != '='; ++i) {
    group = group << 6 | static_cast<std::uint32_t>(digits.find(address[i]));
    bits += 6;
    if (bits >= 8) out += static_cast<char>(group >> (bits -= 8) & 255u);
  }
  return out;
}

/// Every element that opens closes, in order; \return how many there were of each name.
std::map<std::string, int> check_well_formed(const std::string& page) {
  std::vector<std::string> open;
  std::map<std::string, int> count;
  const auto is_empty = [](const std::string& name) {
    return name == "meta" || name == "img" || name == "!DOCTYPE";
  };
  for (std::size_t at = page.find('<'); at != std::string::npos; at = page.find('<', at + 1)) {
    if (!open.empty() && open.back() == "style" && page.compare(at, 8, "</style>") != 0) continue;
    const std::size_t end = page.find('>', at);
    REQUIRE(end != std::string::npos);
    CHECK(page.find('<', at + 1) > end);
    const bool closes = page[at + 1] == '/';
    const std::size_t first = at + (closes ? 2 : 1);
    const std::string name = page.substr(first, page.find_first_of(" />\n", first) - first);
    if (closes) {
      REQUIRE(!open.empty());
      CHECK(open.back() == name);
      open.pop_back();
      continue;
    }
    ++count[name];
    if (page[end - 1] != '/' && !is_empty(name)) open.push_back(name);
  }
  CHECK(open.empty());
  return count;
}

int count_of(const std::string& text, const std::string& part) {
  int count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

/// The d attribute of the line with this title.
std::string path_titled(const std::string& page, const std::string& title) {
  const std::size_t end = page.find("\"><title>" + title + "</title></path>");
  REQUIRE(end != std::string::npos);
  const std::size_t first = page.rfind("d=\"", end) + 3;
  return page.substr(first, end - first);
}

}  // namespace

TEST_CASE("the points page holds the picture and every landmark where the start has it") {
  const Sequence s;
  const std::string picture = s.put("a <b> & \"c\".pgm", grey_pgm(200, 160));
  REQUIRE(run_words({"fit", s.model, "--points", s.points, "--size", "200x160", "-o", s / "fit.json"}).code ==
          0);
  const Ran r =
      run_words({"points", s.model, "--image", picture, "--start", s / "fit.json", "-o", s / "p.html"});
  CHECK(r.err == "");
  REQUIRE(r.code == 0);
  const std::string page = read_file(s / "p.html");
  CHECK(contains(page, "<title>a &lt;b&gt; &amp; &quot;c&quot;.pgm: points</title>"));
  CHECK_FALSE(contains(page, "{{"));
  const Json data = data_of(page);
  CHECK(number(data, "width") == 200);
  CHECK(number(data, "height") == 160);
  CHECK(data.at("points").size() == 15);
  const FitFile fit = parse_fit("fit", read_file(s / "fit.json"));
  for (const FitPoint& p : fit.points) {
    CHECK(number(point(data, p.landmark), "x") ==
          doctest::Approx(static_cast<double>(p.x.x + p.residual.x)).epsilon(1e-4));
    CHECK(number(point(data, p.landmark), "y") ==
          doctest::Approx(static_cast<double>(p.x.y + p.residual.y)).epsilon(1e-4));
    CHECK(point(data, p.landmark).at("wanted").get<bool>());
    CHECK_FALSE(point(data, p.landmark).at("placed").get<bool>());
  }
  const std::string png = address_bytes(data.at("picture").get<std::string>());
  s.put("back.png", png);
  CHECK(read_image(s / "back.png").pixels == read_image(picture).pixels);
}

TEST_CASE("given points keep their positions, and only they are switched on") {
  const Sequence s;
  const std::string picture = s.put("g.pgm", grey_pgm(200, 160));
  const std::string given = s.put(
      "four.csv", "landmark,x,y\neye_right,40,50\neye_left,150,52\nmouth_left,120,99\nnose_tip,99,70\n");
  REQUIRE(run_words({"points", s.model, "--image", picture, "--start", given, "-o", s / "p.html"}).code == 0);
  const Json data = data_of(read_file(s / "p.html"));
  CHECK(number(point(data, "eye_right"), "x") == 40);
  CHECK(number(point(data, "mouth_left"), "y") == 99);
  int wanted = 0, placed = 0;
  for (const Json& p : data.at("points")) {
    wanted += p.at("wanted").get<bool>();
    placed += p.at("placed").get<bool>();
  }
  CHECK(wanted == 4);
  CHECK(placed == 4);
  // The page writes which of its points a person placed.
  const std::string saved = s.put("saved.csv",
                                  "landmark,x,y,placed\neye_right,40,50,1\neye_left,150,52,1\n"
                                  "mouth_left,120,99,0\nnose_tip,99,70,1\n");
  REQUIRE(run_words({"points", s.model, "--image", picture, "--start", saved, "-o", s / "p.html"}).code == 0);
  const Json again = data_of(read_file(s / "p.html"));
  CHECK(point(again, "nose_tip").at("placed").get<bool>());
  CHECK(point(again, "mouth_left").at("wanted").get<bool>());
  CHECK_FALSE(point(again, "mouth_left").at("placed").get<bool>());
  CHECK(number(point(again, "mouth_left"), "x") != 120);
  for (const char* start : {"20,10,120,130", ""}) {
    std::vector<std::string> words{"points", s.model, "--image", picture, "-o", s / "p.html"};
    if (*start != '\0') words.insert(words.end(), {"--start", start});
    REQUIRE(run_words(words).code == 0);
    const Json box = data_of(read_file(s / "p.html"));
    const double left = number(point(box, "eye_left"), "x"), right = number(point(box, "eye_right"), "x");
    CHECK(left > right + 10);  // the subject's left is on the picture's right
    CHECK(right > 0);
    CHECK(left < 200);
  }
}

TEST_CASE("the box of a start is that of pliant detect, or of whom --box-of names, as fit has it") {
  const Folder s;
  const std::string face = PLIANT_BAKED_FACE;
  const std::string picture = s.put("g.pgm", grey_pgm(200, 160)), box = "20,10,120,130";
  const auto eyes_px = [&](const std::string& start, const std::vector<std::string>& whose) {
    std::vector<std::string> words{"points", face, "--image", picture, "-o", s / "p.html", "--start", start};
    words.insert(words.end(), whose.begin(), whose.end());
    REQUIRE(run_words(words).code == 0);
    const Json data = data_of(read_file(s / "p.html"));
    return number(point(data, "eye_left"), "x") - number(point(data, "eye_right"), "x");
  };
  REQUIRE(run_words({"fit", face, "--box", box, "--box-of", "landmarks", "--size", "200x160", "-o", s / "f.json"})
              .code == 0);
  const double of_landmarks = eyes_px(box, {"--box-of", "landmarks"});
  CHECK(of_landmarks == doctest::Approx(eyes_px(s / "f.json", {})));
  CHECK(of_landmarks > 1.05 * eyes_px(box, {}));
  CHECK(eyes_px(box, {"--box-of", "pliant"}) == eyes_px(box, {}));
  const Ran r = run_words({"points", face, "--image", picture, "--start", s / "f.json", "--box-of", "landmarks", "-o",
                           s / "x.html"});
  CHECK(r.code == 2);
  CHECK(contains(r.err, "--box-of needs a box"));
}

TEST_CASE("given points of the chart are on the page under their own names") {
  const Folder f;
  const std::string picture = f.put("g.pgm", grey_pgm(320, 240)), table = f / "m.plm";
  REQUIRE(
      run_words({"bake", PLIANT_FIXTURES "/sheet", "-o", table, "--size", "32", "--texture", "none"}).code ==
      0);
  const std::string given = f.put("p.csv",
                                  "landmark,x,y,u,v\nstamp,90,60,0.1,0.1\nmid,150,60,0.5,0.1\n"
                                  "fold,90,170,0.1,0.9\nuv_0.00_0.00,210,170,0.9,0.9\n");
  const Ran r = run_words({"points", table, "--image", picture, "--start", given, "-o", f / "p.html"});
  CAPTURE(r.err);
  REQUIRE(r.code == 0);
  CHECK(contains(r.out, "12 points of the chart, 4 switched on"));
  const Json data = data_of(read_file(f / "p.html"));
  CHECK(data.at("hasUv").get<bool>());
  CHECK(point(data, "stamp").at("placed").get<bool>());
  CHECK(number(point(data, "stamp"), "x") == 90);
  CHECK(number(point(data, "fold"), "v") == doctest::Approx(0.9));
  CHECK(number(point(data, "uv_0.00_0.00"), "u") == doctest::Approx(0.9));
  int wanted = 0;
  for (const Json& p : data.at("points")) wanted += p.at("wanted").get<bool>();
  CHECK(wanted == 4);
}

TEST_CASE("handles are at corners, sides and middle of a surface that takes a part of its chart") {
  const Folder f;
  const std::string picture = f.put("g.pgm", grey_pgm(320, 240)), table = f / "m.plm";
  std::istringstream lines(read_file(PLIANT_FIXTURES "/sheet/sheet.obj"));
  std::string obj, line;
  while (std::getline(lines, line)) {
    float u = 0, v = 0;
    if (std::sscanf(line.c_str(), "vt %f %f", &u, &v) == 2)
      line = "vt " + std::to_string(0.6f + 0.3f * u) + " " + std::to_string(0.1f + 0.4f * v);
    obj += line + "\n";
  }
  const std::string source = f.put("page.obj", obj);
  REQUIRE(run_words({"bake", source, "-o", table, "--size", "64", "--texture", "none"}).code == 0);
  REQUIRE(run_words({"points", table, "--image", picture, "-o", f / "p.html"}).code == 0);
  const Json data = data_of(read_file(f / "p.html"));
  CHECK(data.at("points").size() == 9);
  for (const float across : {0.0f, 0.5f, 1.0f})
    for (const float down : {0.0f, 0.5f, 1.0f}) {
      const Vec2 wanted{0.6f + 0.3f * across, 0.5f + 0.4f * down};
      float least = 1;
      for (const Json& p : data.at("points"))
        least = std::min(least, length(Vec2{p.at("u").get<float>(), p.at("v").get<float>()} - wanted));
      CAPTURE(across);
      CAPTURE(down);
      CHECK(least < 0.03f);
    }
}

TEST_CASE("points take the first frame of a video") {
  const Sequence s;
  const Ran r = run_words({"points", s.model, "--frames", s.video, "--start", s.points, "-o", s / "p.html"});
  CAPTURE(r.err);
  REQUIRE(r.code == 0);
  CHECK(contains(r.out, "`pliant track --init`"));
  const Json data = data_of(read_file(s / "p.html"));
  CHECK(number(data, "width") == 200);
  CHECK(number(data, "height") == 160);
  s.put("first.png", address_bytes(data.at("picture").get<std::string>()));
  const std::string video = read_file(s.video);
  const Image first = to_grey(read_image(s / "first.png"));
  const std::size_t at = video.find("FRAME\n") + 6;
  CHECK(std::equal(first.pixels.begin(), first.pixels.end(), video.begin() + static_cast<std::ptrdiff_t>(at),
                   [](std::uint8_t a, char b) { return a == static_cast<std::uint8_t>(b); }));
  const std::string cut = s.put("cut.y4m", video.substr(0, at + 99));
  check_refused({"points", s.model, "--frames", cut, "-o", s / "x.html"}, {"cut.y4m"});
  check_refused({"points", s.model, "--frames", s.put("none.y4m", ""), "-o", s / "x.html"}, {"none.y4m"});
  CHECK(run_words({"points", s.model, "--frames", s.video, "--image", s.video, "-o", s / "x.html"}).code ==
        2);
  CHECK_FALSE(s.has("x.html"));
}

TEST_CASE("points have the positions of a calibrated lens") {
  const Sequence s;
  const std::string picture = s.put("g.pgm", grey_pgm(200, 160));
  const std::string camera =
      s.put("camera.yml",
            "%YAML:1.0\n---\nimage_width: 200\nimage_height: 160\ncamera_matrix: !!opencv-matrix\n"
            "   rows: 3\n   cols: 3\n   dt: d\n   data: [ 200., 0., 90., 0., 200., 80., 0., 0., 1. ]\n"
            "distortion_coefficients: !!opencv-matrix\n   rows: 1\n   cols: 5\n   dt: d\n"
            "   data: [ -0.2, 0., 0., 0., 0. ]\n");
  std::vector<std::string> words{"points", s.model,      "--image",       picture,
                                 "-o",     s / "p.html", "--calibration", camera};
  const Ran r = run_words(words);
  CAPTURE(r.err);
  REQUIRE(r.code == 0);
  const Json bent = data_of(read_file(s / "p.html"));
  // The model stands in the middle of the camera's axis, whose principal point is (90, 80).
  const double left = number(point(bent, "eye_left"), "x"), right = number(point(bent, "eye_right"), "x");
  CHECK(number(point(bent, "nose_tip"), "x") == doctest::Approx(90).epsilon(0.01));
  words.back() = s.put("straight.yml", [&] {
    std::string text = read_file(camera);
    return text.replace(text.find("-0.2"), 4, "0.00");
  }());
  REQUIRE(run_words(words).code == 0);
  const Json straight = data_of(read_file(s / "p.html"));
  CHECK(left - right < number(point(straight, "eye_left"), "x") - number(point(straight, "eye_right"), "x"));
}

TEST_CASE("a JPEG is embedded unchanged but without its EXIF data") {
  const Folder f;
  Image image(48, 32, 3);
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    image.pixels[i] = static_cast<std::uint8_t>(i * 7 % 251);
  const std::string plain = encode_jpeg(image, 90);
  std::string exif(
      "\xff\xe1\x00\x14"
      "Exif",
      8);
  exif += std::string("\0\0GPS home add", 14);
  const std::string marked = plain.substr(0, 2) + exif + plain.substr(2);
  CHECK(address_bytes(picture_address(image_in("m.jpg", marked), marked)) == plain);
  CHECK(address_bytes(picture_address(image, plain)) == plain);
  const std::string filled =
      plain.substr(0, 2) + "\xff\xff" + exif + plain.substr(2);  // two fill bytes before the marker
  CHECK(address_bytes(picture_address(image, filled)) == plain);
  const std::string png = encode_png(image);
  CHECK(address_bytes(picture_address(image, png)) == png);
}

TEST_CASE("a page shows a JPEG as its camera was held, which is how it was read") {
  const Folder f;
  const std::string upright = encode_jpeg(Image(48, 32, 3, 90), 90);
  const std::string a_quarter_to_the_right(
      "\xff\xe1\x00\x22"
      "Exif\0\0II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0\x06\0\0\0\0\0\0\0",
      36);
  const std::string path = f.put("m.jpg", upright.substr(0, 2) + a_quarter_to_the_right + upright.substr(2));
  const Image read = read_image(path),
              shown = read_image(f.put("shown.jpg", address_bytes(picture_address(read, read_file(path)))));
  CHECK(read.width == 32);
  CHECK(shown.width == 32);
  CHECK(shown.height == 48);
}

TEST_CASE("names that are no UTF-8 are on the page, with a mark for each wrong byte") {
  const Sequence s;
  const std::string points = s.put("latin.csv", "landmark,x,y,u,v\n" + [&] {
    std::string rows;
    std::istringstream in(read_file(s.points));
    for (std::string line; std::getline(in, line);)
      if (line.rfind("landmark", 0) != 0) rows += line + ",,\n";
    return rows;
  }() + "fl\xe4" "che,90,80,0.5,0.5\n");
  const Ran r = run_words({"points", s.model, "--image", s.put("g.pgm", grey_pgm(200, 160)), "--start", points, "-o",
                           s / "p.html"});
  CAPTURE(r.err);
  REQUIRE(r.code == 0);
  CHECK(contains(read_file(s / "p.html"), "fl\xef\xbf\xbd" "che"));
}

TEST_CASE("points refuses bad words with 2 and bad input with 1 and a line that names it") {
  const Sequence s;
  const std::string picture = s.put("g.pgm", grey_pgm(200, 160));
  CHECK(run_words({"points", s.model, "-o", s / "p.html"}).code == 2);
  CHECK(run_words({"points", s.model, "--image", picture}).code == 2);
  CHECK(run_words({"points", "--image", picture, "-o", s / "p.html"}).code == 2);
  CHECK(run_words({"points", s.model, "--image", picture, "-o", s / "p.html", "--start", "1,2,3,4,5"}).code ==
        2);
  CHECK(run_words({"points", s.model, "--image", picture, "-o", s / "p.html", "--start", "1,2,-3,4"}).code ==
        2);
  const auto words = [&](const std::string& image, const std::string& start) {
    return std::vector<std::string>{"points",  s.model, "--image", image,
                                    "--start", start,   "-o",      s / "p.html"};
  };
  check_refused(words(s / "none.jpg", s.points), {"none.jpg", "No such file"});
  check_refused(words(s.points, s.points), {"p.csv", "not a picture"});
  check_refused(words(picture, s / "none.json"), {"none.json", "No such file"});
  check_refused(words(picture, s.put("bad.csv", "landmark,x,y\near,1,2\n")), {"bad.csv"});
  REQUIRE(
      run_words({"fit", s.model, "--points", s.points, "--size", "320x240", "-o", s / "large.json"}).code ==
      0);
  check_refused(words(picture, s / "large.json"), {"large.json", "320x240", "200x160", "g.pgm"});
  REQUIRE(
      run_words({"fit", s.model, "--points", s.points, "--size", "200x160", "-o", s / "wide.json"}).code ==
      0);
  std::string fit = read_file(s / "wide.json");
  const std::size_t value = fit.find(':', fit.find("\"jawOpen\"")) + 1;
  s.put("wide.json", fit.replace(value, fit.find_first_of(",}\n", value) - value, "5"));
  check_refused(words(picture, s / "wide.json"), {"wide.json: 'jawOpen' is outside its limits 0 and 1"});
  CHECK_FALSE(s.has("p.html"));
}

TEST_CASE("a report has nine frames and the numbers of the run, and gaps at lost frames") {
  const Sequence s;
  std::string video = read_file(s.video);
  const std::size_t head = video.find('\n') + 1, frame = 6 + 200 * 160;
  for (std::size_t k = 4; k < 9; ++k)
    std::fill_n(video.begin() + static_cast<std::ptrdiff_t>(head + k * frame + 6), 200 * 160, '\x10');
  auto words = s.track_words();
  words[3] = s.put("b<r>eak.y4m", video);
  words.insert(words.end(), {"--report", s / "r.html"});
  const Ran r = run_words(words);
  REQUIRE(r.code == 0);
  const std::string page = read_file(s / "r.html");
  const auto elements = check_well_formed(page);
  CHECK(elements.at("img") == 9);
  CHECK(count_of(page, "src=\"data:image/jpeg;base64,/9j/") == 9);
  CHECK(contains(page, r.out.substr(0, r.out.size() - 1)));  // the summary line
  CHECK(contains(page, "b&lt;r&gt;eak.y4m"));
  for (const char* part : {"://", "{{", "nan", "inf\"", "<script"}) {
    CAPTURE(std::string(part));
    CHECK_FALSE(contains(without_pictures(page), part));
  }
  const CsvTable table("t", read_file(s / "t.csv"));
  int count[3] = {};
  const char* names[] = {"tracking", "degraded", "lost"};
  for (std::size_t k = 0; k < table.row_count(); ++k)
    for (int c = 0; c < 3; ++c) count[c] += table.cell(k, table.column("state")) == names[c];
  CHECK(count[2] >= 2);
  for (int c = 0; c < 3; ++c) CHECK(contains(page, "<b>" + std::to_string(count[c]) + "</b>" + names[c]));
  CHECK(contains(page, "<rect x=\""));
  CHECK(contains(page, "class=\"state-lost\""));
  // One place on the line for each frame that is known.
  const std::string yaw = path_titled(page, "yaw");
  CHECK(count_of(yaw, "M") + count_of(yaw, "L") == count[0] + count[1]);
  const std::string arena = std::to_string(static_cast<long>(value_after(r.out, "arena_bytes")));
  CHECK(contains(page, arena.substr(arena.size() - 3) + " bytes"));
  const auto rms = double(value_after(r.out, "rms_px"));
  CHECK(rms > 0);
  CHECK(std::fabs(std::stod(page.substr(page.rfind("<b>", page.find(" px</b>rms<")) + 3)) - rms) < 0.006);
  CHECK(contains(page, "model table"));
}

TEST_CASE("a line leaves a gap where there is no value, and columns keep their extremes") {
  ChartStyle style;
  style.width = 300;
  style.has_axes = false;
  Series series{"s", {}};
  for (int k = 0; k < 100; ++k)
    series.values.push_back(k >= 40 && k < 50 ? std::nullopt : std::optional<double>(0.01 * k));
  const std::string gap = path_titled(line_chart({series}, 0, 1, style), "s");
  CHECK(count_of(gap, "M") == 2);
  CHECK(count_of(gap, "M") + count_of(gap, "L") == 90);
  series.values.assign(30000, 0.5);
  series.values[12345] = 9;
  series.values[20000] = std::nullopt;
  const std::string chart = line_chart({series}, 0, 1, style), path = path_titled(chart, "s");
  CHECK(count_of(path, "M") == 2);
  CHECK(path.size() < 8000);
  double highest = 1e9;  // of the picture: y points down
  for (std::size_t at = path.find(' '); at != std::string::npos; at = path.find(' ', at + 1))
    highest = std::min(highest, std::stod(path.substr(at + 1)));
  CHECK(highest < 12);
  for (const auto& values : {std::vector<std::optional<double>>{}, {std::nullopt}, {1.0}, {2.0, 2.0}}) {
    CHECK(check_well_formed(line_chart({{"a<b", values}}, 0, 0, ChartStyle{})).at("svg") == 1);
  }
}

TEST_CASE("a ribbon shows the worst state of a column, a histogram counts every frame") {
  ChartStyle style;
  std::vector<int> states(20000, 0);
  states[7777] = 2;
  const std::string band = ribbon(states, {"good", "fair", "bad"}, style);
  CHECK(count_of(band, "class=\"state-good\"") == 2);
  CHECK(count_of(band, "class=\"state-bad\"") == 1);
  std::vector<double> times;
  for (int k = 0; k < 500; ++k) times.push_back(k == 250 ? 1000 : 2 + 0.001 * k);
  const std::string bars = histogram(times, {{"median", 2.25}}, style);
  check_well_formed(bars);
  int sum = 0;
  for (std::size_t at = bars.find("<title>"); at != std::string::npos; at = bars.find("<title>", at + 1))
    sum += std::stoi(bars.substr(at + 7));
  CHECK(sum == 500);
  CHECK(contains(bars, "1 frames above"));
  check_well_formed(histogram({}, {}, style));
}

}  // namespace cli_pages_test
