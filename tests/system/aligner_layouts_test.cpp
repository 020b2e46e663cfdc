// Alignments with less memory, and over several frames, with the learnt tables of the built-in face.
#include <doctest/doctest.h>

#include <algorithm>

#include "aligned_block.hpp"
#include "host/bench/still_film.hpp"
#include "host/commands/face_finder.hpp"
#include "pliant/face_aligner.hpp"
#include "random.hpp"

namespace aligner_layouts_test {

using namespace pliant;
using namespace pliant::host;

namespace {

const ModelFile& face_file() {
  static const ModelFile file(PLIANT_DETECTING_FACE);
  return file;
}

const Image& astronaut() {
  static const Image grey = resized(to_grey(read_image(PLIANT_FIXTURES "/astronaut/astronaut.png")), 0.6f);
  return grey;
}

const FaceBox& box() {
  static const FaceBox found = FaceFinder(face_file()).find(astronaut(), "astronaut", 0.5f).at(0).box;
  return found;
}

FrameView view_of_image(const Image& image) {
  return {image.pixels.data(), image.width, image.height, static_cast<std::size_t>(image.width)};
}

Image with_light(float gain) {
  Image image = astronaut();
  for (std::uint8_t& grey : image.pixels) grey = static_cast<std::uint8_t>(std::min(255.0f, gain * grey));
  return image;
}

/// An aligner with its memory, and room for its results.
struct Rig {
  AlignedBlock block{200'000};
  Arena arena{block.data(), block.size()};
  FaceAligner aligner;
  AlignedFace face;
  std::vector<float> q = std::vector<float>(face_file().model().parameters().count);
  std::vector<Vec2> landmarks = std::vector<Vec2>(face_file().model().landmarks().count);

  Span<Vec2> places() { return {landmarks.data(), landmarks.size()}; }
  Camera camera() const {
    return centred_camera(astronaut().width, astronaut().height,
                          1.25f * static_cast<float>(astronaut().width));
  }
  Status begin(const AlignOptions& options, int* steps) {
    return aligner.begin(view_of_image(astronaut()), box(), camera(), q.data(), steps, options);
  }
  Status advance(const Image& image, int steps) {
    return aligner.advance(view_of_image(image), steps, &face, q.data(), places());
  }
};

std::vector<std::uint8_t> expressions() {
  std::vector<std::uint8_t> free;
  for (const Parameter& p : face_file().model().parameters()) free.push_back(p.group == Group::expression);
  return free;
}

}  // namespace

TEST_CASE(
    "an aligner of a known person takes half of the memory, and has the bits of one that keeps samples") {
  const Model& model = face_file().model();
  const FrameView frame = view_of_image(astronaut());
  Rig whole, known;
  whole.aligner.lay_out(whole.arena, model);
  known.aligner.lay_out_for_known_person(known.arena, model);
  CHECK(known.arena.used_bytes() < 0.6 * static_cast<double>(whole.arena.used_bytes()));
  REQUIRE(whole.aligner.align(frame, box(), whole.camera(), &whole.face, whole.q.data()) == Status::ok);
  CHECK(known.aligner.align(frame, box(), known.camera(), &known.face, known.q.data()) == Status::capacity);

  const std::vector<std::uint8_t> free = expressions();
  const std::vector<float> person = whole.q;
  Pose near = whole.face.pose;
  near.t.x += 12;
  for (Rig* rig : {&whole, &known}) {
    rig->q = person;
    for (std::size_t k = 0; k < free.size(); ++k)
      if (free[k] != 0) rig->q[k] = 0;
    REQUIRE(rig->aligner.refine(frame, rig->camera(), near, &rig->face, rig->q.data(), rig->places(),
                                {free.data()}) == Status::ok);
  }
  CHECK(known.q == whole.q);
  CHECK(known.face.score == whole.face.score);
  CHECK(known.face.score > 0.95f);
  for (std::size_t k = 0; k < known.landmarks.size(); ++k)
    CHECK(length(known.landmarks[k] - whole.landmarks[k]) == 0);

  AlignedFace verified[2];
  REQUIRE(whole.aligner.verify(frame, whole.camera(), near, person.data(), &verified[0]) == Status::ok);
  REQUIRE(known.aligner.verify(frame, known.camera(), near, person.data(), &verified[1]) == Status::ok);
  CHECK(verified[0].score == verified[1].score);
  CHECK(known.aligner.refine(frame, known.camera(), near, &known.face, known.q.data()) == Status::capacity);
  // There is room for so many parameters, whichever.
  std::vector<std::uint8_t> others;
  for (const std::uint8_t flag : free) others.push_back(flag == 0);
  REQUIRE(std::count(others.begin(), others.end(), 1) <= std::count(free.begin(), free.end(), 1));
  CHECK(known.aligner.refine(frame, known.camera(), near, &known.face, known.q.data(), {}, {others.data()}) ==
        Status::ok);
}

TEST_CASE("a score that is taken twice is the larger one, unless the second is below 0.3") {
  const Image bright = with_light(2.6f);
  Image noise = astronaut();
  Random random(1);
  for (std::uint8_t& grey : noise.pixels) grey = static_cast<std::uint8_t>(random.bits() >> 24);
  Rig once, twice;
  for (Rig* rig : {&once, &twice}) rig->aligner.lay_out(rig->arena, face_file().model());
  // The score of an alignment whose last step is taken in another frame.
  const auto score = [](Rig& rig, bool is_scored_twice, const Image& last) {
    AlignOptions options;
    options.is_scored_twice = is_scored_twice;
    int steps = 0;
    REQUIRE(rig.begin(options, &steps) == Status::ok);
    REQUIRE(rig.advance(astronaut(), steps - 1) == Status::ok);
    REQUIRE(rig.advance(last, 1) == Status::ok);
    return rig.face.score;
  };
  int steps = 0, steps_twice = 0;
  AlignOptions options;
  REQUIRE(once.begin(options, &steps) == Status::ok);
  options.is_scored_twice = true;
  REQUIRE(twice.begin(options, &steps_twice) == Status::ok);
  CHECK(steps_twice == steps + 1);

  const float here = score(once, false, astronaut()), in_bright = score(once, false, bright),
              in_noise = score(once, false, noise);
  MESSAGE("score " << here << ", in bright light " << in_bright << ", in noise " << in_noise);
  REQUIRE(in_bright >= 0.3f);
  REQUIRE(in_bright < here);
  REQUIRE(in_noise < 0.3f);
  CHECK(score(twice, true, astronaut()) == here);
  CHECK(score(twice, true, bright) == here);
  CHECK(score(twice, true, noise) == in_noise);
  CHECK(score(twice, false, bright) == in_bright);  // nothing is left of it
}

}  // namespace aligner_layouts_test
