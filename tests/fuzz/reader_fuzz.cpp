// Fuzzes the readers of the host tools: any bytes are read or refused by the exception that ends a command with one line.
//
// option: --reader=NAME, of the list below
#include <sys/mman.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <set>
#include <stdexcept>
#include <string>

#include "host/bake/obj_file.hpp"
#include "host/bake/source_error.hpp"
#include "host/bake/text_table.hpp"
#include "host/commands/args.hpp"
#include "host/io/calibration.hpp"
#include "host/io/csv.hpp"
#include "host/io/failure.hpp"
#include "host/io/fit_file.hpp"
#include "host/io/frame_source.hpp"
#include "host/io/json.hpp"
#include "host/io/learnt_file.hpp"
#include "host/io/pnm.hpp"
#include "host/io/points_file.hpp"
#include "host/io/sources.hpp"
#include "host/io/track_table.hpp"
#include "host/io/truth.hpp"
#include "model_table.hpp"

using namespace pliant;
using namespace pliant::host;

namespace {

void require(bool condition) {
  if (!condition) std::abort();
}

/// Bytes as a file that readers open by its name.
class MemoryFile {
 public:
  MemoryFile() : file_(memfd_create("fuzz", 0)), path_("/proc/self/fd/" + std::to_string(file_)) {
    require(file_ >= 0);
  }
  const std::string& holding(const std::string& text) const {
    require(ftruncate(file_, 0) == 0 &&
            pwrite(file_, text.data(), text.size(), 0) == static_cast<ssize_t>(text.size()));
    return path_;
  }

 private:
  int file_;
  std::string path_;
};

const std::string& file_of(const std::string& text) {
  static const MemoryFile file;
  return file.holding(text);
}

void read_csv(const std::string& text) {
  const CsvTable table("f", text);
  for (std::size_t row = 0; row < table.row_count(); ++row)
    for (std::size_t k = 0; k < table.columns().size(); ++k) {
      try {
        require(std::isfinite(table.number(row, k)));
      } catch (const Failure&) {
      }
    }
}

void read_points_file(const std::string& text) {
  for (const NamedPoint& p : parse_points("f", text)) require(is_finite(p.x) && !p.name.empty());
}

void read_posed(const std::string& text) {
  const Model& model = fuzz::small_model();
  std::vector<std::string> unmatched;
  const PosedParameters neutral{{}, std::vector<float>(model.parameters().count)};
  for (const PosedParameters& p : read_posed_parameters(CsvTable("f", text), model, neutral, &unmatched))
    require(is_finite(p.pose));
}

void read_truth(const std::string& text) {
  const TruthComparison truth(file_of(text), fuzz::small_model());
}

/// What is read is written so that it is read again, as the same.
void read_fit(const std::string& text) {
  const FitFile fit = parse_fit("f", text);
  require(is_finite(fit.pose) && fit.camera.f > 0);
  const std::string written = fit_text(fit);
  require(fit_text(parse_fit("f", written)) == written);
}

void read_calibration(const std::string& text) {
  const Calibration c = parse_calibration("f", text, {640, 480});
  require(c.camera.f > 0 && is_finite(c.off_px));
}

void read_y4m(const std::string& text) {
  const OpenedFrames opened = open_y4m(file_of(text));
  require((opened.source == nullptr) == !opened.message.empty());
  FrameView frame;
  unsigned sum = 0;
  for (int k = 0; opened.source != nullptr && k < 3 && opened.source->next(frame) == Status::ok; ++k) {
    sum += frame.data[static_cast<std::size_t>(frame.height) * frame.stride_bytes - 1];
    sum += opened.source->colour().pixels.empty() ? 0u : 1u;
  }
  require(sum < 1000);
}

void read_pnm_file(const std::string& text) {
  LumaPicture picture;
  std::string message;
  const Status status = read_pnm(file_of(text), picture, message);
  require((status == Status::ok) == message.empty());
}

void read_text_table(const std::string& text) {
  const bake::TextTable table(file_of(text), {"point", "x", "y", "z", "NAME..."});
  for (const bake::TextRow& row : table.rows()) {
    require(table.name(row, 0).size() <= 27);
    require(is_finite(table.vector(row, 1)));
  }
}

void read_obj_file(const std::string& text) {
  const bake::ObjMesh mesh = bake::read_obj(file_of(text));
  for (const bake::ObjCorner& c : mesh.corners)
    require(static_cast<std::size_t>(c.vertex) < mesh.vertices.size() &&
            (c.texture == -1 || static_cast<std::size_t>(c.texture) < mesh.texture.size()));
}

/// A word a line.
void read_arguments(const std::string& text) {
  std::vector<std::string> words{""};
  for (const char c : text)
    if (c == '\n')
      words.emplace_back();
    else
      words.back().push_back(c);
  const std::vector<Option> options{{"--number", "N", ""},
                                    {"--size", "WxH", ""},
                                    {"--box", "X,Y,W,H", ""},
                                    {"--flag", nullptr, ""},
                                    {"--param", "NAME=VALUE", "", Takes::texts},
                                    {"--cues", "LIST", ""},
                                    {"-i", "CSV", "", Takes::input},
                                    {"-o", "PNG", "", Takes::output}};
  const Args args(words, options, 1, 1);
  require(args.operand_count() == 1 || args.operand_count() == 2);
  const int n = args.integer("--number", 3, -5, 1000);
  require(n >= -5 && n <= 1000);
  if (const auto size = args.size("--size"))
    require(size->width >= 16 && size->height >= 16 && size->width <= kMaxFrameSide &&
            size->height <= kMaxFrameSide);
  const std::vector<std::string> names = args.list("--cues");
  require(args.has("--cues") != names.empty());
  const std::set<std::string> different(names.begin(), names.end());
  require(different.size() == names.size() && different.count("") == 0);
  if (const auto box = args.numbers("--box", 4)) require(box->size() == 4);
}

struct Reader {
  const char* name;
  void (*read)(const std::string& text);
};

constexpr Reader kReaders[] = {
    {"csv", read_csv},
    {"points", read_points_file},
    {"posed", read_posed},
    {"truth", read_truth},
    {"json", [](const std::string& text) { (void)parse_json("f", text).dump(); }},
    {"fit", read_fit},
    {"calibration", read_calibration},
    {"y4m", read_y4m},
    {"pnm", read_pnm_file},
    {"picture", [](const std::string& text) { (void)read_image(file_of(text)); }},
    {"text-table", read_text_table},
    {"obj", read_obj_file},
    {"learnt", [](const std::string& text) { (void)read_learnt(file_of(text)); }},
    {"arguments", read_arguments},
};

const Reader* chosen = nullptr;

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  for (int i = 1; i < *argc; ++i)
    for (const Reader& reader : kReaders)
      if (std::string("--reader=") + reader.name == (*argv)[i]) chosen = &reader;
  if (chosen != nullptr) return 0;
  std::fputs("--reader= one of:", stderr);
  for (const Reader& reader : kReaders) std::fprintf(stderr, " %s", reader.name);
  std::fputs("\n", stderr);
  std::exit(2);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(data, data + size);
  try {
    chosen->read(text);
  } catch (const Failure& failure) {
    require(std::strchr(failure.what(), '\0') != failure.what());
  } catch (const bake::SourceError&) {
  }
  return 0;
}
