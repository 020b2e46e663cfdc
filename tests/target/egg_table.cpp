// Writes the digest's model table as a C++ array, for programs that have no heap to build it on. usage: egg_table OUT.cpp
#include <fstream>

#include "digest_run.hpp"
#include "model_builder.hpp"
#include "host/bake/bake.hpp"

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const auto words = egg_model(kDigestIdentities).table();
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(words.data());
  std::ofstream out(argv[1]);
  out << pliant::host::bake::embedded({bytes, bytes + words.size() * 4}, "egg_table");
  return out.flush() ? 0 : 1;
}
