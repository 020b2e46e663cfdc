// Writes the digest's model tables as C++ arrays, for programs that have no heap to build them on. usage: egg_table OUT.cpp
#include <fstream>

#include "digest_run.hpp"
#include "host/bake/embedded.hpp"
#include "model_builder.hpp"
#include "sheet_model.hpp"

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  std::ofstream out(argv[1]);
  const auto write = [&out](const ModelBuilder& model, const char* name) {
    const auto words = model.table();
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(words.data());
    out << pliant::host::bake::embedded({bytes, bytes + words.size() * 4}, name);
  };
  write(egg_model(kDigestIdentities), "egg_table");
  write(sheet::sheet_model(sheet::Springs::of_sheet().bytes()), "sheet_table");
  return out.flush() ? 0 : 1;
}
