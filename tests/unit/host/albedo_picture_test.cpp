// A surface's albedo from a picture: by option, by the OBJ file's materials, over mirrored and relaxed charts, and rendered.
#include "host/bake/albedo_picture.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <string>

#include "cli_run.hpp"
#include "host/bake/bake.hpp"
#include "host/io/csv.hpp"
#include "host/render/shown_mesh.hpp"
#include "host/render/synthetic.hpp"
#include "random.hpp"

namespace albedo_picture_test {

using namespace cli_run;

namespace {

/// Grey rises from left to right, and above the middle it is 100 more.
Image ramp(int width, int height) {
  Image image(width, height, 3);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < 3; ++c)
        image.at(x, y)[c] = static_cast<std::uint8_t>(100 * x / width + (2 * y < height ? 100 : 0));
  return image;
}

/// A sheet of 10 x 10 quads, 200 mm wide, whose left half has the material "left" and whose right half has "right".
std::string sheet_obj(bool is_seen_from_behind, const std::string& head = "mtllib paints.mtl\n") {
  std::string text = head;
  for (int k = 0; k < 121; ++k) {
    const float s = static_cast<float>(k % 11) / 10, t = static_cast<float>(k / 11) / 10;
    text += "v " + std::to_string(200 * s) + " " + std::to_string(200 * t) + " 0\nvt " +
            std::to_string(0.05f + 0.9f * s) + " " + std::to_string(0.05f + 0.9f * t) + "\n";
  }
  for (int j = 0; j < 10; ++j)
    for (int i = 0; i < 10; ++i) {
      const int a = 11 * j + i + 1;
      text += i < 5 ? "usemtl left\nf" : "usemtl right\r\nf";
      for (const int v : is_seen_from_behind ? std::vector<int>{a, a + 11, a + 12, a + 1}
                                             : std::vector<int>{a, a + 1, a + 12, a + 11})
        text += " " + std::to_string(v) + "/" + std::to_string(v);
      text += "\n";
    }
  return text;
}

/// The albedo at the picture's (u,v), v upwards.
float albedo_at(const std::string& table, bool is_mirrored, float u, float v) {
  const ModelFile file(table);
  const ChartImage image = file.model().albedo();
  REQUIRE(image.pixels != nullptr);
  const auto x = static_cast<std::size_t>((is_mirrored ? 1 - u : u) * static_cast<float>(image.width - 1) +
                                          0.5f),
             y = static_cast<std::size_t>((1 - v) * static_cast<float>(image.height - 1) + 0.5f);
  return static_cast<float>(image.pixels[y * image.width + x]);
}

void check_ramp(const std::string& table, bool is_mirrored) {
  for (const float u : {0.1f, 0.3f, 0.77f})
    for (const float v : {0.2f, 0.4f, 0.6f, 0.9f}) {
      CAPTURE(u);
      CAPTURE(v);
      CHECK(std::fabs(albedo_at(table, is_mirrored, u, v) - (100 * u + (v > 0.5f ? 100 : 0))) < 2.5f);
    }
}

}  // namespace

TEST_CASE("bake --texture stores the picture as albedo, the right way round") {
  const Folder folder;
  const std::string picture = folder.put("ramp.png", encode_png(ramp(300, 200)));
  for (const bool behind : {false, true}) {
    CAPTURE(behind);
    const std::string sheet = folder.put("sheet.obj", sheet_obj(behind)), table = folder / "m.plm";
    REQUIRE(run_words({"bake", sheet, "-o", table, "--base-mesh", "60", "--texture", picture}).code == 0);
    check_ramp(table, behind);  // seen from outside, u of the table points right
    const ModelFile file(table);
    CHECK(file.model().albedo().width == 300);  // as many pixels as the picture
  }
  SUBCASE("it has at most four pixels a sample") {
    const std::string sheet = folder.put("sheet.obj", sheet_obj(false)), table = folder / "m.plm";
    REQUIRE(run_words({"bake", sheet, "-o", table, "--base-mesh", "60", "--texture", picture, "--size", "32"})
                .code == 0);
    const ModelFile file(table);
    CHECK(file.model().albedo().width == 128);
    check_ramp(table, false);
  }
  SUBCASE("what is no picture, and a source of tables, are refused") {
    const std::string sheet = folder.put("sheet.obj", sheet_obj(false));
    check_refused({"bake", sheet, "-o", folder / "x.plm", "--texture", sheet},
                  {"sheet.obj", "is not a picture"});
    check_refused({"bake", PLIANT_FIXTURES "/face", "-o", folder / "x.plm", "--texture", picture},
                  {"--texture: needs an OBJ file"});
    CHECK_FALSE(folder.has("x.plm"));
  }
}

