#include <map>

#include "host/io/csv.hpp"
#include "host/io/failure.hpp"
#include "host/commands/image_fit.hpp"
#include "experiment.hpp"
#include "host/io/frame_source.hpp"

namespace pliant::figure9 {

namespace {

void read_frames(Experiment& e, const Recording& r) {
  host::OpenedFrames opened = host::open_frames(r.video);
  if (opened.source == nullptr) throw host::Failure(host::kBadInput, opened.message);
  e.frames_per_second = opened.source->rate().per_second() / r.every;
  FrameView view;
  for (int k = 0; opened.source->next(view) == Status::ok; ++k) {
    if (k % r.every == 0) e.frames.push_back(host::image_of(view));
    if (r.frames > 0 && static_cast<int>(e.frames.size()) == r.frames) break;
  }
  if (e.frames.empty()) host::fail_input(r.video, "has no frames");
}

void read_truth(Experiment& e, const Recording& r) {
  std::map<std::string, std::size_t> index;
  for (const host::NamedPoint& p : host::read_points(r.markers)) index.emplace(p.name, index.size());
  e.truth.assign(e.frames.size(), std::vector<std::optional<Vec2>>(index.size()));
  const host::CsvTable table(r.truth, host::read_file(r.truth));
  const std::size_t frame = table.column("frame"), name = table.column("landmark"), x = table.column("x"),
                    y = table.column("y");
  for (std::size_t i = 0; i < table.row_count(); ++i) {
    const auto found = index.find(table.cell(i, name));
    const int k = static_cast<int>(table.number(i, frame));
    if (found == index.end() || k % r.every != 0) continue;
    const auto used = static_cast<std::size_t>(k / r.every);
    if (used < e.truth.size()) e.truth[used][found->second] = Vec2{table.number(i, x), table.number(i, y)};
  }
}

}  // namespace

Experiment read_recorded(const Model& model, const std::string& model_path, const Recording& recording) {
  Experiment e;
  e.name = "recorded";
  read_frames(e, recording);
  read_truth(e, recording);
  e.is_hidden.assign(e.frames.size(), 0);
  const host::ModelFile file(model_path);
  host::FitSetup setup;
  setup.size = {e.frames[0].width, e.frames[0].height};
  const host::FitFile fit = host::fit_to_points(file, recording.init, host::read_points(recording.init), setup);
  e.camera = fit.camera;
  e.pose = fit.pose;
  e.q.assign(model.parameters().count, 0.0f);
  host::apply(fit.parameters, recording.init, model, e.q.data());
  return e;
}

}  // namespace pliant::figure9
