// A real face of 100 identities and 55 expressions, baked from OBJ files: how true its table is, the profile that fits
// a small flash, and its folded neutral. Needs the folder in PLIANT_DATA; skips plainly.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <sstream>

#include "bake/chart_raster.hpp"
#include "bake/size_table.hpp"
#include "baked_model.hpp"
#include "cli/files.hpp"
#include "cli/owned.hpp"
#include "random.hpp"
#include "scratch_folder.hpp"

using namespace pliant;
using namespace pliant::bake;

namespace {

/// The narrow face (no ears, neck, scalp) of ict_face.bin; README.txt beside it tells the format.
struct IctFace {
  std::string bytes;
  std::array<std::uint32_t, 8>
      n;  // vertices, quads, triangles, identities, expressions, landmarks, narrow v. and q.
  std::vector<std::string> modes;

  explicit IctFace(const std::string& folder) : bytes(cli::read_file(folder + "/ict_face.bin")) {
    std::memcpy(n.data(), bytes.data() + 8, sizeof n);
    std::istringstream lines(cli::read_file(folder + "/modes.txt"));
    for (std::string line; std::getline(lines, line);)
      if (!line.empty() && line[0] != '#') modes.push_back(line.substr(0, line.find_first_of(" \t")));
    REQUIRE(modes.size() == n[3] + n[4]);
  }

  template <class T>
  T at(std::size_t offset, std::size_t k) const {
    T value;
    std::memcpy(&value, bytes.data() + offset + sizeof(T) * k, sizeof(T));
    return value;
  }
  std::size_t uv() const { return 40 + 12u * n[0]; }
  std::size_t quads() const { return uv() + 8u * n[0]; }
  std::size_t landmarks() const { return quads() + 16u * n[1] + 12u * n[2]; }
  std::size_t deltas(std::size_t mode) const { return landmarks() + 4u * n[5] + 12u * n[0] * mode; }

  /// Everything of an OBJ file behind its positions: the same in each.
  std::string topology() const {
    std::string text;
    char line[96];
    for (std::size_t v = 0; v < n[6]; ++v) {
      std::snprintf(line, sizeof line, "vt %.6f %.6f\n", static_cast<double>(at<float>(uv(), 2 * v)),
                    static_cast<double>(at<float>(uv(), 2 * v + 1)));
      text += line;
    }
    for (std::size_t f = 0; f < n[7]; ++f) {
      text += "f";
      for (std::size_t k = 0; k < 4; ++k) {
        const std::string id = std::to_string(at<std::uint32_t>(quads(), 4 * f + k) + 1);
        text += " " + id + "/" + id;
      }
      text += "\n";
    }
    return text;
  }

  std::string positions(int mode) const {
    std::string text;
    char line[96];
    for (std::size_t v = 0; v < n[6]; ++v) {
      double p[3];
      for (std::size_t c = 0; c < 3; ++c)
        p[c] = static_cast<double>(at<float>(40, 3 * v + c)) +
               (mode < 0 ? 0.0
                         : static_cast<double>(at<float>(deltas(static_cast<std::size_t>(mode)), 3 * v + c)));
      std::snprintf(line, sizeof line, "v %.5f %.5f %.5f\n", p[0], p[1], p[2]);
      text += line;
    }
    return text;
  }

  void write(const Folder& folder) const {
    const std::string rest = topology();
    folder.file("neutral.obj", positions(-1) + rest);
    std::string csv = "landmark,vertex\n";
    for (std::size_t k = 0; k < n[5]; ++k) {
      char line[40];
      std::snprintf(line, sizeof line, "ibug%02zu,%u\n", k, at<std::uint32_t>(landmarks(), k));
      csv += line;
    }
    folder.file("landmarks.csv", csv);
    for (std::size_t m = 0; m < modes.size(); ++m) {
      const std::string digits = std::to_string(m);
      const std::string identity =
          "identity" + std::string(3 - std::min<std::size_t>(3, digits.size()), '0') + digits;
      folder.file((m < n[3] ? identity : modes[m]) + ".obj", positions(static_cast<int>(m)) + rest);
    }
  }
};

const char* data_folder() {
  return std::getenv("PLIANT_DATA");
}

/// Read from its OBJ files once, with the chart as it is and relaxed.
const Source& narrow_face(bool relaxed = false) {
  static const std::vector<Source> sources = [] {
    const Folder folder("ict_face");
    IctFace(std::string(data_folder()) + "/ict").write(folder);
    BakeOptions options;
    options.source = folder.path.string();
    options.unit_mm = 10;
    std::vector<Source> read{read_source(options)};
    options.relaxes_chart = true;
    read.push_back(read_source(options));
    return read;
  }();
  return sources[relaxed ? 1 : 0];
}

const std::vector<std::uint8_t>& default_table(BakeReport** report) {
  static BakeReport made;
  static const std::vector<std::uint8_t> table = bake_source(narrow_face(), {}, &made);
  *report = &made;
  return table;
}

}  // namespace