namespace {

/// Bytes of the row "size bits identities expressions bytes ..." in what `bake --sizes` printed; 0 without such a row.
std::size_t bytes_in_row(const std::string& printed, int wanted_size, int wanted_bits) {
  std::istringstream lines(printed);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    int size = 0, bits = 0, identities = 0, expressions = 0;
    std::size_t bytes = 0;
    if (words >> size >> bits >> identities >> expressions >> bytes && size == wanted_size &&
        bits == wanted_bits)
      return bytes;
  }
  return 0;
}

}  // namespace

TEST_CASE("bake --sizes tells the bytes of a surface with a texture that bake --size writes") {
  const Folder folder;
  const std::string sheet = folder.put("sheet.obj", sheet_obj(false)), table = folder / "m.plm";
  std::vector<std::string> words{"bake", sheet, "--base-mesh", "60"};
  SUBCASE("by option") {
    words.insert(words.end(), {"--texture", folder.put("ramp.png", encode_png(ramp(300, 200)))});
  }
  SUBCASE("by material") {
    folder.put("ramp.png", encode_png(ramp(300, 200)));
    folder.put("paints.mtl", "newmtl left\nmap_Kd ramp.png\nnewmtl right\nmap_Kd ramp.png\n");
  }
  const auto with = [&words](std::vector<std::string> more) {
    more.insert(more.begin(), words.begin(), words.end());
    return more;
  };
  const Ran sizes = run_words(with({"--sizes", "16,32", "--flash", "80"}));
  REQUIRE(sizes.code == 0);
  const auto check = [&](int size, int bits) {
    CAPTURE(size);
    CAPTURE(bits);
    REQUIRE(
        run_words(with({"-o", table, "--size", std::to_string(size), "--bits", std::to_string(bits)})).code ==
        0);
    CHECK(bytes_in_row(sizes.out, size, bits) == fs::file_size(table));
  };
  for (const int size : {16, 32})
    for (const int bits : {16, 8}) check(size, bits);
  check(40, 8);  // the small profile
}

namespace {

/// The sheet of two materials in a folder with two pictures.
struct MaterialFolder : Folder {
  std::string sheet, table;
  std::vector<std::string> words;

  MaterialFolder() : sheet(put("sheet.obj", sheet_obj(false))), table(*this / "m.plm") {
    put("ramp one.png", encode_png(ramp(64, 64)));
    put("dark.png", encode_png(Image(8, 8, 3, 20)));
    words = {"bake", sheet, "-o", table, "--base-mesh", "60"};
  }
  float left() const { return albedo_at(table, false, 0.3f, 0.8f); }
  float right() const { return albedo_at(table, false, 0.8f, 0.8f); }
};

}  // namespace

TEST_CASE("bake takes the pictures of the OBJ file's materials: options and blanks in names are read") {
  const MaterialFolder folder;
  folder.put("paints.mtl",
             "newmtl left\nKd 1 1 1\nmap_Kd ramp one.png\r\n\nnewmtl right\nmap_Kd -s 1 1 1 dark.png\n");
  REQUIRE(run_words(folder.words).code == 0);
  CHECK(std::fabs(folder.left() - 130) < 3);
  CHECK(folder.right() == 20);
}

