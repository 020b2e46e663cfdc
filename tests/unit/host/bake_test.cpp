// From a source to the bytes of a model table: fields on grids, quantisation, which parameters, how faithful.
#include "host/bake/bake.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "bake_sheet.hpp"
#include "baked_model.hpp"
#include "host/bake/embedded.hpp"
#include "host/bake/field_grid.hpp"
#include "host/bake/landmark_names.hpp"
#include "host/bake/opened_table.hpp"
#include "host/bake/record_limit.hpp"
#include "host/bake/size_table.hpp"
#include "host/bake/source_error.hpp"
#include "host/bake/table_writer.hpp"

namespace bake_test {

using namespace pliant;
using namespace pliant::host::bake;

namespace {

FieldGrid bump(int n, int components) {
  FieldGrid grid;
  grid.width = n;
  grid.height = n;
  grid.components = components;
  grid.u0 = 0.25f;
  grid.u1 = 0.75f;
  grid.v0 = 0.5f;
  grid.v1 = 1;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i)
      for (int c = 0; c < components; ++c) {
        const bool rim = i == 0 || j == 0 || i == n - 1 || j == n - 1;
        grid.samples.push_back(rim ? 0
                                   : static_cast<float>(c + 1) * std::sin(0.3f * static_cast<float>(i * j)));
      }
  return grid;
}

}  // namespace

TEST_CASE("the table holds what was put in, to half a quantisation step") {
  for (const int bits : {16, 8}) {
    TableWriter writer;
    writer.add_parameter({"one", Group::identity, -3, 3, 1});
    writer.add_parameter({"a_name_of_just_27_letters_x", Group::expression, 0, 1, 0.25f});
    const FieldGrid vectors = bump(17, 3), weights = bump(9, 1);
    const auto v = writer.add_field(vectors, bits), w = writer.add_field(weights, bits);
    const auto mirrored = writer.add_mirrored(v);
    CascadeRecord r = empty_record(Operation::constant);
    r.field = v;
    writer.add_record(r);
    r = empty_record(Operation::rotate);
    r.source[0] = 0;
    r.parameter[0] = 1;
    r.weight = w;
    r.axis[1] = 1;
    writer.add_record(r);
    writer.add_landmark({"here", {0.25f, 0.75f}});
    writer.add_curve({"line", CurveKind::brow, {{0, 0}, {0.5f, 0.25f}, {1, 1}}});
    writer.set_base_mesh({{0, 0}, {0, 1}, {1, 1}}, {2, 0, 1});
    writer.set_mask({2, 1, {0, 1}});
    writer.set_albedo({3, 1, {7, 8, 9}});
    const BakedModel baked(writer.bytes());
    const Model& model = baked.model;

    CHECK(std::string(model.parameters()[1].name) == "a_name_of_just_27_letters_x");
    CHECK(model.parameters()[1].sd == 0.25f);
    CHECK(model.landmarks()[0].v == 0.75f);
    CHECK(model.curves()[0].point_count == 3);
    CHECK(model.curve_points()[1].y == 0.25f);
    CHECK(model.base_uv().count == 3);
    CHECK(model.mask().pixels[1] == 1);
    CHECK(model.albedo().width == 3);
    CHECK(model.albedo().pixels[2] == 9);
    CHECK(model.cascade()[1].weight == w);
    CHECK(model.cascade()[1].parameter[1] == kNone);

    const float most = bits == 16 ? 32767.0f : 127.0f;
    for (int j = 0; j < 17; ++j)
      for (int i = 0; i < 17; ++i) {
        const Vec2 uv{0.25f + 0.5f * static_cast<float>(i) / 16, 0.5f + 0.5f * static_cast<float>(j) / 16};
        const Vec3 p = pliant::sample(model, model.fields()[v], uv);
        const Vec3 m = pliant::sample(model, model.fields()[mirrored], {1 - uv.x, uv.y});
        const float* s = &vectors.samples[static_cast<std::size_t>(3 * (17 * j + i))];
        for (const float off : {p.x - s[0], (p.y - s[1]) / 2, (p.z - s[2]) / 3})
          CHECK(std::fabs(off) <= 0.51f / most);
        CHECK(m.x == -p.x);
        CHECK(m.y == p.y);
      }
    const float w7 = pliant::sample(model, model.fields()[w], {0.25f + 0.5f * 3 / 8, 0.5f + 0.5f * 5 / 8}).x;
    CHECK(std::fabs(w7 - weights.samples[5 * 9 + 3]) <= 0.51f / most);
  }
}

