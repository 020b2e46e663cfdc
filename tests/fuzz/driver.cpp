// Runs a fuzzer without libFuzzer: every file of the corpus as it is, then random changes of them. Where libFuzzer is linked
// (preset fuzz), it has a main of its own and this file is not used.
//
// usage: NAME [--OPTION=VALUE]... COUNT FIRST_SEED CORPUS-FOLDER
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "random.hpp"

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv);
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

using Bytes = std::vector<std::uint8_t>;

std::vector<Bytes> read_all(const std::string& folder) {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  std::vector<Bytes> out;
  for (const auto& path : paths) {
    std::ifstream in(path, std::ios::binary);
    out.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  }
  return out;
}

/// Changes, removes, repeats or takes over from another file some bytes.
Bytes changed(Bytes bytes, const Bytes& other, Random& random) {
  const std::string letters = "0123456789 .,:-+eE\"'[]{}/\n\r\t%#\\";
  for (int k = random.below(5); k >= 0; --k) {
    if (bytes.empty()) bytes.push_back('0');
    const auto index = static_cast<std::size_t>(random.below(static_cast<int>(bytes.size())));
    const auto at = bytes.begin() + static_cast<std::ptrdiff_t>(index);
    const auto most = static_cast<std::size_t>(1 + random.below(random.below(4) == 0 ? 200 : 8));
    const auto end = at + static_cast<std::ptrdiff_t>(std::min(most, bytes.size() - index));
    const Bytes part(at, end);
    switch (random.below(7)) {
      case 0:
        *at = static_cast<std::uint8_t>(random.below(256));
        break;
      case 1:
        *at = static_cast<std::uint8_t>(*at ^ 1 << random.below(8));
        break;
      case 2:
        *at = static_cast<std::uint8_t>(
            letters[static_cast<std::size_t>(random.below(static_cast<int>(letters.size())))]);
        break;
      case 3:
        bytes.erase(at, end);
        break;
      case 4:
        bytes.insert(at, part.begin(), part.end());
        break;
      case 5:
        std::fill(at, end, static_cast<std::uint8_t>(random.below(2) == 0 ? 255 : random.below(256)));
        break;
      default:
        if (!other.empty())
          bytes.insert(at, other.begin(),
                       other.begin() + static_cast<std::ptrdiff_t>(std::min(most, other.size())));
        break;
    }
  }
  return bytes;
}

}  // namespace

int main(int argc, char** argv) {
  if (LLVMFuzzerInitialize(&argc, &argv) != 0) return 2;
  std::vector<std::string> words;
  for (int i = 1; i < argc; ++i)
    if (std::string(argv[i]).rfind("--", 0) != 0) words.emplace_back(argv[i]);
  if (words.size() != 3) return 2;
  const std::vector<Bytes> corpus = read_all(words[2]);
  if (corpus.empty()) return 2;
  for (const Bytes& bytes : corpus) LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
  const int count = std::atoi(words[0].c_str()), first = std::atoi(words[1].c_str());
  for (int seed = first; seed < first + count; ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    const auto any = [&]() -> const Bytes& {
      return corpus[static_cast<std::size_t>(random.below(static_cast<int>(corpus.size())))];
    };
    const Bytes& from = any();
    const Bytes bytes = changed(from, any(), random);
    LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
  }
  std::printf("%zu files, %d changes of them\n", corpus.size(), count);
  return 0;
}
