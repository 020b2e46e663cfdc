#pragma once
// The run behind the digest: a fit and a tracking run with all of their parts, on pictures drawn here with nothing but
// + - * / and sqrt. Portable as the library itself: no heap, so that a microcontroller runs it from flash.
#include <cstddef>
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/status.hpp"

constexpr int kDigestFrames = 30;
/// Of the arena that `digest_run` takes.
constexpr std::size_t kDigestBytes = std::size_t{2} << 20;
/// Identity fields of the egg model (model_builder.hpp) whose table it runs on.
constexpr int kDigestIdentities = 4;

/// What the run is about.
struct DigestSubject {
  std::size_t identities;  ///< parameters that the truth has at random values
  std::size_t moved;       ///< parameter that moves
  float reach;             ///< its value in the last frame
  std::uint32_t expected;  ///< what every compiler, level and target must give
};
/// The egg, whose jaw opens, and the sheet of paper with springs (sheet_model.hpp), which rolls up.
constexpr DigestSubject kDigestOfEgg{kDigestIdentities, kDigestIdentities + 2, 0.2f, 609252488u},
    kDigestOfSheet{0, 0, 0.8f, 1093842487u};

struct DigestRun {
  pliant::Status status = pliant::Status::ok;  ///< the first that was not ok
  std::uint32_t digest = 0;                    ///< of every output bit
  int frames_tracked = 0;                      ///< of kDigestFrames
  float moved_error = 0;                       ///< of the parameter that moves, in the last frame
};

/// \param table  of egg_model(kDigestIdentities) or sheet_model(Springs::of_sheet().bytes()).
DigestRun digest_run(const DigestSubject& subject, const void* table, std::size_t bytes,
                     pliant::Arena& arena);
