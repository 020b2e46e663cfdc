// `pliant animate`: applies a track's expressions and head motion to any person and any model, and writes a file that other
// programs play (the paper, section 7).
#include <filesystem>

#include "host/commands/command.hpp"
#include "host/commands/image_fit.hpp"
#include "host/io/failure.hpp"
#include "host/io/files.hpp"
#include "host/io/numbers.hpp"
#include "host/io/track_table.hpp"
#include "host/io/words.hpp"
#include "host/render/animation_file.hpp"
#include "host/render/photo_texture.hpp"
#include "host/render/retarget.hpp"
#include "host/render/shown_mesh.hpp"

namespace pliant::host {

namespace {

struct Input {
  Retargeted track;
  std::string who;      // whose identity it is, for the summary
  std::string picture;  // the texture, as glb_bytes takes it
  bool is_lit = true;
};

/// The texture from the photograph that the identity was fitted to.
std::string picture_of(const std::string& path, const std::string& identity, const FitFile& fit,
                       const ModelFile& file) {
  const Image photo = read_image(path);
  if (photo.width != fit.width || photo.height != fit.height)
    fail_input(path, "is not the picture of " + identity + ": that has " + std::to_string(fit.width) + "x" +
                         std::to_string(fit.height) + " pixels");
  const std::vector<float> q = all_parameters(fit, identity, file.model());
  return encode_jpeg(photo_texture(file.model(), fit, q, photo, kPhotoTextureSide), kPhotoTextureQuality);
}

Input read_input(const Args& args, const ModelFile& file, Console& console) {
  const std::string path = args.required("--params");
  RetargetSetup setup;
  setup.rate = args.number("--rate", 30, 0.001, 1000);
  Input input;
  const CsvTable table(path, read_file(path));
  if (table.find_column("time_s"))
    args.refuse({"--rate"}, "does not apply to " + path + ", which has times (time_s)");
  std::optional<ModelFile> source;
  if (const auto from = args.text("--from")) source.emplace(*from);
  if (source) setup.source = &source->model();
  input.picture = albedo_png(file.model());
  FitFile fit;
  if (const auto identity = args.text("--identity")) {
    fit = parse_fit(*identity, read_file(*identity));
    check_model(fit, *identity, file);
    std::vector<float> q(file.model().parameters().count, 0.0f);
    list_unmatched(apply(fit.parameters, *identity, file.model(), q.data()), *identity, console.err);
    setup.identity = &fit.parameters;
    setup.identity_path = *identity;
    input.who = *identity;
    if (const auto photo = args.text("--image")) {
      input.picture = picture_of(*photo, *identity, fit, file);
      input.is_lit = false;
    }
  }
  input.track = retarget(table, file.model(), setup);
  if (input.who.empty()) input.who = input.track.has_identity ? "the track's" : "the mean";
  list_unmatched(input.track.unmatched, path, console.err);
  if (!input.track.unscaled.empty()) {
    console.err << path << ": " << source->path()
                << " has no parameter of these names, their values are taken as they are:";
    for (const std::string& name : input.track.unscaled) console.err << " " << name;
    console.err << "\n";
  }
  list_clamped(input.track.limited, path, console.err,
               source ? "" : " (--from TRACKED.plm keeps fractions of the ranges)");
  list_lost(input.track.lost, input.track.frames.size(), path, console.err);
  return input;
}

void print_summary(const Morphs& morphs, std::ostream& out) {
  char line[256];
  const std::size_t expressions = morphs.parameters.size(), correctives = morphs.targets.size() - expressions;
  std::snprintf(
      line, sizeof line,
      "targets: %zu expressions, %zu correctives; vertices against the exact surface: mean %.4f mm, max "
      "%.3f mm (expressions alone: %.4f, %.3f)\n",
      expressions, correctives, morphs.all.mean_mm, morphs.all.max_mm, morphs.linear.mean_mm,
      morphs.linear.max_mm);
  out << line;
}

int run_animate(const Args& args, Console& console) {
  const std::string output = args.required("-o");
  args.required("--params");
  const bool is_folder = ends_with(output, "/") || std::filesystem::is_directory(output);
  if (!is_folder && !ends_with(in_lower_case(output), ".glb"))
    fail_usage("-o must end in .glb, or in / for a folder of OBJ files: " + output);
  if (is_folder)
    args.refuse({"--image", "--tolerance"},
                "is of a GLB: the OBJ files of a folder have neither texture nor targets");
  args.check_needs("--image", "--identity");
  const int vertices = args.integer("--vertices", 2000, 16, 11000);
  const auto tolerance = static_cast<float>(args.number("--tolerance", 0.1, 0, 1000));
  const ModelFile file(args.operand(0));
  const Input input = read_input(args, file, console);

  std::vector<float> rest = input.track.frames.front().state.q;
  for (const std::uint16_t k : input.track.driven) rest[k] = 0;
  ModelSurface surface(file.model(), rest);
  const MeshData mesh = closed_mesh(
      ModelMesh(file.model(), surface, {MeshCriterion::contour, MeshLimits::kDeepest / 2, 0, vertices}));
  MorphSurface animated(file.model(), mesh.uv, rest);
  const auto& frames = input.track.frames;
  Progress progress(console, "frame", frames.size());
  if (is_folder) {
    write_obj_frames(output, mesh, animated, input.track, [&](std::size_t k) { progress.show(k); });
  } else {
    std::vector<std::vector<float>> q;
    for (const RetargetFrame& frame : frames) q.push_back(frame.state.q);
    const Morphs morphs = make_morphs(animated, mesh.faces, q, input.track.driven, tolerance);
    write_file(output, animation_glb(mesh, morphs, file.model(), input.track, input.picture, input.is_lit));
    print_summary(morphs, console.out);
  }
  console.out << output << ": " << frames.size() << " frames, "
              << number_text(frames.back().time_s - frames.front().time_s) << " s, " << mesh.position.size()
              << " vertices, identity: " << input.who << "\n";
  return 0;
}

}  // namespace

Command animate_command() {
  return {
      "animate",
      "Applies a track's expressions and head motion to a person and a model, for other programs to play.",
      "face.plm --params track.csv [--identity fit.json [--image picture]] [--from tracked.plm] [--vertices "
      "N] [--tolerance "
      "MM] "
      "[--rate FPS] -o animation.glb|FOLDER/",
      {{"--params", "CSV",
        "a track, or any table with its columns; missing ones are neutral and frontal. Expressions are "
        "matched by name",
        Takes::input},
       {"--identity", "JSON",
        "a fit of this model with the identity (default: that of the track, or the mean)", Takes::input},
       {"--image", "FILE", "the picture of that fit; it becomes the texture", Takes::input},
       {"--from", "PLM", "the model that was tracked. Values keep their fraction of its ranges",
        Takes::input},
       {"--vertices", "N", "vertices of the mesh, about, to 11000; at least those of the base mesh (2000)"},
       {"--tolerance", "MM", "omit corrective targets that move no vertex this far, in millimetres (0.1)"},
       {"--rate", "FPS", "frames a second of a table without time_s (30)"},
       {"-o", "GLB",
        "glTF with morph targets and head motion; a folder gets one OBJ a frame, without head motion",
        Takes::output}},
      1,
      run_animate};
}

}  // namespace pliant::host