TEST_CASE("the name of a material's picture with blanks behind options is read whole") {
  const MaterialFolder folder;
  folder.put("paints.mtl",
             "newmtl left\nmap_Kd -s 1 1 -clamp on -o 0 0 0 -mm 0 1 ramp one.png\n"
             "newmtl right\nmap_Kd -s 1.0 1.0 1.0 dark.png\n");
  const Ran result = run_words(folder.words);
  REQUIRE(result.code == 0);
  CHECK(std::fabs(folder.left() - 130) < 3);
  CHECK(folder.right() == 20);
  CHECK(!contains(result.err, "scaled"));
}

TEST_CASE("names of pictures and material files may be quoted, and a carriage return alone ends lines") {
  const MaterialFolder folder;
  const std::string paints =
      "newmtl left\nmap_Kd \"ramp one.png\"\nnewmtl right\nmap_Kd -s 1 1 1 \"dark.png\"\n";
  const std::string sheet = sheet_obj(false, "mtllib \"two paints.mtl\"\n");
  const auto with_returns = [](std::string text) {
    text.erase(std::remove(text.begin(), text.end(), '\r'), text.end());
    std::replace(text.begin(), text.end(), '\n', '\r');
    return text;
  };
  // Some editors end the last line of such a file in another way.
  for (const std::string last : {"", "# end\r", "# end\n", "\r\n"}) {
    CAPTURE(last);
    folder.put("two paints.mtl", last.empty() ? paints : with_returns(paints) + last);
    folder.put("sheet.obj", last.empty() ? sheet : with_returns(sheet) + last);
    const Ran result = run_words(folder.words);
    CHECK(result.err == "");
    REQUIRE(result.code == 0);
    CHECK(std::fabs(folder.left() - 130) < 3);
    CHECK(folder.right() == 20);
  }
}

TEST_CASE("bake tells of a material's picture that is scaled or moved") {
  const MaterialFolder folder;
  for (const std::string option : {"-s 2 2 1", "-o 0.5", "-t 0 0.1 0"}) {
    folder.put("paints.mtl", "newmtl right\nmap_Kd " + option + " dark.png\n");
    const Ran result = run_words(folder.words);
    CHECK(result.code == 0);
    CHECK(contains(result.err, "paints.mtl: the picture of material 'right' is scaled or moved"));
  }
}

TEST_CASE("a material without a picture is light grey") {
  const MaterialFolder folder;
  folder.put("paints.mtl", "newmtl right\nmap_Kd dark.png\n");
  REQUIRE(run_words(folder.words).code == 0);
  CHECK(folder.left() == 190);
  CHECK(folder.right() == 20);
}

TEST_CASE("without a material library, and with --texture none, there is no albedo") {
  const MaterialFolder folder;
  REQUIRE(run_words(folder.words).code == 0);
  CHECK(ModelFile(folder.table).model().albedo().pixels == nullptr);
  folder.put("paints.mtl", "newmtl right\nmap_Kd dark.png\n");
  auto without = folder.words;
  without.insert(without.end(), {"--texture", "none"});
  REQUIRE(run_words(without).code == 0);
  CHECK(ModelFile(folder.table).model().albedo().pixels == nullptr);
}

TEST_CASE("bake tells of materials that no file has; a byte order mark and several files a line are read") {
  const MaterialFolder folder;
  folder.put("paints.mtl",
             "\xef\xbb\xbfnewmtl left\nmap_kd dark.png\nnewmtl right # comment\nmap_Kd dark.png\n");
  const Ran result = run_words(folder.words);
  REQUIRE(result.code == 0);
  CHECK(contains(result.err, "no material file has the material 'right'"));
  CHECK(!contains(result.err, "'left'"));
  CHECK(folder.left() == 20);
  folder.put("more.mtl", "newmtl right\nmap_Kd dark.png\n");
  folder.put("sheet.obj", sheet_obj(false, "mtllib .\\paints.mtl more.mtl\n"));
  const Ran both = run_words(folder.words);
  REQUIRE(both.code == 0);
  CHECK(both.err == "");
  CHECK(folder.right() == 20);

  folder.put("more paints.mtl", "newmtl right\nmap_Kd \"ramp one.png\"\n");
  folder.put("sheet.obj", sheet_obj(false, "mtllib \"paints.mtl\" \"more paints.mtl\"\n"));
  const Ran quoted = run_words(folder.words);
  REQUIRE(quoted.code == 0);
  CHECK(quoted.err == "");
  CHECK(folder.left() == 20);
  CHECK(folder.right() > 30);
}

