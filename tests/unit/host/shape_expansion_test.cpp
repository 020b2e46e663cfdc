// The polynomial by which the page of `pliant points` deforms a model, against the cascade.
#include "host/render/shape_expansion.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "baked_face.hpp"
#include "cli_run.hpp"
#include "host/io/owned.hpp"
#include "pliant/cascade.hpp"
#include "random.hpp"

namespace shape_expansion_test {

using namespace cli_run;

namespace {

std::vector<Vec2> some_points(const Model& model) {
  std::vector<Vec2> uv;
  for (std::size_t i = 0; i < model.base_uv().count; i += 7) uv.push_back(model.base_uv()[i]);
  return uv;
}

float factor(const ShapeTerm& term, const std::vector<float>& q) {
  return q[term.a] * (term.b == kNone ? 1.0f : q[term.b]);
}

/// Largest distance, mm, of the expansion about `start` from the cascade at q.
float error_at(const Model& model, const std::vector<Vec2>& uv, const std::vector<float>& start,
               const std::vector<float>& q) {
  const ShapeExpansion shape = expand_shape(model, uv, start);
  Owned<Cascade> cascade(model);
  float worst = 0;
  for (std::size_t i = 0; i < uv.size(); ++i) {
    Vec3 p = shape.start[i];
    for (const ShapeTerm& term : shape.terms) p = p + (factor(term, q) - factor(term, start)) * term.move[i];
    worst = max(worst, length(p - cascade->surface_point(uv[i], q.data())));
  }
  return worst;
}

std::vector<float> normal_q(const Model& model, float amount, std::uint32_t seed) {
  Random random(seed);
  std::vector<float> q;
  for (const Parameter& p : model.parameters())
    q.push_back(clamp(amount * p.sd * random.normal(), p.minimum, p.maximum));
  return q;
}

}  // namespace

TEST_CASE("a sheet's bending modes and their products are expanded exactly") {
  const Folder f;
  REQUIRE(run_words({"bake", PLIANT_FIXTURES "/sheet", "--modes", "3", "-o", f / "sheet.plm"}).code == 0);
  const ModelFile file(f / "sheet.plm");
  const auto uv = some_points(file.model());
  const ShapeExpansion shape = expand_shape(file.model(), uv, normal_q(file.model(), 0, 1));
  CHECK(std::count_if(shape.terms.begin(), shape.terms.end(),
                      [](const ShapeTerm& t) { return t.b == kNone; }) == 3);
  CHECK(shape.terms.size() > 5);
  CHECK(shape.terms.size() <= 9);
  // What is left out is 1/2000 of 364 mm a term.
  for (const std::uint32_t seed : {1u, 2u, 3u})
    CHECK(error_at(file.model(), uv, normal_q(file.model(), 0.5f, 9 + seed),
                   normal_q(file.model(), 1, seed)) < 0.4f);
}

TEST_CASE("a face is expanded to a fraction of a millimetre, its jaw's rotation included") {
  const BakedModel& face = baked_face();
  const auto uv = some_points(face.model);
  const auto neutral = face.rest();
  CHECK(error_at(face.model, uv, neutral, neutral) == 0);
  const auto start = normal_q(face.model, 1, 5);
  CHECK(error_at(face.model, uv, start, start) == 0);
  // The jaw at its limit, far beyond what the terms are fitted to.
  CHECK(error_at(face.model, uv, neutral, face.posed("jawOpen")) < 2);
  for (const std::uint32_t seed : {1u, 2u, 3u})
    CHECK(error_at(face.model, uv, neutral, normal_q(face.model, 1, seed)) < 1);
}

TEST_CASE("parameters that only add have no products") {
  const BakedModel& face = baked_face();
  const auto jaw = face.model.find_parameter("jawOpen");
  const ShapeExpansion shape = expand_shape(face.model, some_points(face.model), face.rest());
  std::size_t products = 0;
  for (const ShapeTerm& term : shape.terms) {
    if (term.b == kNone) continue;
    CHECK((term.a == jaw || term.b == jaw));
    ++products;
  }
  CHECK(products > 0);
  CHECK(expand_shape(face.model, {}, face.rest()).terms.empty());
}

}  // namespace shape_expansion_test