TEST_CASE("a field is cut to its support, with a rim of zeros, and coarser where it is smooth") {
  Source source = sheet(129, dome);
  source.parameters.push_back({"smooth", Group::expression, 0, 1, 1});
  source.parameters.push_back({"sharp", Group::expression, 0, 1, 1});
  SourceShape smooth{0, {}, {}, {}, {}, -1}, sharp{1, {}, {}, {}, {}, -1};
  for (const Vec2 uv : source.uv) {
    const float r = 4 * length(uv - Vec2{0.5f, 0.5f});
    smooth.displacement.push_back({0, 0, r < 1 ? (1 - r * r) * (1 - r * r) : 0});
    sharp.displacement.push_back(
        {0, uv.x > 0.3f && uv.x < 0.42f && uv.y > 0.3f && uv.y < 0.4f ? 4.0f : 0.0f, 0});
  }
  source.shapes = {smooth, sharp};
  BakeOptions options;
  options.size = 128;
  BakeReport report;
  BakedModel baked(bake_source(source, options, &report));
  const Field &neutral = baked.model.fields()[0], &a = baked.model.fields()[1], &b = baked.model.fields()[2];
  CHECK(neutral.width == 256);
  CHECK(a.u0 > 0.2f);
  CHECK(a.u1 < 0.8f);
  CHECK(a.width < 40);   // of 64 at full resolution
  CHECK(b.width >= 17);  // of 128, cut to an eighth
  CHECK(b.width <= 30);
  CHECK(report.errors.rest.max_mm < 0.01f);
  CHECK(report.errors.expression.max_mm > 0.5f);  // a step cannot be sampled; the report says so
  CHECK(report.errors.parameters[0].off.max_mm < 0.07f);
  const auto at = [&](Vec2 uv, float q0, float q1) { return baked.at(uv, {q0, q1}); };
  CHECK(length(at({0.5f, 0.5f}, 1, 0) - at({0.5f, 0.5f}, 0, 0) - Vec3{0, 0, 1}) < 0.05f);
  CHECK(length(at({0.9f, 0.5f}, 1, 1) - at({0.9f, 0.5f}, 0, 0)) == 0);
}

TEST_CASE("a surface that fills a part of the chart keeps its shapes where it meets the chart's border") {
  // As wide as the chart, and lower: its lower corners are on the border beside samples that have no surface.
  for (const float height : {0.25f, 0.33f, 0.707f}) {
    Source source = sheet(33, [](Vec2 uv) { return Vec3{300 * (uv.x - 0.5f), 300 * (0.5f - uv.y), 0}; });
    source.base_uv.clear();
    source.base_corners.clear();
    for (Vec2& uv : source.uv) uv.y *= height;
    source.parameters = {{"bend", Group::expression, -1, 1, 0.5f}};
    source.shapes = {{0, {}, {}, {}, {}, -1}};
    for (const Vec2 uv : source.uv) source.shapes[0].displacement.push_back({0, 0, 40 + 30 * uv.x * uv.y});
    BakeReport report;
    (void)bake_source(source, {}, &report);
    CHECK(report.errors.expression.max_mm < 0.2f);
  }
}

