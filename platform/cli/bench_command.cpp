// `pliant bench`: times and bytes of the library on this machine.
#include <memory>

#include "cli/bench.hpp"
#include "cli/command.hpp"
#include "cli/failure.hpp"

namespace pliant::cli {

namespace {

int run_bench(const Args& args, Console& console) {
  const std::string topic = args.operand(0);
  std::unique_ptr<ModelFile> model;
  if (const auto path = args.text("--model")) model = std::make_unique<ModelFile>(*path);
  if (topic != "mesh") fail_usage("no such topic: " + topic + "; there is mesh");
  console.out << "topic,peer,variant,metric,value\n";
  bench_mesh(console.out, model.get());
  return 0;
}

}  // namespace

Command bench_command() {
  return {"bench",
          "Measures the library on this machine: rows of topic,peer,variant,metric,value.",
          "mesh [--model face.plm]",
          {{"--model", "PLM", "a model to measure with as well"}},
          1,
          run_bench};
}

}  // namespace pliant::cli
