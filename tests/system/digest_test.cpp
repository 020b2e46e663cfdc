// The same bits everywhere: a fit and a tracking run, reduced to one number that every compiler, level and target must
// give.
#include <doctest/doctest.h>

#include <vector>

#include "digest_run.hpp"
#include "model_builder.hpp"

TEST_CASE("a fit and a tracking run give the one digest") {
  const auto words = egg_model(kDigestIdentities).table();
  std::vector<unsigned char> block(kDigestBytes + pliant::Arena::kAlignment);
  const auto address = reinterpret_cast<std::uintptr_t>(block.data());
  pliant::Arena arena(block.data() + (pliant::Arena::kAlignment - address % pliant::Arena::kAlignment),
                      kDigestBytes);
  const DigestRun run = digest_run(words.data(), words.size() * 4, arena);
  CHECK(run.status == pliant::Status::ok);
  CHECK(run.frames_tracked == kDigestFrames);
  CHECK(run.jaw_error < 0.05f);
  CHECK(run.digest == kDigest);
}
