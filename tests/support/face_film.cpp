#include "face_film.hpp"

FaceFilm::FaceFilm(int w, int h, std::size_t count, const Motion& motion, float fraction,
                   float flat_step_grey, int cells, std::uint32_t seed)
    : width(w), height(h), camera(pliant::centred_camera(w, h, 1.25f * static_cast<float>(w))) {
  using namespace pliant;
  BakedModel& face = baked_face();
  Renderer renderer(face.cascade, cells);
  renderer.flatten_half(flat_step_grey);
  const Picture backdrop = make_backdrop(w, h, 5);
  const Pose rest = frontal_pose(face.cascade, face.rest().data(), camera, h, fraction);
  for (std::size_t k = 0; k < count; ++k) {
    Pose pose = rest;
    std::vector<float> q = face.rest();
    motion(count > 1 ? static_cast<float>(k) / static_cast<float>(count - 1) : 0.0f, pose, q);
    Picture picture = renderer.draw(q.data(), pose, camera, backdrop);
    add_noise(picture, 2, 1000 * seed + static_cast<std::uint32_t>(k));
    frames.push_back(picture.pixels);
    poses.push_back(pose);
    parameters.push_back(q);
  }
}

FaceFilm::FaceFilm(const FaceFilm&) = default;
FaceFilm::~FaceFilm() = default;

void FaceFilm::set(std::vector<float>& q, const char* name, float value) {
  q[baked_face().model.find_parameter(name)] = value;
}

pliant::FrameView FaceFilm::view(std::size_t k) const {
  return view_of_pixels(frames[k], width, height, k);
}

pliant::Vec2 FaceFilm::truth(const std::string& landmark, std::size_t k) const {
  pliant::Vec2 x;
  REQUIRE(pliant::Projector(pliant::view_of(poses[k], camera), true)
              .project(baked_face().at(landmark, parameters[k]), &x));
  return x;
}

float FaceFilm::turn_error(const pliant::Pose& pose, std::size_t k) const {
  return 57.29578f *
         pliant::length(pliant::log_rotation(pose.q * pliant::conjugate(pliant::normalised(poses[k].q))));
}
