// `pliant bench`: times and bytes of the library on this machine.
#include <algorithm>
#include <memory>

#include "host/bench/bench.hpp"
#include "host/bench/detection.hpp"
#include "host/commands/command.hpp"
#include "host/commands/tracker_limits.hpp"
#include "host/io/failure.hpp"

namespace pliant::host {

namespace {

template <void (*bench)(std::ostream&, const ModelFile*)>
int run_with_model(const Args& args, Console& console) {
  std::unique_ptr<ModelFile> model;
  if (const auto path = args.text("--model")) model = std::make_unique<ModelFile>(*path);
  bench(console.out, model.get());
  return 0;
}

int run_klt(const Args& args, Console& console) {
  const KltInputs inputs{args.text("--pairs"), args.texts("--motion"), args.text("--frames"),
                         args.integer("--count", 480, 2, 1000000)};
  if (!inputs.pairs && inputs.motions.empty() && !inputs.frames)
    fail_usage("klt needs --pairs, --motion or --frames");
  args.check_needs("--count", "--frames");
  bench_klt(console.out, inputs);
  return 0;
}

int run_mcd(const Args&, Console& console) {
  bench_mcd(console.out);
  return 0;
}

template <void (*bench)(std::ostream&, const ModelFile&)>
int run_on_model(const Args& args, Console& console) {
  bench(console.out, ModelFile(args.required("--model")));
  return 0;
}

int run_fit_bench(const Args& args, Console& console) {
  bench_fit(console.out, args.required("--problems"));
  return 0;
}

int run_detection(const Args& args, Console& console) {
  const DetectionInputs inputs{args.text("--portraits"), args.text("--others"),
                               args.text("--film"),      args.text("--truth"),
                               args.text("--details"),   args.integer("--count", 1000000, 1, 1000000)};
  if (!inputs.portraits && !inputs.others && !inputs.film)
    fail_usage("detection needs --portraits, --others or --film");
  if (inputs.film.has_value() != inputs.truth.has_value()) fail_usage("--film and --truth need each other");
  if (!inputs.portraits && !inputs.others)
    args.refuse({"--count"}, "has nothing to act on: --portraits or --others is needed");
  bench_detection(console.out, ModelFile(args.required("--model")), inputs);
  return 0;
}

int run_print(const Args& args, Console& console) {
  bench_print(console.out, ModelFile(args.required("--model")), args.text("--others"),
              args.integer("--count", 40, 1, 100000));
  return 0;
}

int run_faults(const Args& args, Console& console) {
  const std::string film = args.required("--film");
  const ModelFile file(args.required("--model"));
  bench_faults(console.out, file, with_base_mesh(tracker_limits(args, std::nullopt), file.model()), film,
               static_cast<std::size_t>(args.integer("--count", 4, 1, 1000)));
  return 0;
}

struct Topic {
  const char* name;
  int (*run)(const Args& args, Console& console);
  std::vector<std::string> options;  // that it uses
};
std::vector<Topic> topics() {
  return {{"mesh", run_with_model<bench_mesh>, {"--model"}},
          {"fields", run_with_model<bench_fields>, {"--model"}},
          {"klt", run_klt, {"--pairs", "--motion", "--frames", "--count"}},
          {"mcd", run_mcd, {}},
          {"track", run_on_model<bench_track>, {"--model"}},
          {"cost", run_on_model<bench_cost>, {"--model"}},
          {"cues", run_on_model<bench_cues>, {"--model"}},
          {"drift", run_on_model<bench_drift>, {"--model"}},
          {"occlusion", run_on_model<bench_occlusion>, {"--model"}},
          {"fit", run_fit_bench, {"--problems"}},
          {"detection",
           run_detection,
           {"--model", "--portraits", "--others", "--film", "--truth", "--details", "--count"}},
          {"print", run_print, {"--model", "--others", "--count"}},
          {"faults", run_faults, {"--model", "--film", "--count", "--profile", "--vertices", "--points"}}};
}

/// Bad usage: an option that the topic does not use.
void check_options(const Args& args, const Topic& topic) {
  for (const Option& option : bench_command().options)
    if (std::find(topic.options.begin(), topic.options.end(), option.name) == topic.options.end())
      args.refuse({option.name}, std::string("does not apply to the topic ") + topic.name);
}

int run_bench(const Args& args, Console& console) {
  std::string names;
  for (const Topic& topic : topics()) {
    names += std::string(names.empty() ? "" : ", ") + topic.name;
    if (args.operand(0) != topic.name) continue;
    check_options(args, topic);
    console.out << "topic,peer,variant,metric,value\n";
    return topic.run(args, console);
  }
  fail_usage("no such topic: " + args.operand(0) + "; there are " + names);
}

}  // namespace

Command bench_command() {
  return {"bench",
          "Measures the library on this machine: rows of topic,peer,variant,metric,value.",
          "mesh|fields [--model face.plm] | klt --pairs FOLDER | klt --motion FOLDER | klt --frames VIDEO | "
          "mcd | track|cost|cues|drift|occlusion --model face.plm | fit --problems FOLDER | "
          "detection --model face.plm [--portraits FOLDER] [--others FOLDER] [--film VIDEO --truth CSV] "
          "[--details CSV] | print --model sheet.plm [--others FOLDER] [--count N] | "
          "faults --model face.plm --film VIDEO [--count N] [--profile s|m|l] [--vertices V] [--points N]",
          {{"--model", "PLM", "a model to measure with; optional for mesh and fields", Takes::input},
           {"--pairs", "FOLDER",
            "pairs of pictures with known motion: A_SIZE.pgm, B_CASE_SIZE.pgm, truth.csv", Takes::input},
           {"--motion", "FOLDER", "00001.pgm ... and motion.csv, to measure drift; may repeat", Takes::texts},
           {"--frames", "VIDEO", "a Y4M file or folder of pictures, to time tracking on", Takes::input},
           {"--problems", "FOLDER", "fitting problems as text, and solutions.csv with the optimum of each",
            Takes::input},
           {"--portraits", "FOLDER", "photographs of one face each, and landmarks.csv: name,landmark,x,y",
            Takes::input},
           {"--others", "FOLDER", "photographs without faces; of print, without the surface", Takes::input},
           {"--film", "VIDEO", "a film of one face; of detection, with --truth", Takes::input},
           {"--truth", "CSV", "frame,landmark,x,y of every frame of --film", Takes::input},
           {"--details", "CSV", "a file to write: a row a picture or start", Takes::output},
           {"--count", "N",
            "frames of --frames (480), or pictures of a folder (all), that are read at most; starts "
            "a case of print (40), clips of faults (4)"},
           kProfileOption,
           kVerticesOption,
           kPointsOption},
          1,
          run_bench};
}

}  // namespace pliant::host