TEST_CASE("eight bits and a smaller size make a smaller table that is still close") {
  Source source = sheet(65, dome);
  source.parameters.push_back({"wave", Group::identity, -3, 3, 1});
  SourceShape wave{0, {}, {}, {}, {}, -1};
  for (const Vec2 uv : source.uv)
    wave.displacement.push_back({0, 0, 5 * std::sin(6 * uv.x) * std::sin(9 * uv.y)});
  source.shapes = {wave};
  BakeOptions fine, coarse;
  coarse.bits = 8;
  coarse.size = 64;
  BakeReport a, b;
  CHECK(bake_source(source, fine, &a).size() > 3 * bake_source(source, coarse, &b).size());
  CHECK(a.errors.identity.max_mm <= fine.tolerance_mm);
  CHECK(b.errors.identity.max_mm < 0.3f);
}

TEST_CASE("a name too long for a table is refused") {
  const std::string most(27, 'x'), more(28, 'x');
  TableWriter writer;
  CHECK_NOTHROW(writer.add_parameter({most, Group::identity, -1, 1, 1}));
  CHECK_THROWS_AS(writer.add_parameter({more, Group::identity, -1, 1, 1}), SourceError);
  CHECK_THROWS_AS(writer.add_landmark({more, {0.5f, 0.5f}}), SourceError);
  CHECK_THROWS_AS(writer.add_curve({more, CurveKind::lid, {{0, 0}, {1, 1}}}), SourceError);
  CHECK_THROWS_AS(writer.add_landmark({"", {0.5f, 0.5f}}), SourceError);
}

TEST_CASE("a table that could not be opened is refused") {
  Source source = sheet(9, dome);
  source.parameters = {{"a", Group::expression, 0, 1, 1}};
  CHECK(!bake_source(source, {}).empty());
  Source twice = source;
  twice.parameters.push_back(source.parameters[0]);
  CHECK_THROWS_WITH_AS(bake_source(twice, {}), doctest::Contains("cannot be opened"), SourceError);
  Source outside = source;
  outside.landmarks.push_back({"l", {1.5f, 0.5f}});
  CHECK_THROWS_AS(bake_source(outside, {}), SourceError);
}

TEST_CASE("a base mesh of the source whose corners run the wrong way is refused") {
  Source source = sheet(9, dome);
  CHECK_NOTHROW((void)bake_source(source, {}));
  for (const std::vector<std::uint16_t>& corners : {std::vector<std::uint16_t>{0, 2, 1, 2, 0, 3}, {2, 0, 1, 2, 0, 3}}) {
    source.base_corners = corners;
    CHECK_THROWS_WITH_AS((void)bake_source(source, {}), doctest::Contains("corners run clockwise"), SourceError);
  }
}

TEST_CASE("the array of a file has the file's name, unless that is no name in C and C++") {
  CHECK(array_name("face.cpp") == "face");
  CHECK(array_name("some.where/my-face.v2.cpp") == "my_face");
  for (const char* taken : {"new", "class", "int", "restrict", "typeof", "co_await", "size_t", "main", "std"})
    CHECK(array_name(std::string("folder/") + taken + ".cpp") == std::string("model_") + taken);
  for (const char* taken :
       {"log", "exp", "sinf", "sqrtl", "time", "signal", "free", "index", "wmemset", "abort"})
    CHECK(array_name(std::string(taken) + ".c") == std::string("model_") + taken);
  for (const char* name : {"newer", "logo", "self", "wolf", "f", "model", "head", "surface"})
    CHECK(array_name(std::string(name) + ".cpp") == name);
  CHECK(array_name("3d.cpp") == "model_3d");
  CHECK(array_name("_Bool.cpp") == "model__Bool");
  CHECK(array_name(".cpp") == "model_");
}

