// `pliant render`: renders a video of a model with known parameters and writes the truth.
#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>

#include "host/commands/calibration_option.hpp"
#include "host/commands/command.hpp"
#include "host/commands/image_fit.hpp"
#include "host/commands/render_grid.hpp"
#include "host/io/failure.hpp"
#include "host/io/files.hpp"
#include "host/io/numbers.hpp"
#include "host/io/track_table.hpp"
#include "host/io/y4m_writer.hpp"
#include "host/render/overlay.hpp"
#include "host/render/scene.hpp"

namespace pliant::host {

namespace {

/// Height of the model as a fraction of the picture's, if no distance is given. Leaves room for motion.
constexpr float kFilledFraction = 0.55f;

FrameRate rate_of(double per_second) {
  const int thousandths = static_cast<int>(std::lround(per_second * 1000));
  const int common = std::gcd(thousandths, 1000);
  return {thousandths / common, 1000 / common};
}

/// Two tables with the truth of a rendered video: pose, parameters and landmarks of each frame.
class Truth {
 public:
  Truth(const Args& args, const Model& model, const ImageSize& size)
      : model_(model), cascade_(model), size_(size) {
    for (const Landmark& l : model.landmarks()) names_.push_back(l.name);
    if (const auto path = args.text("--truth")) rows_ = std::make_unique<OutputFile>(*path);
    if (const auto path = args.text("--truth-points")) points_ = std::make_unique<OutputFile>(*path);
    if (rows_) rows_->write(track_header(model, names_));
    if (points_) points_->write("frame,landmark,x,y\n");
  }
  void add(std::size_t frame, double time_s, const PosedParameters& state, const Camera& camera) {
    TrackRow row;
    row.frame = frame;
    row.time_s = time_s;
    row.pose = state.pose;
    row.q = state.q;
    row.points = project_landmarks(model_, *cascade_, state.pose, camera, size_, state.q.data());
    if (rows_) rows_->write(track_line(row));
    for (std::size_t k = 0; points_ && k < names_.size(); ++k)
      if (row.points[k])
        points_->write(std::to_string(frame) + "," + csv_cell(names_[k]) + "," +
                       number_text(static_cast<double>(row.points[k]->x)) + "," +
                       number_text(static_cast<double>(row.points[k]->y)) + "\n");
  }
  void commit() {
    if (rows_) rows_->commit();
    if (points_) points_->commit();
  }

