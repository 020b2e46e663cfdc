// The same bits everywhere: a fit and a tracking run, reduced to one number that every compiler, level and target must
// give.
#include <doctest/doctest.h>

#include "aligned_block.hpp"
#include "digest_run.hpp"
#include "model_builder.hpp"

TEST_CASE("a fit and a tracking run give the one digest") {
  const auto words = egg_model(kDigestIdentities).table();
  AlignedBlock block(kDigestBytes);
  pliant::Arena arena(block.data(), block.size());
  const DigestRun run = digest_run(words.data(), words.size() * 4, arena);
  CHECK(run.status == pliant::Status::ok);
  CHECK(run.frames_tracked == kDigestFrames);
  CHECK(run.jaw_error < 0.05f);
  CHECK(run.digest == kDigest);
}