TEST_CASE("landmarks whose names are nearly those that the library asks for are told of, others are not") {
  const struct {
    const char *name, *warning;  // empty: none
  } cases[] = {
      {"ibug01", ""},
      {"nose_tip", ""},
      {"chin", ""},
      {"ibug", ""},
      {"ibug_left", ""},
      {"ibug1", "the landmark 'ibug1' is not found by the name 'ibug01': if it is that one, rename it"},
      {"ibug001", "the landmark 'ibug001' is not found by the name 'ibug01': if it is that one, rename it"},
      {"iBUG_00", "the landmark 'iBUG_00' is not found by the name 'ibug00': if it is that one, rename it"},
      {"noseTip", "the landmark 'noseTip' is not found by the name 'nose_tip': if it is that one, rename it"},
      {"ibug68", "the landmark 'ibug68' is none of iBUG's, which are ibug00 to ibug67, counted from 0"},
  };
  for (const auto& c : cases) {
    Source source = sheet(9, dome);
    source.landmarks.push_back({c.name, {0.5f, 0.5f}});
    CHECK(misspelt_landmarks(source) ==
          (*c.warning == '\0' ? std::vector<std::string>{} : std::vector<std::string>{c.warning}));
  }
}

TEST_CASE("an embedded table is the table") {
  const std::vector<std::uint8_t> table{0x50, 0x4c, 0x0a, 0xff};
  const std::string source = embedded(table, "face");
  CHECK(source.find("alignas(4) const unsigned char face[] = {\n  0x50, 0x4c, 0x0a, 0xff,\n};") !=
        std::string::npos);
  CHECK(source.find("const size_t face_bytes = sizeof face;") != std::string::npos);
}

TEST_CASE(
    "the error of a table is measured on its bytes: a source moved by a known distance is that far away") {
  Source source = sheet(33, dome);
  source.parameters = {{"wide", Group::identity, -3, 3, 0.5f}, {"turn", Group::expression, 0, 0.6f, 0.2f}};
  source.shapes = {{0, {}, {}, {}, {}, -1}, {1, {}, {}, {1, 0, 0}, {0, 0, -30}, -1}};
  for (const Vec2 uv : source.uv) {
    source.shapes[0].displacement.push_back({10 * (uv.x - 0.5f), 0, 0});
    source.shapes[1].weight.push_back(uv.y);
  }
  BakeReport report;
  const auto table = bake_source(source, {}, &report);
  CHECK(report.table_bytes == table.size());
  CHECK(report.errors.rest.max_mm < 0.01f);
  CHECK(report.errors.identity.max_mm < 0.02f);
  CHECK(report.errors.expression.max_mm < 0.05f);
  REQUIRE(report.errors.parameters.size() == 2);
  CHECK(report.errors.parameters[1].name == "turn");

  Source moved = source;
  for (std::size_t v = 0; v < moved.neutral.size() / 2; ++v) moved.neutral[v].z += 0.25f;
  const OpenedTable opened(table);
  REQUIRE(opened.status() == Status::ok);
  const Reconstruction off = reconstruct(opened.model(), moved);
  CHECK(off.rest.mean_mm == doctest::Approx(0.125).epsilon(0.02));
  CHECK(off.rest.p95_mm == doctest::Approx(0.25).epsilon(0.02));
  CHECK(off.rest.max_mm == doctest::Approx(0.25).epsilon(0.02));
  Source wider = source;
  for (Vec3& d : wider.shapes[0].displacement) d = d + Vec3{0, 2, 0};  // one at one sd, which is 0.5
  CHECK(reconstruct(opened.model(), wider).identity.mean_mm == doctest::Approx(1).epsilon(0.02));
  CHECK(reconstruct(opened.model(), wider).expression.max_mm < 0.05f);
  CHECK(OpenedTable({1, 2, 3, 4}).status() == Status::truncated);
}

