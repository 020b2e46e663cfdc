// `pliant learn`: learns the tables of detection and alignment from photographs.
#include "host/commands/command.hpp"
#include "host/io/failure.hpp"
#include "host/io/files.hpp"
#include "host/io/ibug_names.hpp"
#include "host/io/learnt_file.hpp"
#include "host/learn/face_samples.hpp"
#include "host/learn/learn_aligner.hpp"
#include "host/learn/learn_detector.hpp"
#include "host/learn/learn_parts.hpp"

namespace pliant::host {

namespace {

/// What training reads, in memory.
struct TrainingPictures {
  std::vector<learn::Photograph> photographs;
  learn::OtherPictures others, drawn;

  TrainingPictures(const Args& args, const Model& model, int threads, Console& console) {
    const std::string faces = args.required("--faces"), pictures = args.required("--others");
    if (faces != "none") {
      photographs = learn::read_photographs(model, faces, learn::Portion::training, threads);
      if (photographs.empty()) fail_input(faces, "has no photograph to learn from");
      std::string names;
      for (const std::string& name : learn::unknown_landmarks(model, faces))
        names += (names.empty() ? "" : ", ") + name;
      if (!names.empty()) console.err << faces << "/landmarks.csv: the model has no landmark " << names << "\n";
    }
    others = learn::read_other_pictures(pictures);
    if (const auto folder = args.text("--drawn")) drawn = learn::read_other_pictures(*folder);
    console.out << photographs.size() << " photographs with their mirror images, " << others.count()
                << " pictures without faces, " << drawn.count() << " that are drawn\n";
  }
};

learn::LearnOptions learn_options(const Args& args) {
  learn::LearnOptions options;
  options.seed = static_cast<std::uint64_t>(args.integer("--seed", 1, 0, 1 << 30));
  options.threads = args.integer("--threads", 2, 1, 2);
  options.effort = args.number("--effort", 1, 0.001, 4);
  return options;
}

/// Bad input unless the model is a face with the landmarks that training places.
void check_landmarks(const ModelFile& file) {
  const auto check = [&](const std::string& name) {
    if (file.model().find_landmark(name.c_str()) == kNone)
      fail_input(file.path(), "is no face that can be learnt: it has no landmark '" + name + "'");
  };
  for (int k = 0; k < kIbugCount; ++k) check(ibug_name(k));
  check("eye_right");
  check("eye_left");
}

/// The tables that stay: those of the output file that `--only` does not name.
LearntTables kept_tables(const Args& args, const std::string& output) {
  const std::string only = args.text("--only").value_or("");
  if (only.empty()) return {};
  if (only != "detector" && only != "aligner" && only != "parts")
    fail_usage("--only: detector, aligner or parts, not " + only);
  if (only != "aligner")
    args.refuse({"--drawn"}, "does not apply to --only " + only + ": verification learns from it, with the aligner");
  return read_learnt(output);
}

int run_learn(const Args& args, Console& console) {
  const std::string output = args.required("-o"), only = args.text("--only").value_or("");
  const learn::LearnOptions options = learn_options(args);
  LearntTables tables = kept_tables(args, output);
  const ModelFile file(args.operand(0));
  check_landmarks(file);
  OutputFile learnt(output);  // before hours of work for a file that cannot be written
  const TrainingPictures pictures(args, file.model(), options.threads, console);
  const auto samples = [&](const learn::FaceSampleTuning& tuning) {
    return learn::FaceSamples(file.model(), pictures.photographs, pictures.others, options.seed, tuning);
  };
  StageProgress progress(console);
  const auto show = [&](const char* stage, std::size_t done, std::size_t of) {
    progress.show(stage, done, of);
  };
  const auto learns = [&](const char* part) { return only.empty() || only == part; };
  if (learns("detector"))
    tables.detector = learn::learn_detector(samples({}), pictures.others, options, show);
  if (learns("aligner"))
    tables.aligner = learn::learn_aligner(file.model(), samples(learn::aligner_sample_tuning()),
                                          pictures.others, pictures.drawn, tables.detector, options, show);
  if (learns("parts"))
    tables.parts = learn::learn_parts(file.model(), pictures.photographs, pictures.others, options, show);
  learnt.write(format_learnt(tables));
  learnt.commit();
  console.out << output << ": detector " << tables.detector.size() << " bytes, aligner "
              << tables.aligner.size() << " bytes, parts " << tables.parts.size() << " bytes\n";
  return 0;
}

}  // namespace

Command learn_command() {
  return {
      "learn",
      "Learns from photographs how to find a face and how to align the model with it.",
      "face.plm --faces FOLDER|none --others FOLDER [--drawn FOLDER] [--seed N] [--threads N] "
      "[--only detector|aligner|parts] [--effort F] -o learnt.bin",
      {{"--faces", "FOLDER",
        "photographs NAME.jpg of one face each, and landmarks.csv with name,landmark,x,y; a third of "
        "them, by their names, is left out for testing; none: learns from renders of the model alone",
        Takes::input},
       {"--others", "FOLDER", "photographs without faces, in the folder and below it", Takes::input},
       {"--drawn", "FOLDER",
        "pictures without faces that are no photographs, as text and windows of programs, so that these "
        "do not pass for faces",
        Takes::input},
       {"--seed", "N", "of all random choices: the same seed gives the same tables (1)"},
       {"--threads", "N", "1 or 2 (2); the tables do not depend on it"},
       {"--only", "PART", "learn this part again, and keep the other parts of the file of -o"},
       {"--effort", "F", "samples as a fraction of the usual number, 0.001 to 4 (1), for trials"},
       {"-o", "BIN", "the learnt tables to write, for `pliant bake --learnt`", Takes::output}},
      1,
      run_learn};
}

}  // namespace pliant::host
