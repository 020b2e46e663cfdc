#include "host/learn/photographs.hpp"

#include <algorithm>
#include <iterator>
#include <map>

#include "face/aligner_table.hpp"
#include "host/io/csv.hpp"
#include "host/io/files.hpp"
#include "host/io/ibug_names.hpp"
#include "host/io/owned.hpp"
#include "host/learn/brow_search.hpp"
#include "host/learn/parallel.hpp"
#include "pliant/cascade.hpp"
#include "track/landmark_fit.hpp"

namespace pliant::host::learn {

namespace {

struct PhotographTuning {
  /// Assumed focal length over the larger side of a picture. A portrait is taken from about 1.6 m and cut so that a
  /// face of 150 mm fills 120 of 320 px. Not tuned.
  float focal_ratio = 4;
};
constexpr PhotographTuning kTuning{};

constexpr const char* kPupilNames[] = {"pupil_r", "pupil_l"};

void set_landmarks(const Model& model, const AnnotatedPicture& annotated, Photograph& out) {
  Owned<Cascade> cascade(model);
  const Projector projector(view_of(out.pose, out.camera), true);
  const auto landmarks = model.landmarks();
  out.landmarks.assign(landmarks.count, {});
  out.trust.assign(landmarks.count, kTrustNone);
  for (std::size_t k = 0; k < landmarks.count; ++k)
    if (projector.project(cascade->surface_point(landmarks[k].uv(), out.q.data()), &out.landmarks[k]))
      out.trust[k] = kTrustFitted;
  for (const AnnotatedLandmark& a : annotated.landmarks)
    for (const int side : {0, 1})
      if (a.name == kPupilNames[side]) {
        out.pupils.x[side] = a.x;
        out.pupils.trust[side] = kTrustAnnotated;
      }
  for (const AnnotatedLandmark& a : annotated.landmarks)
    if (const std::uint16_t k = model.find_landmark(a.name.c_str()); k != kNone) {
      out.landmarks[k] = a.x;
      out.trust[k] = kTrustAnnotated;
    }
}

/// Sets pose, camera and parameters.
bool fit_points(const Model& model, const std::vector<AnnotatedLandmark>& landmarks, Photograph& out) {
  std::vector<Correspondence> points;
  for (const AnnotatedLandmark& a : landmarks) {
    const std::uint16_t k = model.find_landmark(a.name.c_str());
    if (k == kNone) continue;
    const Landmark& landmark = model.landmarks()[k];
    points.push_back({landmark.uv(), a.x, 1, is_silhouette_landmark(a.name.c_str())});
  }
  if (points.size() < kLeastFitPoints) return false;
  FitOptions options;
  options.width = out.picture.width;
  options.height = out.picture.height;
  options.focal_px = kTuning.focal_ratio * static_cast<float>(std::max(options.width, options.height));
  out.q.assign(model.parameters().count, 0.0f);
  Owned<LandmarkFit> fit(model, points.size());
  if (fit->fit({points.data(), points.size()}, options, out.q.data()) != Status::ok) return false;
  out.pose = pose_of(fit->report().view);
  out.camera = camera_of(fit->report().view);
  return true;
}

/// Whether one of the brows' landmarks is annotated.
bool has_brows(const AnnotatedPicture& annotated) {
  return std::any_of(annotated.landmarks.begin(), annotated.landmarks.end(), [](const AnnotatedLandmark& a) {
    const int k = ibug_number(a.name);
    return k >= 17 && k <= 26;
  });
}

}  // namespace

bool is_held_out(std::string_view name) {
  std::uint32_t hash = 2166136261u;
  for (const char c : name) hash = (hash ^ static_cast<std::uint8_t>(c)) * 16777619u;
  return hash % 3 == 0;
}

std::string mirrored_landmark(const std::string& name) {
  if (const int k = ibug_number(name); k >= 0)
    return k < kIbugCount ? ibug_name(mirrored_landmark_number(k)) : name;
  static const char* const kEndings[][2] = {
      {"_left", "_right"}, {"_right", "_left"}, {"_l", "_r"}, {"_r", "_l"}};
  for (const auto& [ending, other] : kEndings) {
    const std::string e = ending;
    if (name.size() > e.size() && name.compare(name.size() - e.size(), e.size(), e) == 0)
      return name.substr(0, name.size() - e.size()) + other;
  }
  return name;
}

AnnotatedPicture mirror_image(const AnnotatedPicture& annotated) {
  AnnotatedPicture out = annotated;
  const auto last = static_cast<float>(annotated.picture.width - 1);
  for (int y = 0; y < out.picture.height; ++y)
    std::reverse(out.picture.at(0, y), out.picture.at(0, y) + out.picture.width);
  for (AnnotatedLandmark& a : out.landmarks) a = {mirrored_landmark(a.name), {last - a.x.x, a.x.y}};
  return out;
}

bool fit_photograph(const Model& model, const AnnotatedPicture& annotated, Photograph* photograph) {
  Photograph out;
  out.name = annotated.name;
  out.picture = annotated.picture;
  if (!fit_points(model, annotated.landmarks, out)) return false;
  set_landmarks(model, annotated, out);
  if (!has_brows(annotated)) {
    // Without them the fit's brows are where those of most people are not.
    std::vector<AnnotatedLandmark> points = annotated.landmarks;
    const std::vector<AnnotatedLandmark> brows = find_brows(model, out);
    points.insert(points.end(), brows.begin(), brows.end());
    if (!fit_points(model, points, out)) return false;
    set_landmarks(model, annotated, out);
    for (const AnnotatedLandmark& a : brows) out.landmarks[model.find_landmark(a.name.c_str())] = a.x;
  }
  *photograph = std::move(out);
  return true;
}

std::vector<AnnotatedPicture> read_annotated(const std::string& folder, Portion portion) {
  const std::string path = folder + "/landmarks.csv";
  const CsvTable table(path, read_file(path));
  const std::size_t name = table.column("name"), landmark = table.column("landmark"), x = table.column("x"),
                    y = table.column("y");
  std::vector<AnnotatedPicture> pictures;
  std::map<std::string, std::size_t> number;  // by name: a person's rows need not follow one another
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    const std::string& of = table.cell(row, name);
    if (is_held_out(of) != (portion == Portion::held_out)) continue;
    const auto [entry, is_new] = number.emplace(of, pictures.size());
    if (is_new) pictures.push_back({of, {}, {}});
    pictures[entry->second].landmarks.push_back(
        {table.cell(row, landmark), {table.number(row, x), table.number(row, y)}});
  }
  for (AnnotatedPicture& picture : pictures)
    picture.picture = to_grey(read_image(folder + "/" + picture.name + ".jpg"));
  return pictures;
}

