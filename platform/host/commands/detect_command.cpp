// `pliant detect`: finds the faces in pictures.
#include <filesystem>
#include <optional>

#include "host/commands/command.hpp"
#include "host/commands/face_finder.hpp"
#include "host/io/csv.hpp"
#include "host/io/failure.hpp"
#include "host/io/files.hpp"
#include "host/io/numbers.hpp"
#include "host/io/sources.hpp"
#include "host/render/overlay.hpp"

namespace pliant::host {

namespace {

/// The picture, or all pictures of a folder, ordered by name.
std::vector<std::string> pictures_of(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_directory(path, error)) return {path};
  std::vector<std::string> paths = pictures_in(path, error);
  if (error) fail_input(path, error.message());
  if (paths.empty()) fail_input(path, "has no pictures");
  return paths;
}

std::string name_of(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

std::string header(const Model& model, bool has_landmarks) {
  std::string line = "file,face,score,x,y,width,height";
  if (has_landmarks)
    for (const Landmark& l : model.landmarks())
      line += "," + csv_cell(std::string("x_") + l.name) + "," + csv_cell(std::string("y_") + l.name);
  return line + "\n";
}

std::string row(const std::string& file, std::size_t number, const FoundFace& face, bool has_landmarks) {
  std::string line = csv_cell(file) + "," + std::to_string(number);
  const auto add = [&](float value) { line += "," + decimal_text(static_cast<double>(value)); };
  const float side = face.box.side;
  for (const float value :
       {face.aligned.score, face.box.center.x - side / 2, face.box.center.y - side / 2, side, side})
    add(value);
  for (const Vec2 x : face.landmarks)
    if (has_landmarks) add(x.x), add(x.y);
  return line + "\n";
}

void draw_faces(const std::string& path, const Image& picture, const std::vector<FoundFace>& faces) {
  Overlay overlay(picture);
  for (const FoundFace& face : faces) {
    overlay.draw_box(face.box.center, face.box.side);
    for (const Vec2 x : face.landmarks) overlay.draw_landmark(x);
  }
  write_file(path, encode_png(overlay.image()));
}

/// What the faces of all pictures come to.
struct Found {
  std::string table;
  std::size_t faces = 0, with_face = 0, unread = 0;
};

/// Finds the faces of each picture. In a folder a picture that cannot be read, or is too large, has no rows and a line of its own
/// on `err`: one bad file among thousands does not cost the work on the others.
Found find_faces(const Args& args, const ModelFile& file, const std::vector<std::string>& paths,
                 Console& console) {
  const auto min_score = static_cast<float>(args.number("--min-score", double(kLeastFaceScore), 0, 1));
  const bool has_landmarks = args.has("--landmarks");
  const auto overlay = args.text("--overlay");
  FaceFinder finder(file);
  Found found{header(file.model(), has_landmarks)};
  Progress progress(console, "picture", paths.size());
  const auto search = [&](const std::string& path) {
    const Image picture = read_image(path);
    const std::vector<FoundFace> faces = finder.find(to_grey(picture), path, min_score);
    for (std::size_t i = 0; i < faces.size(); ++i)
      found.table += row(name_of(path), i, faces[i], has_landmarks);
    if (overlay) draw_faces(*overlay, picture, faces);
    found.faces += faces.size();
    found.with_face += faces.empty() ? 0 : 1;
  };
  for (std::size_t k = 0; k < paths.size(); ++k) {
    try {
      search(paths[k]);
    } catch (const Failure& failure) {
      if (paths[k] == args.required("--image")) throw;
      progress.note(std::string("pliant detect: ") + failure.what());
      ++found.unread;
    }
    progress.show(k + 1);
  }
  return found;
}

int run_detect(const Args& args, Console& console) {
  const ModelFile file(args.operand(0));
  const std::vector<std::string> paths = pictures_of(args.required("--image"));
  if (args.has("--overlay") && std::filesystem::is_directory(args.required("--image")))
    fail_usage("--overlay draws one picture; --image is a folder");
  const auto path = args.text("-o");
  std::optional<OutputFile> output;  // opened before the search, which takes long for many pictures
  if (path) output.emplace(*path);
  const Found found = find_faces(args, file, paths, console);
  if (output) {
    output->write(found.table);
    output->commit();
    console.out << *path << ": " << found.faces << " faces in " << found.with_face << " of " << paths.size()
                << " pictures";
    if (found.unread > 0) console.out << ", of which " << found.unread << " could not be read";
    console.out << "\n";
  } else {
    console.out << found.table;
  }
  return found.unread > 0 ? kBadInput : 0;
}

}  // namespace

Command detect_command() {
  return {
      "detect",
      "Finds the faces in pictures: where they are, and their landmarks.",
      "face.plm --image PICTURE|FOLDER [-o faces.csv] [--landmarks] [--min-score P] [--overlay out.png]",
      {{"--image", "PICTURE", "a picture of 1 to 8192 pixels a side, or a folder of pictures", Takes::input},
       {"-o", "CSV", "the table to write, a row a face, the best first (standard output)", Takes::output},
       {"--landmarks", nullptr, "also write the image position of every landmark"},
       {"--min-score", "P", "leave out faces with a smaller probability (0.5)"},
       {"--overlay", "PNG", "the picture with boxes and landmarks drawn on it", Takes::output}},
      1,
      run_detect};
}

}  // namespace pliant::host