TEST_CASE("the picture of a GLB has the albedo where glTF looks for it") {
  const Folder folder;
  constexpr int kSide = 16;
  Image steep(kSide, kSide, 3);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      for (int c = 0; c < 3; ++c) steep.at(x, y)[c] = static_cast<std::uint8_t>(10 * x + 5 * y);
  const std::string picture = folder.put("steep.png", encode_png(steep)),
                    sheet = folder.put("sheet.obj", sheet_obj(false)), table = folder / "m.plm";
  REQUIRE(run_words({"bake", sheet, "-o", table, "--base-mesh", "60", "--texture", picture}).code == 0);
  const ModelFile file(table);
  const ChartImage albedo = file.model().albedo();
  REQUIRE(albedo.width == kSide);
  const Image png = image_in("albedo", albedo_png(file.model()));
  // As a sampler of glTF sees it: pixel centres lie half a pixel inside the border.
  const auto seen = [&](float u, float v) {
    const float x = u * kSide - 0.5f, y = v * kSide - 0.5f;
    const int i = static_cast<int>(x), j = static_cast<int>(y);
    const float a = x - static_cast<float>(i), b = y - static_cast<float>(j);
    const auto grey = [&](int k, int l) { return static_cast<float>(png.at(k, l)[0]); };
    return (1 - b) * ((1 - a) * grey(i, j) + a * grey(i + 1, j)) +
           b * ((1 - a) * grey(i, j + 1) + a * grey(i + 1, j + 1));
  };
  // Within the sheet, whose albedo is a plane: beside it, from 0.95 on, it is that of its boundary, and bends.
  for (const float u : {0.1f, 0.3f, 0.5f, 0.81f, 0.9f})
    for (const float v : {0.1f, 0.4f, 0.9f}) {
      CAPTURE(u);
      CAPTURE(v);
      CHECK(std::fabs(seen(u, v) - chart_value(albedo.pixels, albedo.width, albedo.height, {u, v})) < 1.5f);
    }
}

TEST_CASE("a material's picture that is not there is refused") {
  const MaterialFolder folder;
  folder.put("paints.mtl", "newmtl right\nmap_Kd lost.png\n");
  check_refused(folder.words,
                {"lost.png: the picture of material 'right' cannot be read (--texture none does without)"});
}

TEST_CASE("a material file that is there, but cannot be read, is refused") {
  const MaterialFolder folder;
  std::filesystem::create_symlink("/proc/self/mem", folder / "paints.mtl");  // nothing is at its beginning
  check_refused(folder.words, {"paints.mtl: reading failed"});
}

TEST_CASE("the picture stays on the surface when the chart is relaxed, and render shows it") {
  const Folder folder;
  const std::string picture = folder.put("ramp.png", encode_png(ramp(128, 128)));
  const std::string sheet = folder.put("sheet.obj", sheet_obj(false)), table = folder / "m.plm";
  REQUIRE(run_words({"bake", sheet, "-o", table, "--base-mesh", "60", "--texture", picture, "--relax-chart"})
              .code == 0);
  // Relaxation spreads the chart over the square: what was at u = 0.05 is at 1/64.
  const auto spread = [](float u) { return 1.0f / 64 + (u - 0.05f) / 0.9f * (1 - 2.0f / 64); };
  for (const float u : {0.2f, 0.6f})
    CHECK(std::fabs(albedo_at(table, false, spread(u), spread(0.2f)) - 100 * u) < 3);
  const std::string q = folder.put("q.csv", "qw,qx,qy,qz,tx,ty,tz\n1,0,0,0,-100,100,600\n"),
                    film = folder / "f.y4m";
  REQUIRE(run_words({"render", table, "--params", q, "-o", film}).code == 0);
  const std::string bytes = read_file(film);
  const std::size_t first = bytes.find("FRAME\n") + 6;
  const auto grey = [&](int x, int y) {
    return static_cast<int>(static_cast<unsigned char>(bytes[first + static_cast<std::size_t>(y * 320 + x)]));
  };
  CHECK(grey(200, 90) > grey(200, 150) + 40);   // the upper half is lighter
  CHECK(grey(220, 150) > grey(110, 150) + 25);  // and so is the right side
}

