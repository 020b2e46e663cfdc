// OpenCV's calibration files: what is read of them, what is refused, and what fit, track and render make of them.
#include "host/io/calibration.hpp"

#include <doctest/doctest.h>

#include "cli_run.hpp"
#include "host/io/failure.hpp"
#include "host/io/fit_file.hpp"
#include "random.hpp"

namespace calibration_test {

using namespace pliant;
using namespace cli_run;

namespace {

const std::string kFile =
    "%YAML:1.0\n---\ncalibration_time: \"Thu 01 Jan 2026\"\nnframes: 21\nimage_width: 640\nimage_height: "
    "480\n"
    "board_width: 9\nflags: 0\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
    "   data: [ 5.1e+02, 0., 3.2512e+02, 0., 5.0490000000000003e+02,\n       2.37e+02, 0., 0., 1. ]\n"
    "distortion_coefficients: !!opencv-matrix\n   rows: 1\n   cols: 5\n   dt: d\n"
    "   data: [ -2.5e-01, 7.0e-02, 0., 0., 0. ]\navg_reprojection_error: 2.1e-01\n";

std::string with(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

/// Why a calibration is refused; empty where it is not: then it is one of a camera.
std::string refusal(const std::string& text, ImageSize size = {640, 480}) {
  try {
    const Camera camera = parse_calibration("c.yml", text, size).camera;
    CHECK(camera.f > 0);
    CHECK(is_finite(camera.f + camera.aspect + camera.cx + camera.cy + camera.k1 + camera.k2));
  } catch (const Failure& failure) {
    CHECK(failure.exit_code() == 1);
    CHECK(contains(failure.what(), "c.yml"));
    return failure.what();
  }
  return "";
}

}  // namespace

TEST_CASE("a calibration is read as OpenCV writes it") {
  const Calibration c = parse_calibration("c.yml", kFile, {640, 480});
  CHECK(c.camera.f == doctest::Approx(510));
  CHECK(c.camera.aspect == doctest::Approx(0.99));
  CHECK(c.camera.cx == doctest::Approx(325.12));
  CHECK(c.camera.cy == doctest::Approx(237));
  CHECK(c.camera.k1 == doctest::Approx(-0.25));
  CHECK(c.camera.k2 == doctest::Approx(0.07));
  CHECK(c.off_px == 0);
  CHECK(refusal(with(kFile, "flags: 0", "fisheye_model: 0\ndistortion_model: plumb_bob")) == "");
}

TEST_CASE("a picture size that is a uniform scale of the calibrated one is accepted, any other refused") {
  const Camera half = parse_calibration("c.yml", kFile, {320, 240}).camera;
  CHECK(half.f == doctest::Approx(255));
  CHECK(half.aspect == doctest::Approx(0.99));
  CHECK(half.cx == doctest::Approx(0.5 * 325.62 - 0.5));  // the picture's corner stays, at (-0.5, -0.5)
  CHECK(half.cy == doctest::Approx(0.5 * 237.5 - 0.5));
  CHECK(half.k1 == doctest::Approx(-0.25));
  CHECK(parse_calibration("c.yml", kFile, {1280, 960}).camera.f == doctest::Approx(1020));
  CHECK(contains(refusal(kFile, {640, 360}), "no uniform scale"));
  CHECK(contains(refusal(kFile, {480, 640}), "no uniform scale"));
}

TEST_CASE("other lens models are reduced to two coefficients, or refused when the error is too large") {
  // A third radial coefficient is carried by the other two to a fraction of a pixel.
  const Calibration third =
      parse_calibration("c.yml", with(kFile, "0., 0., 0. ]\navg", "0., 0., -0.02 ]\navg"), {640, 480});
  CHECK(third.off_px > 0);
  CHECK(third.off_px < 0.3f);
  CHECK(third.camera.k1 != doctest::Approx(-0.25));
  // A little tangential distortion stays as an error, and is said.
  const Calibration tangential =
      parse_calibration("c.yml", with(kFile, "0., 0., 0. ]\navg", "1e-3, -5e-4, 0. ]\navg"), {640, 480});
  CHECK(tangential.off_px > 0.1f);
  CHECK(tangential.off_px < 3);
  CHECK(
      contains(refusal(with(kFile, "0., 0., 0. ]\navg", "0.2, 0., 0. ]\navg")), "do not describe this lens"));
  const std::string tilted = with(with(kFile, "cols: 5", "cols: 14"), "0., 0., 0. ]\navg",
                                  "0., 0., 0., 0., 0., 0., 0., 0., 0., 0., 0.1, 0. ]\navg");
  CHECK(contains(refusal(tilted), "tilted"));
  CHECK(contains(refusal(with(kFile, "-2.5e-01", "-1.9")), "cannot be inverted"));
}

TEST_CASE("files without a calibration are refused with a message that names them") {
  const struct {
    const char *from, *to, *part;
  } cases[] = {
      {"image_width: 640\n", "", "has no 'image_width'"},
      {"image_width: 640", "image_width: wide", "not a number: 'wide'"},
      {"image_width: 640", "image_width: 1e99", "out of range"},
      {"image_width: 640", "image_width: .nan", "not a number"},
      {"camera_matrix:", "camera_mattress:", "has no 'camera_matrix.rows'"},
      {"rows: 3", "rows: 4", "not 4 x 3"},
      {"rows: 3", "rows: 1e18", "out of range"},
      {"0., 3.2512e+02", "0.7, 3.2512e+02", "is not [fx 0 cx; 0 fy cy; 0 0 1]"},
      {"5.1e+02", "-5.1e+02", "is not [fx 0 cx; 0 fy cy; 0 0 1]"},
      {"3.2512e+02", "1e8", "a focal length or a principal point that no camera has"},
      {"5.1e+02", "nan", "not a number"},
      {"5.1e+02", "", "not a number"},
      {"0., 0., 1. ]", "0., 0., 1.", ""},
      {"0., 0., 1. ]", "0., 0., 1. ] x", "c.yml: line 14, column 31: end of map not found"},
      {"data: [ -2.5e-01, 7.0e-02, 0., 0., 0. ]", "data: 7",
       "line 19, column 10: 'distortion_coefficients.data' is not a list"},
      {"cols: 5", "cols: 3", "not 1 x 3"},
      {"flags: 0", "image_width: 640", "appears twice"},
      {"flags: 0", "fisheye_model: 1", "fisheye model, which is not supported"},
      {"flags: 0", "distortion_model: equidistant", "distortion model 'equidistant', which is not supported"},
      {"5.0490000000000003e+02", "9e+03", "fy / fx = 17.6"},
      {"5.0490000000000003e+02", "2.5e+02", "fy / fx = 0.49"},
      {"-2.5e-01", "-2.5", "cannot be inverted"},
  };
  for (const auto& c : cases) {
    CAPTURE(c.to);
    const std::string said = refusal(with(kFile, c.from, c.to));
    CAPTURE(said);
    CHECK(said != "");
    CHECK(contains(said, c.part));
  }
  CHECK(contains(refusal("<?xml version=\"1.0\"?>\n<opencv_storage>\n<image_width>640</image_width>\n"),
                 "is XML"));
  CHECK(refusal("") != "");
  CHECK(refusal(std::string(5000, '[')) != "");
  CHECK(refusal(std::string("a: [\n") + std::string(1 << 20, '1')) != "");
}

TEST_CASE("a truncated or damaged calibration is refused or read") {
  Random random(9);
  for (std::size_t cut = 0; cut < kFile.size(); ++cut) refusal(kFile.substr(0, cut));
  CHECK(refusal(kFile.substr(0, kFile.find("camera_matrix"))) != "");
  int refused = 0;
  for (int k = 0; k < 2000; ++k) {
    std::string text = kFile;
    for (int n = 0; n < 3; ++n)
      text[static_cast<std::size_t>(random.uniform(0, static_cast<float>(text.size() - 1)))] =
          static_cast<char>(random.uniform(0, 255));
    refused += refusal(text) != "";
  }
  CHECK(refused > 0);
  CHECK(refused < 2000);
}

TEST_CASE(
    "rendered through a lens, fitted and tracked with its calibration: the truth; without it is worse") {
  const Sequence s;
  const std::string yml = s.put("c.yml",
                                "%YAML:1.0\nimage_width: 200\nimage_height: 160\ncamera_matrix: "
                                "!!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
                                "   data: [ 150., 0., 108., 0., 150., 75., 0., 0., 1. "
                                "]\ndistortion_coefficients: !!opencv-matrix\n   rows: 4\n"
                                "   cols: 1\n   dt: d\n   data: [ -0.35, 0.12, 0., 0. ]\n");
  // Nearer than the sequence itself, so that the face reaches into the corners.
  std::string params = read_file(s / "q.csv");
  for (std::size_t at = params.find(",420,"); at != std::string::npos; at = params.find(",420,"))
    params.replace(at, 5, ",200,");
  s.put("near.csv", params);
  const Ran drawn =
      run_words({"render", s.model, "--params", s / "near.csv", "-o", s / "l.y4m", "--truth", s / "lt.csv",
                 "--truth-points", s / "tp.csv", "--size", "200x160", "--calibration", yml});
  CAPTURE(drawn.err);
  REQUIRE(drawn.code == 0);
  s.put("lp.csv", s.first_points());

  REQUIRE(run_words({"fit", s.model, "--points", s / "lp.csv", "--size", "200x160", "--calibration", yml,
                     "-o", s / "with.json"})
              .code == 0);
  REQUIRE(run_words({"fit", s.model, "--points", s / "lp.csv", "--size", "200x160", "--focal", "150", "-o",
                     s / "without.json"})
              .code == 0);
  const FitFile with_lens = parse_fit("w", read_file(s / "with.json")),
                without = parse_fit("o", read_file(s / "without.json"));
  CHECK(with_lens.camera.k1 == -0.35f);
  CHECK(with_lens.camera.k2 == 0.12f);
  CHECK(with_lens.camera.cx == 108);
  CHECK(without.camera.k1 == 0);
  CHECK(with_lens.rms_px < 0.3f);
  CHECK(without.rms_px > 2 * with_lens.rms_px);

  const auto track = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words = {"track", s.model,     "--frames", s / "l.y4m",
                                      "--out", s / "t.csv", "--truth",  s / "lt.csv"};
    words.insert(words.end(), more.begin(), more.end());
    const Ran r = run_words(words);
    CAPTURE(r.err);
    REQUIRE(r.code == 0);
    return value_after(r.out, "rotation_deg");
  };
  const float known = track({"--init", s / "with.json"});
  const float given = track({"--init", s / "lp.csv", "--calibration", yml});
  const float unknown = track({"--init", s / "lp.csv", "--focal", "150"});
  MESSAGE("rotation error " << known << " degrees with the lens in the fit, " << given
                            << " with the calibration, " << unknown << " without");
  CHECK(known < 2.5f);
  CHECK(given < 2.5f);
  CHECK(unknown > 1.5f * given);
  CHECK(run_words({"fit", s.model, "--points", s / "lp.csv", "--size", "200x160", "--calibration", yml,
                   "--focal", "150", "-o", s / "x.json"})
            .code == 2);
  check_refused({"fit", s.model, "--points", s / "lp.csv", "--size", "200x150", "--calibration", yml, "-o",
                 s / "x.json"},
                {"c.yml", "no uniform scale"});
}

}  // namespace calibration_test
