#include "bake/bake.hpp"

#include "bake/face_source.hpp"
#include "bake/source_error.hpp"

namespace pliant::bake {

bool bake(const BakeOptions& options, std::vector<std::uint8_t>& table, std::string& error,
          BakeReport* report) {
  try {
    if (options.bits != 8 && options.bits != 16) throw SourceError("--bits", 0, "is 8 or 16");
    if (options.size < 16 || options.size > 512) throw SourceError("--size", 0, "is from 16 to 512");
    if (options.base_vertices < 60 || options.base_vertices > 5000)
      throw SourceError("--base-mesh", 0, "is from 60 to 5000");
    if (!is_face_folder(options.source))
      throw SourceError(options.source, 0, "is no folder with the tables of a face (points.txt and others)");
    auto bytes = bake_source(read_face(options.source), options, report);
    if (bytes.empty())
      throw SourceError(options.source, 0, "the skin's boundary crosses itself in the chart");
    table = std::move(bytes);
    return true;
  } catch (const SourceError& e) {
    error = e.what();
    return false;
  }
}

}  // namespace pliant::bake
