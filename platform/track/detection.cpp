// Detection by whatever the model has tables for.
#include "track/detection_state.hpp"
#include "track/face_modules.hpp"

namespace pliant {

namespace {

DetectionState* lay_out(Arena& arena, const Model& model, const TrackerLimits& limits, std::size_t* bytes) {
  const bool has_face = limits.detection->modules->is_available(model);
  return (has_face ? kUprightFaceDetection : kPrintDetection).lay_out(arena, model, limits, bytes);
}

std::size_t check_bytes(const Model& model, const TrackerLimits& limits) {
  return kUprightFaceDetection.check_bytes(model, limits);  // a check of a print takes none
}

std::size_t read_bytes(const Model& model, const TrackerLimits& limits) {
  return kUprightFaceDetection.read_bytes(model, limits);
}

}  // namespace

// The tracker makes its calls through the table of whichever has laid its DetectionState out.
const Detection kUprightDetection{lay_out, check_bytes, read_bytes, &kFaceModules};
const Detection kDetection{lay_out, check_bytes, read_bytes, &kRolledFaces};

}  // namespace pliant
