// Random changes in the learnt tables of a face, with right checksums; then detector, aligner and a tracker with its part readers
// run on frames with the face, with others and with none. A table is refused by a status, or what it gives is finite, in range and
// consistent. For memory and undefined behaviour the program is compiled with sanitizers.
//
// usage: learnt_fuzz TABLE.plm FILM.y4m [COUNT [FIRST_SEED]]
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "aligned_block.hpp"
#include "face/aligner_table.hpp"
#include "face/detector_table.hpp"
#include "face/part_table.hpp"
#include "host/io/aligned_table.hpp"
#include "pliant/face_aligner.hpp"
#include "pliant/face_detector.hpp"
#include "pliant/tracker.hpp"
#include "random.hpp"

using namespace pliant;

namespace {

constexpr int kWidth = 320, kHeight = 240;

std::vector<std::uint8_t> read(const char* path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

using Frame = std::vector<std::uint8_t>;

FrameView view_of(const Frame& frame, std::uint32_t number) {
  return {frame.data(), kWidth, kHeight, kWidth, 1, 33'333'333 * (std::int64_t{number} + 1), number};
}

/// The first frame of a grey Y4M film, others, and noise.
std::vector<Frame> make_frames(const std::vector<std::uint8_t>& film) {
  const std::string text(film.begin(), film.end());
  const std::size_t first = text.find("FRAME\n") + 6, pixels = kWidth * kHeight;
  if (first < 6 || film.size() < first + pixels) return {};
  Frame face(film.begin() + static_cast<std::ptrdiff_t>(first),
             film.begin() + static_cast<std::ptrdiff_t>(first + pixels));
  Frame turned(face.rbegin(), face.rend()), noise(pixels), black(pixels, 0);
  Random random(3);
  for (std::uint8_t& p : noise) p = static_cast<std::uint8_t>(random.below(256));
  return {face, face, turned, noise, black};
}

/// One of the learnt tables in a model's.
struct Learnt {
  Span<const std::uint8_t> bytes;
  std::size_t crc_at, header_at;  ///< offsets of the checksum, and of what may be changed: lengths and checksum stay
};

Learnt any_learnt(const Model& model, Random& random) {
  switch (random.below(3)) {
    case 0:
      return {model.detector(), offsetof(DetectorHeader, crc32), offsetof(DetectorHeader, tree_count)};
    case 1:
      return {model.aligner(), offsetof(AlignerHeader, crc32), offsetof(AlignerHeader, landmark_count)};
    default:
      return {model.parts(), offsetof(PartHeader, crc32), offsetof(PartHeader, part_count)};
  }
}

/// A table of which a learnt one is changed at random places, and the checksums are right again.
class ChangedTable : public host::AlignedTable {
 public:
  /// \param start  of the table that `model` has opened.
  ChangedTable(const std::vector<std::uint8_t>& original, const Model& model, const std::uint8_t* start,
               Random& random)
      : AlignedTable(original), random_(random) {
    const Learnt part = any_learnt(model, random);
    const auto first = static_cast<std::size_t>(part.bytes.data - start), end = first + part.bytes.count;
    for (int k = random.below(random.below(2) == 0 ? 3 : 30); k >= 0; --k) change(first + part.header_at, end);
    seal(first + part.crc_at, end);
    seal(12, original.size());
  }

 private:
  /// Changes something in [first, end), more often in the headers, where sizes and curves are.
  void change(std::size_t first, std::size_t end) {
    const std::size_t range = random_.below(4) == 0 ? 400 : end - first - 4;
    const std::size_t at = first + static_cast<std::size_t>(random_.below(static_cast<int>(range)));
    const float floats[] = {0, -0.0f, 1, -1, 0.5f, 8, 1e3f, -1e3f, 1e4f, 1e6f, -1e6f, 1e-38f, 3e38f, -3e38f};
    switch (random_.below(6)) {
      case 0:
        bytes()[at] = static_cast<std::uint8_t>(random_.below(256));
        return;
      case 1:
        bytes()[at] ^= static_cast<std::uint8_t>(1 << random_.below(8));
        return;
      case 2: {
        float value;
        std::memcpy(&value, bytes() + at / 4 * 4, sizeof value);
        value *= floats[random_.below(8)];
        return put(at, &value);
      }
      case 3: {
        const std::uint32_t word = static_cast<std::uint32_t>(random_.bits());
        return put(at, &word);
      }
      case 4:
        for (std::size_t k = at; k < end && k < at + 256; ++k)
          bytes()[k] ^= 0x80;  // weights of one sign
        return;
      default:
        return put(at, &floats[random_.below(14)]);
    }
  }
  void put(std::size_t at, const void* four) { std::memcpy(bytes() + at / 4 * 4, four, 4); }
  void seal(std::size_t crc_at, std::size_t end) {
    const std::uint32_t crc = crc32(bytes() + crc_at + 4, end - crc_at - 4);
    std::memcpy(bytes() + crc_at, &crc, sizeof crc);
  }

  Random& random_;
};

bool is_in_unit(float x) {
  return x >= 0 && x <= 1;
}

bool are_finite(Span<const float> values) {
  for (const float x : values)
    if (!is_finite(x)) return false;
  return true;
}

template <class T, class... Args>
bool make(AlignedBlock& block, T& object, const Args&... args) {
  block = AlignedBlock(measured_bytes<T>(args...));
  Arena arena(block.data(), block.size());
  return create_in(arena, object, args...) == Status::ok;
}

const char* fault_of_detector(const Model& model, const std::vector<Frame>& frames) {
  AlignedBlock block;
  FaceDetector detector;
  if (!make(block, detector, model.detector(), FaceDetectorLimits{})) return "detector: no memory";
  for (std::uint32_t k = 0; k < frames.size(); k += 3) {
    DetectedFace faces[8];
    std::size_t count = 0;
    if (detector.find(view_of(frames[k], k), {faces, 8}, &count) != detector.status())
      return "detector: status";
    for (std::size_t i = 0; i < count; ++i)
      if (!is_in_unit(faces[i].score) || !is_finite(faces[i].box.center) || !(faces[i].box.side >= 1))
        return "detector: a box or score out of range";
  }
  return nullptr;
}

const char* fault_of_aligner(const Model& model, const std::vector<Frame>& frames, Random& random) {
  AlignedBlock block;
  FaceAligner aligner;
  if (!make(block, aligner, model)) return "aligner: no memory";
  const Camera camera = centred_camera(kWidth, kHeight, 448);
  std::vector<float> q(model.parameters().count);
  std::vector<Vec2> landmarks(model.landmarks().count);
  AlignedFace face;
  for (std::uint32_t k = 0; k < frames.size(); k += 3) {
    const FaceBox box{{random.uniform(60, 250), random.uniform(60, 180)}, random.uniform(20, 200)};
    const Status status = aligner.align(view_of(frames[k], k), box, camera, &face, q.data(),
                                        {landmarks.data(), landmarks.size()});
    if (status == Status::ok &&
        aligner.refine(view_of(frames[k], k), camera, face.pose, &face, q.data()) == Status::ok &&
        aligner.verify(view_of(frames[k], k), camera, face.pose, q.data(), &face) == Status::bad_table)
      return "aligner: a table that was good is not";
    if (!is_in_unit(face.score) || !is_in_unit(face.landmark_error)) return "aligner: a score out of range";
    if (!is_finite(face.pose) || !are_finite({q.data(), q.size()}))
      return "aligner: a pose that is not finite";
    for (const Vec2 x : landmarks)
      if (!is_finite(x)) return "aligner: a landmark that is not finite";
  }
  return nullptr;
}

const char* fault_of_tracker(const Model& model, const std::vector<Frame>& frames, Random& random) {
  TrackerLimits limits = random.below(2) == 0 ? profile_s() : TrackerLimits{};
  limits.search_work = random.below(2) == 0 ? limits.search_work : 24000;
  AlignedBlock block;
  Tracker tracker;
  if (!make(block, tracker, model, limits)) return "tracker: no memory";
  for (std::uint32_t k = 0; k < 8; ++k) {
    const Frame& frame = frames[k < 5 ? 0 : k - 4];
    FrameResult result;
    const Status status = tracker.update(view_of(frame, k), &result);
    if (status != Status::ok) return tracker.is_started() ? "tracker: a status during a track" : nullptr;
    if (result.is_searching == tracker.is_started()) return "tracker: searching and started";
    if (!tracker.is_started() && result.state != TrackState::lost) return "tracker: a state without a track";
    if (!is_in_unit(result.landmark_error) || !is_finite(result.pose))
      return "tracker: a result out of range";
    if (!are_finite(tracker.parameters())) return "tracker: a parameter that is not finite";
  }
  return nullptr;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return 2;
  const std::vector<std::uint8_t> original = read(argv[1]);
  const std::vector<Frame> frames = make_frames(read(argv[2]));
  const int count = argc > 3 ? std::atoi(argv[3]) : 100;
  const int first = argc > 4 ? std::atoi(argv[4]) : 1;
  Model model;
  const host::AlignedTable table(original);
  if (frames.empty() || Model::open(table.data(), table.size(), &model) != Status::ok ||
      model.aligner().empty() || model.parts().empty()) {
    std::printf("no table or no film\n");
    return 1;
  }
  int refused = 0;
  for (int seed = first; seed < first + count; ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    const ChangedTable other(original, model, table.span().data, random);
    Model changed;
    const char* fault = Model::open(other.data(), original.size(), &changed) == Status::ok
                            ? nullptr
                            : "the table is not opened";
    DetectorTable detector;
    AlignerTable aligner;
    PartTable parts;
    refused += DetectorTable::open(changed.detector(), &detector) != Status::ok ||
               AlignerTable::open(changed.aligner(), &aligner) != Status::ok ||
               PartTable::open(changed.parts(), &parts) != Status::ok;
    if (fault == nullptr) fault = fault_of_detector(changed, frames);
    if (fault == nullptr) fault = fault_of_aligner(changed, frames, random);
    if (fault == nullptr) fault = fault_of_tracker(changed, frames, random);
    if (fault != nullptr) {
      std::printf("seed %d: %s\n", seed, fault);
      return 1;
    }
  }
  std::printf("%d tables, %d refused\n", count, refused);
  return 0;
}
