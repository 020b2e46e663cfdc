#include "host/bake/bake.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "face/alignment.hpp"
#include "host/bake/arkit_names.hpp"
#include "host/bake/cage_source.hpp"
#include "host/bake/obj_source.hpp"
#include "host/bake/record_limit.hpp"
#include "host/bake/source_error.hpp"
#include "host/bake/springs.hpp"
#include "host/io/ibug_names.hpp"
#include "host/io/learnt_file.hpp"
#include "model/table_reader.hpp"

namespace pliant::host::bake {

namespace {

void check(const BakeOptions& options) {
  if (options.bits != 8 && options.bits != 16) throw SourceError("--bits", 0, "must be 8 or 16");
  if (options.size < 16 || options.size > 512) throw SourceError("--size", 0, "must be from 16 to 512");
  if (options.base_vertices < 60 || options.base_vertices > 5000)
    throw SourceError("--base-mesh", 0, "must be from 60 to 5000");
  if (!(options.unit_mm >= kLeastUnitMm && options.unit_mm <= kMostUnitMm))
    throw SourceError("--unit", 0, "must be from a nanometre to a kilometre (0.000001 to 1000000)");
  if (options.components < 0 || options.components > int{table::kMaxParameters})
    throw SourceError("--pca", 0, "must be from 1 to " + std::to_string(table::kMaxParameters));
  if (options.modes < 0 || options.modes > 64) throw SourceError("--modes", 0, "must be from 1 to 64");
  if (!(options.stiffness >= 1e-4f && options.stiffness <= 1e4f))
    throw SourceError("--stiffness", 0, "must be from 0.0001 to 10000");
  if (options.stretch > 0 && !(options.stretch >= kLeastStretch && options.stretch <= 1))
    throw SourceError("--stretch", 0, "must be from 0.0001 to 1, or 0");
}

SourceSprings springs_of(const Source& source, const BakeOptions& options) {
  const float sd = options.stretch >= 0 ? options.stretch : options.modes > 0 ? kBendingStretch : 0;
  return sd > 0 ? make_springs(source, sd) : SourceSprings{};
}

Source read_all(const BakeOptions& options) {
  const char* const for_obj = options.modes > 0          ? "--modes"
                              : !options.texture.empty() ? "--texture"
                              : options.components > 0   ? "--pca"
                              : options.relaxes_chart    ? "--relax-chart"
                              : options.unit_mm != 1     ? "--unit"
                                                         : nullptr;
  if (is_cage_folder(options.source) && for_obj != nullptr)
    throw SourceError(for_obj, 0, "needs an OBJ file or a folder of OBJ files");
  if (is_cage_folder(options.source)) return read_cage_source(options.source);
  if (is_obj_source(options.source)) {
    ObjOptions obj;
    obj.unit_mm = options.unit_mm;
    obj.components = options.components;
    obj.relaxes_chart = options.relaxes_chart;
    obj.modes = options.modes;
    obj.stiffness = options.stiffness;
    obj.texture = options.texture;
    obj.most_texture_side = most_texture_side(options.size);
    obj.progress = options.progress;
    return read_obj_source(options.source, obj);
  }
  std::error_code error;
  if (!std::filesystem::exists(options.source, error))
    throw SourceError(options.source, 0, error ? error.message() : "no such file or folder");
  if (!std::filesystem::is_directory(options.source, error))
    throw SourceError(options.source, 0, "is neither an OBJ file nor a folder");
  if (std::filesystem::directory_iterator(options.source, error); error)
    throw SourceError(options.source, 0, error.message());
  throw SourceError(options.source, 0,
                    "has neither the tables of a surface (points.txt and others) nor OBJ files");
}

bool has_landmark(const Source& source, int number) {
  const std::string name = ibug_name(number);
  return std::any_of(source.landmarks.begin(), source.landmarks.end(),
                     [&name](const auto& l) { return l.name == name; });
}

/// Whether the learnt tables of faces can be used: they know a face by these.
bool has_corners_of_face(const Source& source) {
  return has_landmark(source, 36) && has_landmark(source, 45) && has_landmark(source, 48) &&
         has_landmark(source, 54);
}

/// Refuses an aligner that needs more landmarks than the surface has. A damaged one is told of where it is used.
void check_aligner(const std::vector<std::uint8_t>& bytes, const std::string& path, const Source& source) {
  AlignerTable table;
  if (AlignerTable::open({bytes.data(), bytes.size()}, &table) != Status::ok) return;
  const std::size_t count = table.landmark_count();
  const auto had =
      static_cast<std::size_t>(std::count_if(table.landmark_numbers(), table.landmark_numbers() + count,
                                             [&source](int number) { return has_landmark(source, number); }));
  const float needed = kAlignmentTuning.least_landmarks * static_cast<float>(count);
  if (static_cast<float>(had) < needed)
    throw SourceError(path, 0,
                      "aligns faces by " + std::to_string(count) + " landmarks ibugNN, and needs " +
                          std::to_string(static_cast<int>(std::ceil(needed))) + " of them: the surface has " +
                          std::to_string(had) + " (--learnt none does without)");
}

LearntTables learnt_tables(const BakeOptions& options, const Source& source) {
  const std::string beside = options.source + "/learnt.bin";
  const bool is_given = !options.learnt.empty();
  if (options.learnt == "none" || (!is_given && !std::filesystem::exists(beside))) return {};
  const std::string& path = is_given ? options.learnt : beside;
  if (!has_corners_of_face(source))
    throw SourceError(path, 0,
                      "finds faces: the surface lacks a landmark of ibug36, ibug45, ibug48 and ibug54, the "
                      "outer corners of eyes and mouth (--learnt none does without)");
  LearntTables learnt = read_learnt(path);
  check_aligner(learnt.aligner, path, source);
  return learnt;
}

/// Refuses to choose from parameters that the source has none of.
void check_choice(const Source& source, const BakeOptions& options) {
  const auto has = [&](Group group) {
    const auto& p = source.parameters;
    return std::any_of(p.begin(), p.end(), [group](const auto& q) { return q.group == group; });
  };
  const ParameterChoice& choice = options.choice;
  if (choice.identities > 0 && !has(Group::identity))
    throw SourceError("--identities", 0, options.source + " has no identities");
  if ((choice.expressions > 0 || !choice.named.empty()) && !has(Group::expression))
    throw SourceError("--expressions", 0, options.source + " has no expressions");
}

}  // namespace

Source read_source(const BakeOptions& options) {
  check(options);
  Source source = read_all(options);
  check_choice(source, options);
  choose_parameters(source, options.choice);
  source.springs = springs_of(source, options);
  source.learnt = learnt_tables(options, source);
  return source;
}

bool bake(const BakeOptions& options, std::vector<std::uint8_t>& table, std::string& error,
          BakeReport* report) {
  try {
    Source source = read_source(options);
    leave_out_corrections(source);
    auto bytes = bake_source(source, options, report);
    if (report != nullptr) report->unmatched = names_unknown_to_arkit(source);
    table = std::move(bytes);
    return true;
  } catch (const std::runtime_error& e) {
    error = e.what();
    return false;
  }
}

}  // namespace pliant::host::bake
