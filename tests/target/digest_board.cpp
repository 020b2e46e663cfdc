// The digest's run from flash.
#include "digest_run.hpp"
#include "board.h"
#include "line.hpp"

extern const unsigned char egg_table[];
extern const std::size_t egg_table_bytes;

namespace {
[[gnu::section(".external")]] alignas(pliant::Arena::kAlignment) unsigned char memory[kDigestBytes];
}

int main() {
  pliant::Arena arena(memory, sizeof memory);
  const DigestRun run = digest_run(egg_table, egg_table_bytes, arena);
  Line line;
  line.add("digest ")
      .add_hex(run.digest)
      .add(", expected ")
      .add_hex(kDigest)
      .add(", ")
      .add(pliant::text(run.status));
  line.add(", frames tracked ").add(run.frames_tracked).add("\n");
  board_write(line.text());
  return run.status == pliant::Status::ok && run.frames_tracked == kDigestFrames && run.digest == kDigest ? 0
                                                                                                          : 1;
}
