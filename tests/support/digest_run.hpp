#pragma once
// The run behind the digest: a fit and a tracking run with all of their parts, on pictures drawn here with nothing but
// + - * / and sqrt. Portable as the library itself: no heap, so that a microcontroller runs it from flash.
#include <cstddef>
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/status.hpp"

/// What every compiler, level and target must give.
constexpr std::uint32_t kDigest = 907418569u;

constexpr int kDigestFrames = 30;
/// Of the arena that `digest_run` takes.
constexpr std::size_t kDigestBytes = std::size_t{2} << 20;
/// Identity fields of the egg model (model_builder.hpp) whose table it runs on.
constexpr int kDigestIdentities = 4;

struct DigestRun {
  pliant::Status status = pliant::Status::ok;  ///< the first that was not ok
  std::uint32_t digest = 0;                    ///< of every output bit
  int frames_tracked = 0;                      ///< of kDigestFrames
  float jaw_error = 0;                         ///< rad, in the last frame
};

/// \param table  of egg_model(kDigestIdentities).
DigestRun digest_run(const void* table, std::size_t bytes, pliant::Arena& arena);