 private:
  Model model_;
  Owned<Cascade> cascade_;
  ImageSize size_;
  std::vector<std::string> names_;
  std::unique_ptr<OutputFile> rows_, points_;
};

/// Whether all channels of every pixel are equal.
bool is_grey(const Image& image) {
  const auto channels = static_cast<std::size_t>(image.channels);
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    if (image.pixels[i] != image.pixels[i / channels * channels]) return false;
  return true;
}

/// Grey, unless --background is in colour.
Image background_of(const Args& args, const ImageSize& size, std::uint32_t seed) {
  const auto path = args.text("--background");
  if (!path) return make_background(size.width, size.height, seed);
  Image image = read_image(*path);
  if (image.width != size.width || image.height != size.height)
    fail_input(*path, "is of " + std::to_string(image.width) + "x" + std::to_string(image.height) +
                          " pixels, not " + std::to_string(size.width) + "x" + std::to_string(size.height));
  return is_grey(image) ? to_grey(image) : image;
}

/// Gives lost rows at the start the state of the first that is not, as `animate` does: they have no row before. Bad input: all are
/// lost. \return the number of lost rows.
std::size_t fill_lost(const CsvTable& table, std::vector<PosedParameters>& rows) {
  const auto state = table.find_column("state");
  std::size_t count = 0, first = rows.size();
  for (std::size_t r = 0; r < rows.size(); ++r)
    if (state && table.cell(r, *state) == "lost")
      ++count;
    else
      first = std::min(first, r);
  if (first == rows.size()) fail_input(table.source(), "is of a track that has found nothing");
  std::fill(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(first), rows[first]);
  return count;
}

std::vector<PosedParameters> read_rows(const Args& args, const ModelFile& file, const Camera& camera,
                                       int height, Console& console) {
  const Model& model = file.model();
  PosedParameters neutral;
  neutral.q.assign(model.parameters().count, 0.0f);
  if (const auto path = args.text("--identity")) {
    const FitFile fit = parse_fit(*path, read_file(*path));
    list_unmatched(apply(fit.parameters, *path, model, neutral.q.data()), *path, console.err);
    for (std::size_t k = 0; k < neutral.q.size(); ++k)
      if (model.parameters()[k].group != Group::identity) neutral.q[k] = 0;
  }
  neutral.pose = frontal_pose(model, neutral.q.data(), camera, height, kFilledFraction);
  const std::string path = args.required("--params");
  const CsvTable table(path, read_file(path));
  std::vector<std::string> unmatched;
  auto rows = read_posed_parameters(table, model, neutral, &unmatched);
  list_unmatched(unmatched, path, console.err);
  if (rows.empty()) fail_input(path, "has no rows");
  list_lost(fill_lost(table, rows), rows.size(), path, console.err);
  list_clamped(clamp_to_limits(model, rows), path, console.err);
  return rows;
}

/// Renders people and expressions into one picture instead of a video.
int run_grid(const Args& args, Console& console) {
  args.refuse({"-o", "--identity", "--truth", "--truth-points", "--focal", "--calibration", "--noise",
               "--seed", "--rate", "--background"},
              "does not apply to --grid");
  const std::string output = args.required("--grid"), people = args.required("--people"),
                    expressions = args.required("--params");
  const ImageSize cell = args.size("--size").value_or(ImageSize{84, 112});
  if (cell.width > 1024 || cell.height > 1024) fail_usage("--size must be at most 1024x1024 with --grid");
  const ModelFile file(args.operand(0));
  const Image grid = draw_grid(file, people, expressions, cell, console);
  write_file(output, encode_png(grid));
  console.out << output << ": " << grid.width << "x" << grid.height << " pixels\n";
  return 0;
}

int run_render(const Args& args, Console& console) {
  if (args.has("--grid")) return run_grid(args, console);
  args.check_needs("--people", "--grid");
  const std::string output = args.required("-o");
  const ImageSize size = args.size("--size").value_or(ImageSize{320, 240});
  const auto f = static_cast<float>(args.number("--focal", static_cast<double>(default_focal(size)), 1, 1e6));
  const auto noise = static_cast<float>(args.number("--noise", 2, 0, 128));
  const auto seed = static_cast<std::uint32_t>(args.integer("--seed", 1, 0, 1 << 30));
  const FrameRate rate = rate_of(args.number("--rate", 30, 0.001, 1000));
  const ModelFile file(args.operand(0));
  const Camera camera =
      calibration_of(args, size, console.err).value_or(centred_camera(size.width, size.height, f));
  const auto rows = read_rows(args, file, camera, size.height, console);
  const Image background = background_of(args, size, seed);

  Scene scene(file.model(), size.width, size.height);
  Truth truth(args, file.model(), size);
  Y4mWriter video(output, rate);
  Progress progress(console, "frame", rows.size());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    Image image = scene.draw(rows[k].q.data(), rows[k].pose, camera, background);
    add_noise(image, noise, seed + 0x10001u * static_cast<std::uint32_t>(k));
    video.write(image);
    truth.add(k, static_cast<double>(k) / rate.per_second(), rows[k], camera);
    progress.show(k + 1);
  }
  video.commit();
  truth.commit();
  console.out << output << ": " << rows.size() << " frames of " << size.width << "x" << size.height << ", f "
              << number_text(static_cast<double>(camera.f)) << " px\n";
  return 0;
}

}  // namespace

Command render_command() {
  return {
      "render",
      "Renders a model with known pose and parameters, frame by frame, and writes the truth.",
      "face.plm --params q.csv -o frames.y4m [--identity fit.json] [--truth truth.csv] [--truth-points "
      "points.csv] "
      "[--size WxH] [--focal PX|--calibration camera.yml] [--noise SD] [--seed N] [--rate FPS] [--background "
      "PICTURE] | face.plm --grid grid.png --people people.csv --params expressions.csv [--size WxH]",
      {{"--params", "CSV", "one row a frame, columns as in a track; missing columns are neutral and frontal",
        Takes::input},
       {"-o", "Y4M", "the video to write: grey, or in colour over a background in colour", Takes::output},
       {"--identity", "JSON", "a fit; its identity replaces missing columns of --params", Takes::input},
       {"--truth", "CSV", "the truth, as a track with landmarks", Takes::output},
       {"--truth-points", "CSV", "the true landmarks: frame,landmark,x,y", Takes::output},
       {"--size", "WxH", "size of the frames, pixels (320x240)"},
       {"--focal", "PX", "focal length, pixels (1.4 times the larger side)"},
       {"--calibration", "YML", "intrinsics and lens, as OpenCV's calibration writes them", Takes::input},
       {"--noise", "SD", "standard deviation of sensor noise, grey levels, 0 to 128 (2)"},
       {"--seed", "N", "seed of noise and background (1)"},
       {"--rate", "FPS", "frames a second (30)"},
       {"--background", "PICTURE",
        "a picture of the frames' size behind the model, whose albedo is grey (default: soft blotches)",
        Takes::input},
       {"--grid", "PNG",
        "instead of a video: a picture with one person a column and one expression, a row of --params with "
        "its name in the column name, a row; cells of --size (84x112)",
        Takes::output},
       {"--people", "CSV",
        "name, identity parameters and optionally tone (brightness of the surface) of each person",
        Takes::input}},
      1,
      run_render};
}

}  // namespace pliant::host