TEST_CASE("a printed sheet with bending modes is baked, rendered, fitted by nine points and tracked") {
  const Folder folder;
  Random random(1);
  Image print(256, 256, 3, 128);
  for (int k = 0; k < 700; ++k) {
    const int x = random.below(256), y = random.below(256), r = 2 + random.below(6),
              grey = 20 + random.below(230);
    for (int j = std::max(0, y - r); j < std::min(256, y + r); ++j)
      for (int i = std::max(0, x - r); i < std::min(256, x + r); ++i)
        for (int c = 0; c < 3; ++c) print.at(i, j)[c] = static_cast<std::uint8_t>(grey);
  }
  const std::string picture = folder.put("print.png", encode_png(print)), table = folder / "sheet.plm",
                    sheet = folder.put("sheet.obj", sheet_obj(false));
  REQUIRE(run_words({"bake", sheet, "-o", table, "--texture", picture, "--modes", "3"}).code == 0);
  std::string motion = "qw,qx,qy,qz,tx,ty,tz,mode00,mode01\n";
  const auto bend = [](int frame) { return 1.5f * std::sin(static_cast<float>(frame) / 8); };
  for (int k = 0; k < 30; ++k)
    motion +=
        "1,0,0,0,-100,100,500," + std::to_string(bend(k)) + "," + std::to_string(-0.7f * bend(k)) + "\n";
  const std::string film = folder / "film.y4m", start = folder / "start.json", track = folder / "track.csv";
  REQUIRE(run_words({"render", table, "--params", folder.put("motion.csv", motion), "-o", film}).code == 0);
  std::string points = "landmark,x,y,u,v\n";
  for (const float s : {0.1f, 0.5f, 0.9f})
    for (const float t : {0.1f, 0.5f, 0.9f})
      points += "p" + std::to_string(points.size()) + "," +
                std::to_string(159.5f + 448 * (200 * s - 100) / 500) + "," +
                std::to_string(119.5f - 448 * (200 * t - 100) / 500) + "," +
                std::to_string(0.05f + 0.9f * s) + "," + std::to_string(0.95f - 0.9f * t) + "\n";
  REQUIRE(run_words({"fit", table, "--size", "320x240", "--points", folder.put("points.csv", points),
                     "--focal", "448", "-o", start})
              .code == 0);
  REQUIRE(
      run_words({"track", table, "--frames", film, "--init", start, "--focal", "448", "--out", track}).code ==
      0);
  const CsvTable rows(track, read_file(track));
  REQUIRE(rows.row_count() == 30);
  for (std::size_t k = 0; k < 30; ++k) {
    CAPTURE(k);
    CHECK(rows.cell(k, rows.column("state")) == "tracking");
    CHECK(std::fabs(rows.number(k, rows.column("mode00")) - bend(static_cast<int>(k))) < 0.1f);
    CHECK(std::fabs(rows.number(k, rows.column("mode01")) + 0.7f * bend(static_cast<int>(k))) < 0.1f);
  }
}

TEST_CASE("the sheet of the fixtures is baked from its folder or file, with modes and its print") {
  const Folder out;
  const std::string table = out / "sheet.plm";
  for (const char* source : {PLIANT_FIXTURES "/sheet", PLIANT_FIXTURES "/sheet/sheet.obj"}) {
    CAPTURE(source);
    REQUIRE(run_words({"bake", source, "--modes", "3", "-o", table}).code == 0);
    const ModelFile file(table);
    CHECK(file.model().parameters().count == 3);
    const float title = albedo_at(table, false, 0.02f, 0.98f), margin = albedo_at(table, false, 0.02f, 0.5f);
    CHECK(title == doctest::Approx(52).epsilon(0.05));
    CHECK(margin == doctest::Approx(238).epsilon(0.05));
  }
}

