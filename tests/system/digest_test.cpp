// The same bits everywhere: a fit and a tracking run, reduced to one number that every compiler, level and target must
// give.
#include <doctest/doctest.h>

#include "aligned_block.hpp"
#include "digest_run.hpp"
#include "model_builder.hpp"
#include "sheet_model.hpp"

namespace {

void check(const DigestSubject& subject, const ModelBuilder& model) {
  const auto words = model.table();
  AlignedBlock block(kDigestBytes);
  pliant::Arena arena(block.data(), block.size());
  const DigestRun run = digest_run(subject, words.data(), words.size() * 4, arena);
  CHECK(run.status == pliant::Status::ok);
  CHECK(run.frames_tracked == kDigestFrames);
  CHECK(run.moved_error < 0.05f);
  CHECK(run.digest == subject.expected);
}

}  // namespace

TEST_CASE("a fit and a tracking run of a face give the one digest") {
  check(kDigestOfEgg, egg_model(kDigestIdentities));
}

TEST_CASE("a fit and a tracking run of a sheet of paper with springs give the one digest") {
  check(kDigestOfSheet, sheet::sheet_model(sheet::Springs::of_sheet().bytes()));
}