std::vector<Photograph> read_photographs(const Model& model, const std::string& folder, Portion portion,
                                         int threads) {
  const std::vector<AnnotatedPicture> pictures = read_annotated(folder, portion);
  std::vector<Photograph> fitted(2 * pictures.size());
  std::vector<std::uint8_t> is_fitted(fitted.size());
  run_parallel(threads, fitted.size(), [&](std::size_t k, std::size_t) {
    const AnnotatedPicture& picture = pictures[k / 2];
    is_fitted[k] = fit_photograph(model, k % 2 == 0 ? picture : mirror_image(picture), &fitted[k]) ? 1 : 0;
    fitted[k].person = static_cast<int>(k / 2);
  });
  std::vector<Photograph> photographs;
  for (std::size_t k = 0; k < fitted.size(); ++k)
    if (is_fitted[k] != 0) photographs.push_back(std::move(fitted[k]));
  return photographs;
}

std::vector<std::string> unknown_landmarks(const Model& model, const std::string& folder) {
  const std::string path = folder + "/landmarks.csv";
  const CsvTable table(path, read_file(path));
  const std::size_t landmark = table.column("landmark");
  std::vector<std::string> unknown;
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    const std::string& name = table.cell(row, landmark);
    const bool is_known = model.find_landmark(name.c_str()) != kNone ||
                          std::find(std::begin(kPupilNames), std::end(kPupilNames), name) != std::end(kPupilNames);
    if (!is_known && std::find(unknown.begin(), unknown.end(), name) == unknown.end()) unknown.push_back(name);
  }
  return unknown;
}

}  // namespace pliant::host::learn
