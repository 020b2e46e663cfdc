#include "track/face_candidates.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "random.hpp"

namespace face_candidates_test {

using namespace pliant;

namespace {

constexpr const FaceCandidatesTuning& kTuning = kFaceCandidatesTuning;

FaceCandidates made_of(const std::vector<DetectedFace>& faces) {
  FaceCandidates c;
  for (const DetectedFace& face : faces) c.add(face);
  return c;
}

std::vector<DetectedFace> all_of(FaceCandidates c) {
  std::vector<DetectedFace> out;
  if (c.empty()) return out;
  do out.push_back(c.next());
  while (c.pass());
  return out;
}

std::vector<float> scores_of(const FaceCandidates& c) {
  std::vector<float> out;
  for (const DetectedFace& face : all_of(c)) out.push_back(face.score);
  return out;
}

using Scores = std::vector<float>;

/// Faces with one size, far from one another.
DetectedFace face(int place, float score) {
  return {{{100.0f * static_cast<float>(place), 50}, 40}, score};
}

}  // namespace

TEST_CASE("candidates come best first, whatever the order in which they are found; doubtful ones do not") {
  const float low = kTuning.least_detection;
  std::vector<DetectedFace> faces{face(0, 0.9f), face(1, 0.5f), face(2, 0.7f), face(3, low),
                                  face(4, 0.99f * low)};
  std::vector<int> order{0, 1, 2, 3, 4};
  do {
    FaceCandidates c;
    for (const int k : order) c.add(faces[static_cast<std::size_t>(k)]);
    CHECK(scores_of(c) == Scores{0.9f, 0.7f, 0.5f, low});
  } while (std::next_permutation(order.begin(), order.end()));
  CHECK(made_of({}).empty());
  CHECK(made_of({face(0, 0.99f * low)}).empty());
  CHECK(made_of({face(0, std::numeric_limits<float>::quiet_NaN())}).empty());
}

TEST_CASE("of the detections of one face only the best one stays") {
  const DetectedFace best{{{100, 50}, 40}, 0.9f}, beside{{{110, 55}, 50}, 0.8f}, other = face(4, 0.6f);
  CHECK(scores_of(made_of({best, beside, other})) == Scores{0.9f, 0.6f});
  CHECK(scores_of(made_of({other, beside, best})) == Scores{0.9f, 0.6f});
  CHECK(scores_of(made_of({beside, other, best})) == Scores{0.9f, 0.6f});
  // One detection between two faces takes the place of both.
  const float reach = 0.9f * kTuning.same_face_distance * 40;
  const DetectedFace left{{{100 - reach, 50}, 40}, 0.5f}, right{{{100 + reach, 50}, 40}, 0.4f};
  CHECK(scores_of(made_of({left, right})) == Scores{0.5f, 0.4f});
  CHECK(scores_of(made_of({left, face(5, 0.45f), right, best})) == Scores{0.9f, 0.45f});
  CHECK(scores_of(made_of({best, left, right})) == Scores{0.9f});
}

TEST_CASE("a box of another size, or beyond the distance of one face, is another face") {
  const DetectedFace first = face(1, 0.9f);
  const auto faces_with = [&](float distance, float size) {
    const DetectedFace second{{{first.box.center.x, first.box.center.y + distance}, size * first.box.side},
                              0.5f};
    const std::size_t count = all_of(made_of({first, second})).size();
    CHECK(all_of(made_of({second, first})).size() == count);
    return count;
  };
  const float far_away = kTuning.same_face_distance * first.box.side;
  CHECK(faces_with(0.99f * far_away, 1) == 1);
  CHECK(faces_with(1.01f * far_away, 1) == 2);
  CHECK(faces_with(1.01f * far_away, 1.2f) == 1);  // of the larger side
  CHECK(faces_with(0, 0.99f * kTuning.same_face_ratio) == 1);
  CHECK(faces_with(0, 1.01f * kTuning.same_face_ratio) == 2);
  CHECK(faces_with(0, 1.01f / kTuning.same_face_ratio) == 1);
  CHECK(faces_with(0, 0.99f / kTuning.same_face_ratio) == 2);
}

TEST_CASE("of more faces than there is room for the best ones stay, in any order") {
  constexpr std::size_t kFaces = kTuning.most_candidates + 5;
  std::vector<DetectedFace> faces;
  for (std::size_t k = 0; k < kFaces; ++k)
    faces.push_back(face(static_cast<int>(k), 0.95f - 0.05f * static_cast<float>(k)));
  Scores best;
  for (std::size_t k = 0; k < kTuning.most_candidates; ++k) best.push_back(faces[k].score);
  Random random(7);
  for (int trial = 0; trial < 50; ++trial) {
    for (std::size_t k = kFaces - 1; k > 0; --k)
      std::swap(faces[k], faces[static_cast<std::size_t>(random.below(static_cast<int>(k) + 1))]);
    CHECK(scores_of(made_of(faces)) == best);
  }
}

TEST_CASE("a place that no detection gives is the only candidate, whatever was there") {
  FaceCandidates c = made_of({face(0, 0.9f), face(1, 0.8f)});
  REQUIRE(c.pass());
  c.add_place({{7, 8}, 9});
  CHECK(c.next().box.side == 9);
  CHECK(c.next().score == 0);
  CHECK_FALSE(c.pass());
  c.clear();
  CHECK(c.empty());
}

}  // namespace face_candidates_test
