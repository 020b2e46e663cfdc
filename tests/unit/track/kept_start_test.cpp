// What a tracker keeps of a start of the caller's, for searches later.
#include "track/kept_start.hpp"

#include <doctest/doctest.h>

#include <vector>

#include "baked_face.hpp"
#include "model_builder.hpp"

namespace kept_start_test {

using namespace pliant;

TEST_CASE("camera and free parameters of a start are kept, whatever becomes of the caller's") {
  InArena<KeptStart> kept(baked_face().model);
  Camera camera = centred_camera(320, 240, 400);
  std::vector<std::uint8_t> is_free(baked_face().model.parameters().count, 1);
  is_free[3] = 0;
  StartOptions start;
  start.camera = &camera;
  start.focal_px = 7;
  TrackerOptions options;
  options.is_free = is_free.data();
  options.keeps_landmark_offsets = false;
  kept->keep(start);
  kept->keep(options);
  camera = {};
  is_free.assign(is_free.size(), 2);
  REQUIRE((kept->start.camera != nullptr && kept->options.is_free != nullptr));
  CHECK(kept->start.camera->f == 400);
  CHECK(kept->start.focal_px == 7);
  for (std::size_t k = 0; k < is_free.size(); ++k) CHECK(kept->options.is_free[k] == (k != 3));
  CHECK_FALSE(kept->options.keeps_landmark_offsets);
  kept->keep(StartOptions{});
  kept->keep(TrackerOptions{});
  CHECK((kept->start.camera == nullptr && kept->options.is_free == nullptr));
}

}  // namespace kept_start_test