namespace {

/// A sheet with three identities and the expressions named, each a lift of its own height.
Source with_expressions(const std::vector<std::string>& names) {
  Source source = sheet(9, dome);
  float height = 0;
  const auto add = [&](const std::string& name, Group group) {
    height += 1;
    source.shapes.push_back({source.parameters.size(), {}, {}, {}, {}, -1});
    for (const Vec2 uv : source.uv) source.shapes.back().displacement.push_back({0, 0, height * uv.x * uv.y});
    source.parameters.push_back({name, group, 0, 1, 1});
  };
  for (const char* name : {"identity000", "identity001", "identity002"}) add(name, Group::identity);
  for (const std::string& name : names) add(name, Group::expression);
  return source;
}

std::vector<std::string> names_after(Source source, const ParameterChoice& choice) {
  choose_parameters(source, choice);
  std::vector<std::string> names;
  for (const SourceParameter& p : source.parameters) names.push_back(p.name);
  REQUIRE(source.shapes.size() == names.size());
  for (std::size_t k = 0; k < names.size(); ++k) CHECK(source.shapes[k].parameter == k);
  return names;
}

using Names = std::vector<std::string>;

}  // namespace

TEST_CASE(
    "of the parameters of a source the first identities and the most useful expressions can be kept, pairs "
    "whole") {
  const Source source = with_expressions(
      {"eyeLookUpLeft", "mouthSmileLeft", "flap", "wave", "mouthSmileRight", "jawOpen", "eyeLookUpRight"});
  const auto kept = [&](int identities, int expressions, Names named = {}) {
    return names_after(source, {identities, expressions, std::move(named)});
  };
  CHECK(kept(-1, -1).size() == 10);
  CHECK(kept(1, -1).size() == 8);
  CHECK(kept(0, 1) == Names{"jawOpen"});
  CHECK(kept(0, 2) == Names{"wave", "jawOpen"});  // half a smile is none; "wave" moves more than "flap"
  CHECK(kept(0, 3) == Names{"mouthSmileLeft", "mouthSmileRight", "jawOpen"});
  CHECK(kept(2, 5) == Names{"identity000", "identity001", "eyeLookUpLeft", "mouthSmileLeft",
                            "mouthSmileRight", "jawOpen", "eyeLookUpRight"});
  CHECK(kept(0, 99).size() == 7);
  CHECK(kept(1, -1, {"flap", "jawOpen"}) == Names{"identity000", "flap", "jawOpen"});
  CHECK_THROWS_WITH_AS(kept(0, 0, {"jawopen"}), "--expressions: there is no expression 'jawopen'",
                       SourceError);
  CHECK_THROWS_WITH_AS(kept(0, 0, {"identity000"}), "--expressions: there is no expression 'identity000'",
                       SourceError);
}

TEST_CASE("a mirrored parameter keeps the parameter whose samples it uses, and is refused without it") {
  Source source = with_expressions({"jawOpen", "mouthSmileLeft", "mouthSmileRight"});
  source.shapes[5].displacement.clear();
  source.shapes[5].mirror_of = 4;
  Source both = source;
  choose_parameters(both, {0, -1, {"mouthSmileLeft", "mouthSmileRight"}});
  REQUIRE(both.shapes.size() == 2);
  CHECK(both.shapes[1].mirror_of == 0);
  CHECK_THROWS_WITH_AS(choose_parameters(source, {0, -1, {"mouthSmileRight"}}),
                       "--expressions: mouthSmileRight is the mirror image of mouthSmileLeft: name both",
                       SourceError);
}