TEST_CASE("render shows the background through an opening of a surface") {
  const Folder folder;
  std::string text = sheet_obj(false, "");
  // Leaves the middle four of the 10 x 10 quads out.
  for (const int quad : {44, 45, 54, 55}) {
    const int a = 11 * (quad / 10) + quad % 10 + 1;
    std::string face = "\nf";
    for (const int v : {a, a + 1, a + 12, a + 11}) face += " " + std::to_string(v) + "/" + std::to_string(v);
    const std::size_t at = text.find(face + "\n");
    REQUIRE(at != std::string::npos);
    text.erase(at, face.size());
  }
  const std::string sheet = folder.put("ring.obj", text), table = folder / "ring.plm",
                    black = folder.put("black.png", encode_png(Image(200, 200, 1, 0)));
  REQUIRE(run_words({"bake", sheet, "-o", table}).code == 0);
  const std::string params = folder.put("q.csv", "frame,tx,ty,tz\n0,0,0,500\n"), film = folder / "ring.y4m";
  REQUIRE(run_words({"render", table, "--params", params, "--size", "200x200", "--focal", "400", "--noise", "0",
                     "--background", black, "-o", film})
              .code == 0);
  const std::string bytes = read_file(film);
  const auto grey = [&](std::size_t x, std::size_t y) {
    return static_cast<std::uint8_t>(bytes[bytes.size() - 200 * 200 + 200 * y + x]);
  };
  // The sheet's lower left corner is the origin, so that it covers the picture's upper right quarter; the opening has 32 x 32 px.
  int dark = 0, bright = 0;
  for (std::size_t y = 0; y < 100; ++y)
    for (std::size_t x = 100; x < 200; ++x) (grey(x, y) == 0 ? dark : bright) += 1;
  CHECK(bright > 8000);
  CHECK(dark > 700);
  CHECK(dark < 1500);
}

TEST_CASE("over a background in colour render writes colour, and the same luma as over a grey one") {
  const Folder folder;
  Image red(64, 48, 3, 60);
  for (std::size_t i = 0; i < red.pixels.size(); i += 3) red.pixels[i] = 200;
  const std::string sheet = folder.put("plain.obj", sheet_obj(false, "")), table = folder / "plain.plm",
                    colour = folder.put("red.png", encode_png(red)),
                    grey = folder.put("grey.png", encode_png(to_grey(red)));
  REQUIRE(run_words({"bake", sheet, "-o", table}).code == 0);
  const std::string params = folder.put("q.csv", "frame,tx,ty,tz\n0,0,0,900\n");
  const auto film_over = [&](const std::string& background) {
    REQUIRE(run_words({"render", table, "--params", params, "--size", "64x48", "--noise", "3", "--background",
                       background, "-o", folder / "film.y4m"})
                .code == 0);
    return read_file(folder / "film.y4m");
  };
  const std::string in_colour = film_over(colour), in_grey = film_over(grey);
  REQUIRE(contains(in_colour, "C420jpeg"));
  REQUIRE(contains(in_grey, "Cmono"));
  constexpr std::size_t kLuma = 64 * 48;
  const std::size_t at = in_colour.find("FRAME\n") + 6, grey_at = in_grey.find("FRAME\n") + 6;
  REQUIRE(in_colour.size() == at + kLuma * 3 / 2);
  int worst = 0;
  for (std::size_t k = 0; k < kLuma; ++k)
    worst = std::max(worst, std::abs(static_cast<std::uint8_t>(in_colour[at + k]) -
                                     static_cast<std::uint8_t>(in_grey[grey_at + k])));
  CHECK(worst <= 1);
  // Cr of the red background is above the middle; where the sheet is, in the upper right quarter, it is grey.
  const auto cr = [&](std::size_t x, std::size_t y) {
    return static_cast<std::uint8_t>(in_colour[at + kLuma * 5 / 4 + 32 * y + x]);
  };
  CHECK(cr(25, 20) > 150);
  CHECK(cr(17, 10) == 128);
}

}  // namespace albedo_picture_test
