// The bytes that the comments of public headers state, compared with those that are measured.
#include <doctest/doctest.h>

#include "baked_face.hpp"
#include "pliant/base_mesh.hpp"
#include "pliant/face_aligner.hpp"
#include "pliant/face_detector.hpp"
#include "pliant/fit.hpp"
#include "pliant/fold_over.hpp"
#include "pliant/outliers.hpp"
#include "pliant/patch_tracker.hpp"
#include "pliant/tracker.hpp"

namespace stated_bytes_test {

using namespace pliant;

namespace {

/// Stated numbers are rounded: within 8 %.
void check_about(std::size_t measured, double stated) {
  CHECK(static_cast<double>(measured) == doctest::Approx(stated).epsilon(0.08));
}

template <class T, class Limits, class Change>
std::size_t increase(Limits limits, const Change& change) {
  const std::size_t before = measured_bytes<T>(baked_face().model, limits);
  change(limits);
  return measured_bytes<T>(baked_face().model, limits) - before;
}

struct AlignerOfKnownPerson {
  FaceAligner aligner;
  void lay_out(Arena& arena, const Model& model) { aligner.lay_out_for_known_person(arena, model); }
};

}  // namespace

TEST_CASE(
    "EstimatorLimits and TrackerLimits state what a silhouette point, the rejection and a kept template "
    "cost") {
  EstimatorLimits limits;
  const double vertices = limits.vertices;
  check_about(increase<Estimator>(limits, [](auto& l) { l.silhouette_points = 40; }),
              40 * 256 + 16 * vertices);
  check_about(increase<Tracker>(TrackerLimits{}, [](auto& l) { l.silhouette_points = 40; }),
              40 * 1200 + 16 * vertices);
  limits.rejection_sample = 0;
  check_about(increase<Estimator>(limits, [](auto& l) { l.rejection_sample = 50; }), 35e3 + 50 * 150);
  check_about(increase<Estimator>(limits, [](auto& l) { l.rejection_sample = 100; }), 35e3 + 100 * 150);
  limits.rejection_sample = limits.points;
  CHECK(increase<Estimator>(limits, [](auto& l) { l.rejection_sample = 4 * l.points; }) == 0);
  TrackerLimits without;
  without.keeps_templates = false;
  check_about(increase<Tracker>(without, [](auto& l) { l.keeps_templates = true; }),
              1700.0 * (without.patches + without.key_patches));
}

TEST_CASE("FitLimits, FoldOverTest and BaseMeshMaker state their bytes") {
  const Model& model = baked_face().model;
  const auto vertices = static_cast<double>(model.base_uv().count),
             faces = static_cast<double>(model.base_corners().count) / 3;
  FitLimits limits;
  const auto records = static_cast<double>(model.cascade().count), points = static_cast<double>(limits.points),
             unknowns = static_cast<double>(model.parameters().count) + 7;
  check_about(measured_bytes<Fitter>(model, limits),
              12 * points * records + 40 * points + 4 * unknowns * unknowns + 130 * unknowns + 36 * vertices +
                  12 * faces + static_cast<double>(measured_bytes<Cascade>(model)));
  check_about(increase<Fitter>(limits, [](auto& l) { l.silhouette = true; }),
              95 * vertices + 8 * limits.points + 9 * 1024);
  check_about(measured_bytes<FoldOverTest>(model),
              12 * faces + 12 * vertices + 4 * static_cast<double>(model.parameters().count));
  for (const bool splits : {true, false}) {
    BaseMeshLimits base;
    base.splits = splits;
    check_about(measured_bytes<BaseMeshMaker>(base),
                (splits ? 150.0 : 85.0) * base.faces + 22.0 * base.vertices);
  }
}

TEST_CASE("FaceDetector, FaceAligner, PatchLimits and McdLimits state their bytes") {
  const Model& model = baked_face().model;
  const std::size_t aligner = measured_bytes<FaceAligner>(model);
  check_about(measured_bytes<FaceDetector>(model.detector(), FaceDetectorLimits{}), 32e3);
  check_about(aligner, 140 * 1024);
  check_about(measured_bytes<AlignerOfKnownPerson>(model), 0.5 * static_cast<double>(aligner));
  check_about(measured_bytes<PatchTracker>(PatchLimits{0, 11, 3, 4}), 10e3);
  check_about(measured_bytes<PatchTracker>(PatchLimits{0, 21, 3, 4}), 29e3);
  check_about(measured_bytes<Mcd>(McdLimits{256, 6}), 50e3);
  check_about(measured_bytes<Mcd>(McdLimits{4096, 24}), 1e6);
}

}  // namespace stated_bytes_test
