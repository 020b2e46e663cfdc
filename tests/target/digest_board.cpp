// The digest's runs from flash.
#include "board.h"
#include "digest_run.hpp"
#include "line.hpp"

extern const unsigned char egg_table[], sheet_table[];
extern const std::size_t egg_table_bytes, sheet_table_bytes;

namespace {

[[gnu::section(".external")]] alignas(pliant::Arena::kAlignment) unsigned char memory[kDigestBytes];

bool run_is_right(const DigestSubject& subject, const unsigned char* table, std::size_t bytes) {
  pliant::Arena arena(memory, sizeof memory);
  const DigestRun run = digest_run(subject, table, bytes, arena);
  Line line;
  line.add("digest ")
      .add_hex(run.digest)
      .add(", expected ")
      .add_hex(subject.expected)
      .add(", ")
      .add(pliant::text(run.status));
  line.add(", frames tracked ").add(run.frames_tracked).add("\n");
  board_write(line.text());
  return run.status == pliant::Status::ok && run.frames_tracked == kDigestFrames &&
         run.digest == subject.expected;
}

}  // namespace

int main() {
  const bool egg = run_is_right(kDigestOfEgg, egg_table, egg_table_bytes),
             sheet = run_is_right(kDigestOfSheet, sheet_table, sheet_table_bytes);
  return egg && sheet ? 0 : 1;
}
