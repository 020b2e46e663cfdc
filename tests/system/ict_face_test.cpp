// A real face of 100 identities and 55 expressions, baked from OBJ files: how true its table is, the profile that fits
// a small flash, and its personal field. Needs the folder in PLIANT_DATA.
#include "ict_face.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "baked_model.hpp"
#include "host/bake/chart_raster.hpp"
#include "host/io/owned.hpp"
#include "random.hpp"
#include "real_data.hpp"
#include "sanitized.hpp"

namespace ict_face_test {

using namespace pliant;
using namespace pliant::host::bake;

namespace {

const std::vector<std::uint8_t>& default_table(BakeReport** report) {
  static BakeReport made;
  static const std::vector<std::uint8_t> table = bake_source(narrow_face(), {}, &made);
  *report = &made;
  return table;
}

}  // namespace

TEST_CASE("the table of a real face at the default size is within 0.3 mm of every mode on average") {
  if (require_data() == nullptr) return;
  BakeReport* report = nullptr;
  const auto& table = default_table(&report);
  CHECK(narrow_face().parameters.size() == kIctIdentities + kIctExpressions);
  CHECK(table.size() < 14'000'000);
  CHECK(report->errors.rest.mean_mm < 0.3f);
  CHECK(report->errors.identity.mean_mm < 0.3f);
  CHECK(report->errors.expression.mean_mm < 0.3f);
  REQUIRE(report->errors.parameters.size() == kIctIdentities + kIctExpressions);
  for (const ParameterError& error : report->errors.parameters) {
    INFO(error.name);
    CHECK(error.off.mean_mm < 0.3f);
  }
}

TEST_CASE("20 identities and 20 expressions in 8 bits fit 512 KiB of flash") {
  if (require_data() == nullptr) return;
  for (const bool relaxed : {false, true}) {
    if (kSanitized && !relaxed) continue;  // the way of the table above, only smaller
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
    "a real person's personal field replaces a hundred and one samples by two, to hundredths of "
    "mm") {
  if (require_data() == nullptr) return;
  BakeReport* report = nullptr;
  BakedModel exact(default_table(&report));
  host::Owned<Cascade> personal(exact.model, PersonalFieldLimits{128, 128});
  personal->set_free(Group::expression);
  exact.cascade.set_free(Group::expression);
  Random random(41);
  double sum = 0;
  float worst = 0;
  int points = 0;
  for (int person = 0; person < 5; ++person) {
    std::vector<float> q(exact.model.parameters().count, 0.0f);
    for (std::size_t k = 0; k < kIctIdentities; ++k) q[k] = clamp(random.normal(), -3, 3);
    REQUIRE(personal->personalise(q.data()) == Status::ok);
    CHECK(personal->sample_count() + kIctIdentities - 1 == exact.cascade.sample_count());
    for (int k = 0; k < 2000; ++k) {
      const Vec2 uv{random.uniform(0, 1), random.uniform(0, 1)};
      if (!exact.model.is_on_surface(uv)) continue;
      const float off =
          length(personal->surface_point(uv, q.data()) - exact.cascade.surface_point(uv, q.data()));
      sum += static_cast<double>(off);
      worst = max(worst, off);
      ++points;
    }
  }
  MESSAGE("personalised surface: " << sum / points << " mm mean, " << worst << " mm worst");
  CHECK(sum / points < 0.002);
  CHECK(worst < 0.05f);
}

}  // namespace ict_face_test
