// `pliant bake` as a user runs it: what it keeps, what it says, and what it shows while it works.
#include <doctest/doctest.h>
#include <sys/stat.h>

#include <fstream>
#include <sstream>

#include "cli_run.hpp"

namespace cli_bake_test {

using namespace cli_run;

namespace {

const std::string kFace = PLIANT_FIXTURES "/face";

/// Six OBJ files: a square, three identities and two expressions.
struct ObjFolder : Folder {
  std::string folder;
  ObjFolder() : folder(*this / "obj") {
    fs::create_directories(folder);
    for (const char* name : {"neutral", "identity000", "identity001", "identity002", "jawOpen", "flap"}) {
      std::string text;
      for (int k = 0; k < 9; ++k)
        text += "v " + std::to_string(k % 3) + " " + std::to_string(k / 3) + " " +
                std::to_string(k == 4 ? name[0] - 'a' : 0) + "\n";
      for (int k = 0; k < 9; ++k)
        text += "vt " + std::to_string(0.5 * (k % 3)) + " " + std::to_string(0.5 * (k / 3)) + "\n";
      for (const int a : {1, 2, 4, 5}) {
        text += "f";
        for (const int v : {a, a + 1, a + 4, a + 3})
          text += " " + std::to_string(v) + "/" + std::to_string(v);
        text += "\n";
      }
      std::ofstream(folder + "/" + name + ".obj") << text;
    }
  }
};

}  // namespace

TEST_CASE("bake keeps the identities and expressions asked for") {
  const Folder folder;
  const std::string table = folder / "m.plm";
  const Ran r =
      run_words({"bake", kFace, "-o", table, "--size", "16", "--identities", "2", "--expressions", "3"});
  REQUIRE(r.code == 0);
  const ModelFile file(table);
  CHECK(file.model().parameters().count == 5);
  for (const char* name : {"jawOpen", "mouthSmileLeft", "mouthSmileRight"})
    CHECK(file.model().find_parameter(name) != kNone);
  REQUIRE(run_words({"bake", kFace, "-o", table, "--size", "16", "--identities", "0", "--expressions",
                     "jawOpen,eyeBlinkLeft"})
              .code == 0);
  const ModelFile named(table);
  CHECK(named.model().parameters().count == 2);
  check_refused({"bake", kFace, "-o", folder / "x.plm", "--expressions", "jawOpen,nod"},
                {"--expressions", "there is no expression 'nod'"});
  CHECK_FALSE(folder.has("x.plm"));
}

TEST_CASE(
    "bake --unit refuses what makes the surface too large, by the surface, and what is no unit, by its "
    "range") {
  const ObjFolder folder;
  for (const char* unit : {"100000", "1000000"})
    check_refused({"bake", folder.folder, "-o", folder / "x.plm", "--unit", unit},
                  {".obj: vertex", "is more than 100 m from the origin: check it and --unit"});
  for (const char* unit : {"1000001", "0", "-1", "nan", "1e-7"}) {
    const Ran r = run_words({"bake", folder.folder, "-o", folder / "x.plm", "--unit", unit});
    CHECK(r.code == 2);
    CHECK(contains(r.err, "--unit"));
  }
  CHECK_FALSE(folder.has("x.plm"));
  CHECK(run_words({"bake", folder.folder, "-o", folder / "x.plm", "--unit", "1000"}).code == 0);
}

TEST_CASE(
    "bake --sizes prints a row for each size and bits, and a small profile within the flash, and writes "
    "nothing") {
  const ObjFolder folder;
  const std::size_t before = folder.file_count();
  const Ran r = run_words({"bake", folder.folder, "--unit", "10", "--base-mesh", "60", "--sizes", "16,32"});
  REQUIRE(r.code == 0);
  CHECK(folder.file_count() == before);
  for (const char* row : {"\n   16   16          3           2 ", "\n   32   16          3           2 ",
                          "\n   16    8          3           2 ", "\n   32    8          3           2 "})
    CHECK(contains(r.out, row));
  CHECK(contains(r.out, "small profile, finest within 524288 bytes"));
  CHECK(contains(r.out, "its expressions: flap jawOpen\n"));
  CHECK(contains(run_words({"bake", folder.folder, "--base-mesh", "60", "--sizes", "16", "--flash", "1"}).out,
                 "no small profile fits 1024 bytes"));
  for (const char* bad : {"8", "16,", "x", "16,1000", "16.5", "16,16", ",16", ""})
    CHECK(run_words({"bake", folder.folder, "--sizes", bad}).code == 2);
  check_refused({"bake", folder / "none", "--sizes", "16"}, {"none"});
}

TEST_CASE("bake refuses OBJ names that do not fit or are there twice, and writes nothing") {
  const ObjFolder folder;
  const std::vector<std::string> words = {"bake",        folder.folder, "-o",     folder / "m.plm",
                                          "--base-mesh", "60",          "--size", "16"};
  CHECK(run_words(words).code == 0);
  fs::remove(fs::path(folder / "m.plm"));
  fs::copy(folder.folder + "/flap.obj", folder.folder + "/" + std::string(24, 'x') + "_L.obj");
  check_refused(words, {"_L.obj: the name '", "is longer than 27 letters"});
  fs::remove(folder.folder + "/" + std::string(24, 'x') + "_L.obj");
  fs::copy(folder.folder + "/flap.obj", folder.folder + "/side_L.obj");
  fs::copy(folder.folder + "/flap.obj", folder.folder + "/sideLeft.obj");
  check_refused(words, {"side", ".obj: another file gives the parameter 'sideLeft' as well"});
  CHECK_FALSE(folder.has("m.plm"));
  CHECK(folder.temporary_count() == 0);
}

TEST_CASE("bake refuses names that its tables cannot give back, in one line") {
  const ObjFolder folder;
  const std::vector<std::string> words = {"bake",        folder.folder, "-o",     folder / "m.plm",
                                          "--base-mesh", "60",          "--size", "16"};
  for (const auto& [name, what] : {std::pair{"a\nb", "'a?b' has a control character"},
                                   {" a", "' a' begins or ends with a blank"},
                                   {"a\xff", "' is not in UTF-8"},
                                   {"\xed\xa0\x80", "' is not in UTF-8"},
                                   {"\xc0\xaf", "' is not in UTF-8"},
                                   {"a\xe2\x82", "' is not in UTF-8"}}) {
    const std::string told = what;  // a structured binding is no variable that CAPTURE may keep
    CAPTURE(told);
    const std::string path = folder.folder + "/" + name + ".obj",
                      landmarks = folder.folder + "/landmarks.csv";
    fs::copy(folder.folder + "/flap.obj", path);
    check_refused(words, {folder.folder, ".obj: the name '", what});
    fs::remove(path);
    write_file(landmarks, "landmark,vertex\n\"" + std::string(name) + "\",0\n");
    if (*name != ' ' && name[1] != '\n') check_refused(words, {"landmarks.csv: line 2: the name '", what});
    fs::remove(landmarks);
  }
  CHECK_FALSE(folder.has("m.plm"));
  for (const char* name : {"f\xc3\xbcnf", "\xe2\x82\xac", "\xf0\x9f\x98\x80", "a,b", "a\"b", "a b"})
    fs::copy(folder.folder + "/flap.obj", folder.folder + "/" + name + ".obj");
  CHECK(run_words(words).code == 0);
  CHECK(ModelFile(folder / "m.plm").model().find_parameter("f\xc3\xbcnf") != kNone);
}

TEST_CASE("bake prints the error of the table against its source, and of each parameter on request") {
  const ObjFolder folder;
  const Ran r = run_words({"bake", folder.folder, "-o", folder / "m.plm", "--base-mesh", "60", "--errors"});
  REQUIRE(r.code == 0);
  for (const char* part : {"; rest shape to ", "; identities to ", "; expressions to ", "\nidentity001 to ",
                           "\njawOpen to ", "\nnot a name of ARKit's: flap\n"})
    CHECK(contains(r.out, part));
  // Of ARKit's name for a pair and a side of it one moves what the other does: the side is left out of ARKit's columns.
  for (const char* name : {"browInnerUp", "browInnerUpLeft", "cheekPuffLeft"})
    fs::copy(folder.folder + "/flap.obj", folder.folder + "/" + name + ".obj");
  const Ran both = run_words({"bake", folder.folder, "-o", folder / "m.plm", "--base-mesh", "60"});
  CHECK(contains(both.out, "\nnot a name of ARKit's: browInnerUpLeft\nnot a name of ARKit's: flap\n"));
  for (const char* name : {"browInnerUp", "browInnerUpLeft", "cheekPuffLeft"})
    fs::remove(folder.folder + "/" + name + ".obj");
  // A surface that is no face: no names of ARKit's are expected.
  fs::remove(folder.folder + "/jawOpen.obj");
  const Ran other = run_words({"bake", folder.folder, "-o", folder / "m.plm", "--base-mesh", "60"});
  CHECK(other.code == 0);
  CHECK_FALSE(contains(other.out, "ARKit"));
  const Ran plain =
      run_words({"bake", folder.folder + "/neutral.obj", "-o", folder / "m.plm", "--base-mesh", "60"});
  CHECK(plain.code == 0);
  CHECK_FALSE(contains(plain.out, "identities"));
  CHECK_FALSE(contains(plain.out, "expressions"));
  // Points of its chart stand in for landmarks.
  const std::string picture = folder.folder + "/picture.png";
  write_file(picture, encode_png(Image(64, 64, 1, 128)));
  const Ran page = run_words({"points", folder / "m.plm", "--image", picture, "-o", folder / "p.html"});
  CHECK(page.code == 0);
  CHECK(contains(page.out, "9 points of the chart, 9 switched on"));
  const std::string html = read_file(folder / "p.html");
  CHECK(contains(html, "\"hasUv\":true"));
  CHECK(contains(html, "\"name\":\"uv_"));
}

TEST_CASE(
    "points of the chart are beside the landmarks where there are fewer than the four that a fit needs") {
  const ObjFolder folder;
  const std::string picture = folder.folder + "/picture.png";
  write_file(picture, encode_png(Image(64, 64, 1, 128)));
  const char* const landmarks[] = {"stem,1", "tip,5", "left,3", "foot,7"};
  std::string text = "landmark,vertex\n";
  for (const char* landmark : landmarks) {
    CAPTURE(std::string(landmark));
    write_file(folder.folder + "/landmarks.csv", text += std::string(landmark) + "\n");
    REQUIRE(run_words({"bake", folder.folder, "-o", folder / "m.plm", "--base-mesh", "60", "--size", "16"})
                .code == 0);
    const Ran page = run_words({"points", folder / "m.plm", "--image", picture, "-o", folder / "p.html"});
    REQUIRE(page.code == 0);
    const std::string html = read_file(folder / "p.html");
    CHECK(contains(html, "\"name\":\"stem\""));
    const bool is_enough = landmark == landmarks[3];
    CHECK(contains(html, "\"name\":\"uv_") != is_enough);
    CHECK(contains(html, "\"hasUv\":true") != is_enough);
    CHECK(contains(page.out, is_enough ? ": 4 landmarks, 4 switched on" : " points of the chart, "));
  }
}

TEST_CASE("bake shows progress over files and shapes on a terminal only") {
  const ObjFolder folder;
  const std::vector<std::string> words{"bake", folder.folder, "-o", folder / "m.plm", "--base-mesh", "60", "--unit", "10"};
  std::ostringstream out, err;
  Console terminal{out, err, true};
  REQUIRE(run(words, terminal) == 0);
  const std::size_t files = err.str().find("\rfiles 5"), shapes = err.str().find("\rshapes 5");
  CHECK(files != std::string::npos);
  CHECK(shapes != std::string::npos);
  CHECK(files < shapes);
  CHECK(err.str().back() == '\n');
  CHECK(run_words(words).err == "");
}

TEST_CASE("info lists the bytes of a table, its operations and its curves") {
  const Folder folder;
  const std::string table = folder / "m.plm";
  REQUIRE(run_words({"bake", kFace, "-o", table, "--size", "16"}).code == 0);
  const Ran r = run_words({"info", table});
  REQUIRE(r.code == 0);
  for (const char* part : {"rotate     weight", " jawOpen about 1 0 0 through ", "\n  outline ", " boundary ",
                           " points\n", "personal field 128x128   98304 bytes"})
    CHECK(contains(r.out, part));
  const std::size_t from = r.out.find("\nbytes:\n"), to = r.out.find("identity parameters");
  REQUIRE(from < to);
  std::istringstream rows(r.out.substr(from + 8, to - from - 8));
  std::size_t sum = 0, count = 0;
  for (std::string line; std::getline(rows, line); ++count)
    sum += std::stoul(line.substr(line.find_last_of(' ') + 1));
  const std::size_t bytes = fs::file_size(table);
  CHECK(count == 11);
  CHECK(sum < bytes);
  CHECK(sum + 20 + 13 * (12 + 3 + 8) >= bytes);  // header, directory, padding, sizes of pictures
}

TEST_CASE("an OBJ file may have its ending in capitals") {
  const ObjFolder folder;
  fs::copy(folder.folder + "/neutral.obj", folder / "SHEET.OBJ");
  CHECK(run_words({"bake", folder / "SHEET.OBJ", "-o", folder / "m.plm", "--base-mesh", "60", "--size", "16"})
            .code == 0);
  // In a folder too, where no file is left out but those that a system hid beside the others.
  fs::rename(folder.folder + "/flap.obj", folder.folder + "/flap.OBJ");
  std::ofstream(folder.folder + "/._flap.OBJ") << "of a file system";
  const Ran r = run_words({"bake", folder.folder, "-o", folder / "m.plm", "--base-mesh", "60", "--size", "16", "--errors"});
  CAPTURE(r.err);
  CHECK(r.code == 0);
  CHECK(contains(r.out, "\nflap to "));
}

TEST_CASE("bake of a folder whose OBJ files have no rest shape says which file that would be") {
  const ObjFolder folder;
  fs::rename(folder.folder + "/neutral.obj", folder.folder + "/Rest.obj");
  check_refused({"bake", folder.folder, "-o", folder / "m.plm"},
                {folder.folder + ": has ", " OBJ files, and none is neutral.obj, the rest shape (--pca"});
  fs::rename(folder.folder + "/Rest.obj", folder.folder + "/neutral.OBJ");
  CHECK(
      run_words({"bake", folder.folder, "-o", folder / "m.plm", "--base-mesh", "60", "--size", "16"}).code ==
      0);
}

TEST_CASE(
    "a material file or a picture that is a pipe, or whose name is none, is missing: nothing waits for it") {
  const ObjFolder folder;
  std::ifstream in(folder.folder + "/neutral.obj");
  const std::string text((std::istreambuf_iterator<char>(in)), {}), pipe = folder.folder + "/pipe.mtl";
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
  const std::vector<std::string> words{"bake",        folder.folder, "-o",     folder / "m.plm",
                                       "--base-mesh", "60",          "--size", "16"};
  for (const std::string& name : {std::string("pipe.mtl"), std::string(5000, 'x')}) {
    std::ofstream(folder.folder + "/neutral.obj") << "mtllib " << name << "\nusemtl a\n" << text;
    const Ran r = run_words(words);
    CHECK(r.code == 0);
    CHECK(contains(r.err, "there is no material file " + folder.folder + "/" + name + ": "));
  }
  std::ofstream(folder.folder + "/plain.mtl") << "newmtl a\nmap_Kd pipe.mtl\n";
  std::ofstream(folder.folder + "/neutral.obj") << "mtllib plain.mtl\nusemtl a\n" << text;
  check_refused(words, {"pipe.mtl: the picture of material 'a' cannot be read"});
}

TEST_CASE("a pipe as an OBJ file is refused, and among those of a folder it is none: nothing waits for it") {
  const ObjFolder folder;
  REQUIRE(::mkfifo((folder / "pipe.obj").c_str(), 0600) == 0);
  check_refused({"bake", folder / "pipe.obj", "-o", folder / "m.plm"}, {"pipe.obj: is a pipe, not a file"});
  REQUIRE(::mkfifo((folder.folder + "/pipe.obj").c_str(), 0600) == 0);
  CHECK(
      run_words({"bake", folder.folder, "-o", folder / "m.plm", "--base-mesh", "60", "--size", "16"}).code ==
      0);
}

TEST_CASE("bake does not write over what it reads, nor into files of other kinds") {
  const ObjFolder folder;
  std::ofstream(folder.folder + "/sheet.mtl") << "newmtl a\n";
  for (const char* name : {"sheet.mtl", "neutral.obj", "print.png", "table.csv"}) {
    const Ran r = run_words({"bake", folder.folder, "-o", folder.folder + "/" + name});
    CHECK(r.code == 2);
    CHECK(contains(r.err, "-o"));
    const Ran embedded =
        run_words({"bake", folder.folder, "-o", folder / "m.plm", "--embed", folder.folder + "/" + name});
    CHECK(embedded.code == 2);
    CHECK(contains(embedded.err, "--embed"));
  }
  CHECK_FALSE(folder.has("m.plm"));
}

TEST_CASE(
    "bake refuses learnt tables of faces for a surface that is none, and tells of a material file that is "
    "missing") {
  const ObjFolder folder;
  fs::copy(kFace + "/learnt.bin", folder.folder + "/learnt.bin");
  check_refused({"bake", folder.folder, "-o", folder / "m.plm"}, {"obj/learnt.bin", "--learnt none"});
  CHECK(run_words({"bake", folder.folder, "-o", folder / "m.plm", "--learnt", "none"}).code == 0);
  fs::remove(fs::path(folder / "m.plm"));
  fs::remove(folder.folder + "/learnt.bin");
  check_refused({"bake", folder.folder, "-o", folder / "m.plm", "--learnt", kFace + "/learnt.bin"},
                {"finds faces", "ibug36"});
  // The corners alone are too few for the aligner: the face would never be found, without a word.
  std::ofstream(folder.folder + "/landmarks.csv")
      << "landmark,vertex\nibug36,0\nibug45,2\nibug48,6\nibug54,8\n";
  check_refused({"bake", folder.folder, "-o", folder / "m.plm", "--learnt", kFace + "/learnt.bin"},
                {"learnt.bin", "needs 39 of them", "the surface has 4"});
  fs::remove(folder.folder + "/landmarks.csv");
  std::ifstream in(folder.folder + "/neutral.obj");
  const std::string text((std::istreambuf_iterator<char>(in)), {});
  std::ofstream(folder.folder + "/neutral.obj") << "mtllib none.mtl\n" << text;
  const Ran r =
      run_words({"bake", folder.folder, "-o", folder / "m.plm", "--base-mesh", "60", "--size", "16"});
  CHECK(r.code == 0);
  CHECK(contains(r.err, "there is no material file " + folder.folder + "/none.mtl"));
  // Nor has it a print.
  const Ran bench = run_words({"bench", "print", "--model", folder / "m.plm"});
  CHECK(bench.code == 1);
  CHECK(contains(bench.err, "m.plm: has no print"));
}

}  // namespace cli_bake_test
