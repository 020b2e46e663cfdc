// Folders of OBJ files that `pliant bake` refuses: one line for every defect.
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>

#include "host/bake/obj_file.hpp"
#include "obj_folder.hpp"

namespace obj_defects_test {

using namespace obj_folder;
namespace fs = std::filesystem;

namespace {

/// A folder of defects, and the line of the first face of an OBJ file in it.
struct Defects {
  ObjFolder folder{"defects"};
  std::string good = folder.obj(curved_sheet), neutral = folder / "neutral.obj";
  std::string first_face = "f 1/1/ 2/2/ 35/35/ 34/34/\n";
  int face_line = static_cast<int>(std::count(
                      good.begin(), good.begin() + static_cast<std::ptrdiff_t>(good.find("\nf ")), '\n')) +
                  2;

  /// The error with this text as a file.
  std::string error_with(const char* file, const std::string& text) const {
    folder.put(file, text);
    return error_of(folder);
  }
};

}  // namespace

TEST_CASE("each defect of an OBJ file is one line that names the file and the line") {
  const Defects d;
  const std::string &good = d.good, &neutral = d.neutral, &first_face = d.first_face;
  const auto at_face = [&](const std::string& what) {
    return neutral + ":" + std::to_string(d.face_line) + ": " + what;
  };
  const auto neutral_error = [&](const std::string& text) { return d.error_with("neutral.obj", text); };
  CHECK(neutral_error(good) == "");
  CHECK(neutral_error("\xef\xbb\xbf" + good.substr(good.find("\nv ") + 1)) == "");
  CHECK(neutral_error(swapped(good, first_face, first_face.substr(0, first_face.size() - 1) + " # the first\n")) == "");
  CHECK(neutral_error(swapped(good, "v 5.000000 ", "v +5.000000 ")) == "");
  CHECK(neutral_error(swapped(good, "v 5.000000 ", "v +-5.000000 ")) == neutral + ":35: '+-5.000000' is not a number");
  CHECK(neutral_error(swapped(good, "v 5.000000 ", "v 5.000000e-60 ")) == "");  // less than any float: 0
  CHECK(neutral_error(swapped(good, "v 5.000000 ", "v 5e60 ")) == neutral + ":35: '5e60' is not a number");
  CHECK(neutral_error("") == neutral + ": holds no vertices");
  const std::string vertex = ":1: the vertex, which has three numbers x y z, lacks ";
  CHECK(neutral_error("v 1 2\n") == neutral + vertex + "z");
  CHECK(neutral_error("v 1 # 2 3\n") == neutral + vertex + "y");
  CHECK(neutral_error("v") == neutral + vertex + "x");
  CHECK(neutral_error("vt\n") == neutral + ":1: the texture coordinate, which has two numbers u v, lacks u");
  const std::string triangle = "vt 0 0\nvt 1 0\nvt 1 1\nf 1/1 2/2 3/3\n",
                    corners = "v 0 0 0\nv 9 0 0\nv 9 9 0\n";
  CHECK(neutral_error(corners + triangle) == "");
  for (const char* vertices : {"v 1 1 1\nv 1 1 1\nv 1 1 1\n", "v 0 0 0\nv 1 1 1\nv 3 3 3\n"})
    CHECK(neutral_error(vertices + triangle) ==
          d.folder.path.string() + ": has no area: all vertices are in a point or a line");
  CHECK(neutral_error(corners + "vt 0 0\nvt 0 0\nvt 0 0\nf 1/1 2/2 3/3\n") ==
        d.folder.path.string() + ": has no area in the chart: all (u,v) are in a point or a line");
  CHECK(neutral_error("v 1 2 nan\n") == neutral + ":1: 'nan' is not a number");
  CHECK(neutral_error("v 1 2 3\n") == neutral + ": holds no faces");
  CHECK(neutral_error(swapped(good, first_face, "f 1/1/ 2/2/\n")) ==
        at_face("a face has at least three corners"));
  CHECK(neutral_error(swapped(good, first_face, "f 1/1/ 2/2/ 9999/35/ 34/34/\n")) ==
        at_face("there is no vertex 9999"));
  CHECK(neutral_error(swapped(good, first_face, "f 1/1/ 2/2/ 0/35/ 34/34/\n")) ==
        at_face("there is no vertex 0"));
  CHECK(neutral_error(swapped(good, first_face, "f 1/1/ 2/2/ x/35/ 34/34/\n")) ==
        at_face("'x' is not an index"));
  CHECK(neutral_error(swapped(good, first_face, "f 1/1/ 2/2/ 35/9999/ 34/34/\n")) ==
        at_face("there is no texture coordinate 9999"));
  CHECK(neutral_error(swapped(good, first_face, "f 1 2 35 34\n")) ==
        at_face("the face has no texture coordinates"));
  CHECK(
      neutral_error(swapped(good, first_face, "f 1/1/ 2/2/ 35/34/ 34/35/\n")) ==
      at_face("the chart has a fold-over at this face: its corners are reversed, its (u,v) are mirrored, or "
              "they wrap around"));
  CHECK(neutral_error(swapped(good, "v 5.000000 ", "v 5e9 ")) ==
        neutral + ": vertex 33 is more than 100 m from the origin: check it and --unit");
  CHECK(neutral_error(swapped(good, first_face, first_face + first_face)) ==
        neutral + ":" + std::to_string(d.face_line + 1) +
            ": the face and its neighbour have opposite windings");
  CHECK(neutral_error(swapped(good, "vt 0.100000", "vt -0.10000")) ==
        at_face("a texture coordinate of the face is outside 0 to 1"));
}

TEST_CASE("a line of an OBJ file that ends in a backslash goes on in the next one, a comment does not") {
  const Defects d;
  const auto error = [&](const std::string& from, const std::string& to) {
    return d.error_with("neutral.obj", swapped(d.good, from, to));
  };
  const std::string& face = d.first_face;
  CHECK(error(face, "f 1/1/ \\\n2/2/\\\r\n  35/35/ \\\n\\\n34/34/\n") == "");
  CHECK(error("# a comment\n", "# from E:\\models\\\n") == "");
  CHECK(error(face, face.substr(0, face.size() - 1) + " # in E:\\\n") == "");
  // An error is where its line starts, and lines are those of the file.
  CHECK(error(face, "f 1/1/ \\\n2/2/ \\\n9999/35/ 34/34/\n") ==
        d.neutral + ":" + std::to_string(d.face_line) + ": there is no vertex 9999");
  CHECK(error(face, "f 1/1/ 2/2/ \\\n35/35/ 34/34/\nf 9999/1/ 2/2/ 3/3/\n") ==
        d.neutral + ":" + std::to_string(d.face_line + 2) + ": there is no vertex 9999");
  // The last line has none to go on in.
  CHECK(d.error_with("neutral.obj", d.good + "\\\n") == "");
  CHECK(d.error_with("neutral.obj", "v 1 2 3\\") == d.neutral + ":1: '3\\' is not a number");
}

TEST_CASE("two carriage returns and a line feed end one line of an OBJ file: a polygon that goes on keeps its corners") {
  const Folder folder("written_twice");
  const host::bake::ObjMesh mesh = host::bake::read_obj(
      folder.put("quad.obj", "v 0 0 0\r\r\nv 1 0 0\r\r\nv 1 1 0\r\r\nv 0 1 0\r\r\nf 1 2 3 \\\r\r\n4\r\r\n"));
  CHECK(mesh.corners.size() == 4);
  CHECK(mesh.polygon_line.at(0) == 5);
}

TEST_CASE("a file of an OBJ folder that differs from neutral.obj in more than places is refused by name") {
  const Defects d;
  const std::string &good = d.good, &neutral = d.neutral, &first_face = d.first_face;
  const std::string smile = d.folder / "mouthSmile_L.obj";
  d.folder.put("neutral.obj", good);
  const auto smile_error = [&](const std::string& text) { return d.error_with("mouthSmile_L.obj", text); };
  CHECK(smile_error("v 1 2 3\n") == smile + ": has 1 vertices, not 1089 as " + neutral);
  CHECK(smile_error(swapped(good, first_face, "")) == smile + ": has 1023 faces, not 1024 as " + neutral);
  CHECK(smile_error(swapped(good, first_face, "f 1/1/ 2/2/ 35/35/\n")) ==
        smile + ": has 4095 corners of faces, not 4096 as " + neutral);
  CHECK(smile_error(swapped(good, first_face, "f 1/1/ 2/2/ 36/35/ 34/34/\n")) ==
        smile + ":" + std::to_string(d.face_line) + ": the face differs from that of " + neutral);
}

TEST_CASE("bad landmarks and a missing rest shape of an OBJ folder are refused by name") {
  const Defects d;
  const ObjFolder& folder = d.folder;
  const std::string csv = folder / "landmarks.csv";
  folder.put("neutral.obj", d.good);
  const auto csv_error = [&](const std::string& text) { return d.error_with("landmarks.csv", text); };
  CHECK(csv_error("landmark,vertex\nibug30,5\n") == "");
  CHECK(csv_error("\xef\xbb\xbflandmark,vertex\r\nibug30,5\r\n") == "");
  CHECK(csv_error("vertex, landmark\n 5 ,\"ibug30\"\n  \n6,ibug30,\n") ==
        csv + ": line 4: 3 cells, but the header has 2");
  CHECK(csv_error("vertex, landmark\n 5 ,\"ibug30\"\n  \n6,ibug30\n") ==
        csv + ": line 4: the landmark 'ibug30' appears twice");
  CHECK(csv_error("name,vertex\n") == csv + ": has no column 'landmark'");
  CHECK(csv_error("landmark,vertex\nibug30,1.5\n") ==
        csv + ": line 2: column 'vertex': not a number of the kind 0, 1, 2: '1.5'");
  CHECK(csv_error("landmark,vertex\n,5\n") == csv + ": line 2: a name is empty");
  CHECK(csv_error("landmark,vertex\n\nibug30,1089\n") == csv + ": line 3: there is no vertex 1089 on a face");
  fs::remove(folder.path / "landmarks.csv");

  fs::remove(folder.path / "neutral.obj");
  CHECK(error_of(folder).find("nor OBJ files") != std::string::npos);
  folder.put("jawOpen.obj", d.good);
  folder.put("jawLeft.obj", d.good);
  CHECK(error_of(folder) == folder.path.string() +
                                ": has 2 OBJ files, and none is neutral.obj, the rest shape (--pca N takes "
                                "all as scans)");
  fs::remove(folder.path / "jawLeft.obj");  // the only file is the rest shape
  CHECK(error_of(folder) == "");
}

TEST_CASE("more landmarks or parameters than a table can hold are refused before anything is baked") {
  Defects d;
  std::string csv = "landmark,vertex\n";
  for (int k = 0; k < 4097; ++k) csv += "l" + std::to_string(k) + ",5\n";
  d.folder.put("neutral.obj", d.good);
  CHECK(d.error_with("landmarks.csv", csv) ==
        d.folder.path.string() + ": has 4097 landmarks, more than 4096");
  fs::remove(d.folder.path / "landmarks.csv");
  d.folder.n = 3;
  const std::string small = d.folder.obj(curved_sheet);
  d.folder.put("neutral.obj", small);
  for (int k = 0; k < 193; ++k)
    d.folder.put("e" + std::to_string(k) + ".obj", swapped(small, "v -5.", "v -6."));
  CHECK(error_of(d.folder) ==
        d.folder.path.string() +
            ": has 193 parameters, more than 192: choose some with --identities and --expressions");
}

}  // namespace obj_defects_test