TEST_CASE("the table of a real face at the default size is within 0.3 mm of every mode on average") {
  if (data_folder() == nullptr) {
    MESSAGE("skipped: PLIANT_DATA is not set");
    return;
  }
  BakeReport* report = nullptr;
  const auto& table = default_table(&report);
  CHECK(narrow_face().parameters.size() == 155);
  CHECK(table.size() < 14'000'000);
  CHECK(report->errors.rest.mean_mm < 0.3f);
  CHECK(report->errors.identity.mean_mm < 0.3f);
  CHECK(report->errors.expression.mean_mm < 0.3f);
  REQUIRE(report->errors.parameters.size() == 155);
  for (const ParameterError& error : report->errors.parameters) {
    INFO(error.name);
    CHECK(error.off.mean_mm < 0.3f);
  }
}

TEST_CASE("20 identities and 20 expressions in 8 bits fit 512 KiB of flash") {
  if (data_folder() == nullptr) {
    MESSAGE("skipped: PLIANT_DATA is not set");
    return;
  }
  for (const bool relaxed : {false, true}) {
    Source small = narrow_face(relaxed);
    ParameterChoice choice;
    choice.identities = choice.expressions = 20;
    choose_parameters(small, choice);
    BakeOptions options;
    options.size = 56;
    options.bits = 8;
    BakeReport report;
    CHECK(bake_source(small, options, &report).size() <= 512 * 1024);
    CHECK(report.errors.identity.mean_mm < (relaxed ? 0.12f : 0.5f));
    CHECK(report.errors.expression.mean_mm < (relaxed ? 0.12f : 0.5f));
    for (const char* name : {"jawOpen", "eyeBlinkLeft", "mouthSmileRight", "browInnerUpLeft"}) {
      const auto has_name = [name](const SourceParameter& p) { return p.name == name; };
      CHECK(std::any_of(small.parameters.begin(), small.parameters.end(), has_name));
    }
  }
  for (const float area : chart_areas(narrow_face(true).uv, narrow_face(true).triangles)) CHECK(area < 0);
}

TEST_CASE(
    "a real person's folded neutral costs two samples for a hundred and one, and is true to hundredths of "
    "mm") {
  if (data_folder() == nullptr) {
    MESSAGE("skipped: PLIANT_DATA is not set");
    return;
  }
  BakeReport* report = nullptr;
  BakedModel exact(default_table(&report));
  cli::Owned<Cascade> folded(exact.model, FoldLimits{64, 64});
  folded->set_free(Group::expression);
  exact.cascade.set_free(Group::expression);
  Random random(41);
  double sum = 0;
  float worst = 0;
  int points = 0;
  for (int person = 0; person < 5; ++person) {
    std::vector<float> q(exact.model.parameters().count, 0.0f);
    for (std::size_t k = 0; k < 100; ++k) q[k] = clamp(random.normal(), -3, 3);
    REQUIRE(folded->fold(q.data()) == Status::ok);
    CHECK(folded->sample_count() + 99 == exact.cascade.sample_count());
    for (int k = 0; k < 2000; ++k) {
      const Vec2 uv{random.uniform(0, 1), random.uniform(0, 1)};
      if (!exact.model.is_on_surface(uv)) continue;
      const float off =
          length(folded->surface_point(uv, q.data()) - exact.cascade.surface_point(uv, q.data()));
      sum += static_cast<double>(off);
      worst = max(worst, off);
      ++points;
    }
  }
  MESSAGE("folded neutral: " << sum / points << " mm mean, " << worst << " mm worst");
  CHECK(sum / points < 0.1);
  CHECK(worst < 2);
}
