// fit_truth_bench MODEL.plm [FACES]: the table of fits on random faces with known truth.
#define DOCTEST_CONFIG_IMPLEMENT
#include <cstdlib>
#include <fstream>
#include <iterator>

#include "fit_truth.hpp"

int main(int argc, char** argv) {
  doctest::Context context;  // REQUIRE works outside a test case
  context.setAsDefaultForAssertsOutOfTestCases();
  if (argc < 2) {
    std::fprintf(stderr, "usage: fit_truth_bench MODEL.plm [FACES]\n");
    return 2;
  }
  std::ifstream in(argv[1], std::ios::binary);
  const std::vector<std::uint8_t> table((std::istreambuf_iterator<char>(in)), {});
  BakedModel face(table);
  const int faces = argc > 2 ? std::atoi(argv[2]) : 100;
  for (std::size_t points : {std::size_t{80}, std::size_t{160}}) {
    fit_truth::Study study(face, points);
    fit_truth::print(fit_truth::run(study, points, faces), argv[1], points);
    std::printf("memory of the fit: %zu bytes\n", study.required_bytes());
  }
}