TEST_CASE("tables of several sizes: bytes and errors in one go, and the finest within a number of bytes") {
  Source source = sheet(65, [](Vec2 uv) {
    return dome(uv) + Vec3{0, 0, 2 * std::sin(40 * uv.x) * std::sin(30 * uv.y)};
  });
  source.parameters = {{"jawOpen", Group::expression, 0, 1, 1}};
  source.shapes = {{0, {}, {}, {}, {}, -1}};
  for (const Vec2 uv : source.uv) source.shapes[0].displacement.push_back({0, std::sin(35 * uv.x) * uv.y, 0});
  const auto rows = compare_sizes(source, {}, {16, 32, 64});
  REQUIRE(rows.size() == 6);
  for (std::size_t k = 0; k < 6; ++k) {
    CHECK(rows[k].bits == (k < 3 ? 16 : 8));
    CHECK(rows[k].expressions == 1);
    if (k % 3 == 0) continue;
    CHECK(rows[k].table_bytes > 2 * rows[k - 1].table_bytes);
    CHECK(rows[k].errors.rest.mean_mm < rows[k - 1].errors.rest.mean_mm);
    CHECK(rows[k].errors.expression.mean_mm < rows[k - 1].errors.expression.mean_mm);
  }
  const SizeRow fitting = finest_within(source, {}, rows[5].table_bytes);
  CHECK(fitting.size == 64);
  CHECK(fitting.bits == 8);
  CHECK(fitting.table_bytes == rows[5].table_bytes);
  CHECK(finest_within(source, {}, rows[5].table_bytes - 1).size == 56);
  CHECK(finest_within(source, {}, 100).size == 0);
}

namespace {

/// A sheet with `modes` parameters, and a corrective shape for each two, the later ones larger.
Source sheet_with_corrections(std::size_t modes) {
  Source source = sheet(6, dome);
  const auto shape = [&](std::size_t parameter, int second, float height) {
    std::vector<Vec3> moved(source.uv.size());
    for (std::size_t v = 0; v < moved.size(); ++v) moved[v].z = height * source.uv[v].x * source.uv[v].y;
    source.shapes.push_back({parameter, std::move(moved), {}, {}, {}, -1, second});
  };
  for (std::size_t k = 0; k < modes; ++k) {
    source.parameters.push_back({"mode" + std::to_string(k), Group::expression, -3, 3, 1});
    shape(k, -1, 5);
  }
  for (std::size_t k = 0, n = 0; k < modes; ++k)
    for (std::size_t i = 0; i <= k; ++i) shape(i, static_cast<int>(k), 1 + 0.01f * static_cast<float>(n++));
  return source;
}

}  // namespace

TEST_CASE(
    "corrective shapes that a table has no room for are left out, the smallest first, and a warning tells") {
  BakeOptions options;
  options.size = 16;
  Source source = sheet_with_corrections(24);  // 24 shapes and 300 corrective ones, five too many
  source.parameters[0].sd = 0.5f;              // its corrections are half as large
  CHECK_THROWS_WITH_AS(bake_source(source, options),
                       ": has 324 shapes, more than 319: choose some with --identities and --expressions",
                       SourceError);
  leave_out_corrections(source);
  REQUIRE(source.shapes.size() == 319);
  REQUIRE(source.warnings.size() == 1);
  CHECK(source.warnings[0] ==
        "left out the 5 smallest of 300 corrective shapes of the bending modes: a table holds 319 shapes. "
        "Fewer "
        "--modes or a larger --stiffness need fewer");
  const auto has = [&source](std::size_t i, int k) {
    return std::any_of(source.shapes.begin(), source.shapes.end(),
                       [&](const SourceShape& s) { return s.parameter == i && s.second == k; });
  };
  for (const int k : {0, 1, 2, 3, 4}) CHECK_FALSE(has(0, k));
  for (const int k : {1, 2, 3, 4}) CHECK(has(1, k));
  for (std::size_t k = 0; k < 24; ++k) CHECK(has(k, -1));
  const BakedModel baked(bake_source(source, options));
  CHECK(baked.model.cascade().count == 320);
  const auto rows = compare_sizes(sheet_with_corrections(24), options, {16});
  CHECK(rows[0].expressions == 24);
  leave_out_corrections(source);  // there is room: nothing is left out
  CHECK(source.shapes.size() == 319);
  CHECK(source.warnings.size() == 1);
}

}  // namespace bake_test
