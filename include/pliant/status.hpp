#pragma once
/// \file status.hpp
/// What can go wrong, as values, and the check of programming errors. Nothing in the library throws.
#include <cstdint>

#include "pliant/version.h"

namespace pliant {

/// Result of an operation that can fail. Numbers are stable: values are only ever appended.
/// After any value but `ok` the objects involved are as they were before the call, unless the function's
/// comment says otherwise.
enum class [[nodiscard]] Status : std::uint8_t {
  ok = 0,
  out_of_memory = 1,         ///< the arena is too small for the limits given
  bad_argument = 2,          ///< null pointer, NaN, or a value outside its stated range
  capacity = 3,              ///< a fixed capacity (points, vertices, faces, ...) is used up
  truncated = 4,             ///< a table or file ends before its stated size
  bad_magic = 5,             ///< not a pliant table
  bad_version = 6,           ///< a table of another format version
  bad_checksum = 7,          ///< a table whose CRC-32 does not match its bytes
  bad_table = 8,             ///< a count, offset, index or value in a table is out of range
  misaligned = 9,            ///< a table not aligned to 4 bytes, or a memory block not aligned to 16
  too_few_points = 10,       ///< fewer correspondences than the unknowns need
  underdetermined = 11,      ///< the observations do not determine the rigid pose
  size_mismatch = 12,        ///< a frame of another size than the tracker was made for
  not_started = 13,          ///< an operation that needs a start: there is no track
  not_found = 14,            ///< no such name, index, learnt table, face or camera
  end_of_stream = 15,        ///< a frame source has no further frame
  io_error = 16,             ///< a read failed or the data are malformed
  no_room = 17,              ///< not used: Adapter reports AdaptStop::no_room
  bad_index = 18,            ///< base mesh: a face refers to a vertex that does not exist
  degenerate_face = 19,      ///< base mesh: a repeated corner or no area in (u,v)
  duplicate_face = 20,       ///< base mesh: the same three corners twice
  non_manifold_edge = 21,    ///< base mesh: more than two faces share an edge
  non_manifold_vertex = 22,  ///< base mesh: a vertex whose faces form more than one fan
  non_orientable = 23,       ///< base mesh: no consistent winding exists
  not_basic_blocks = 24,     ///< base mesh: neighbours disagree about their subdivision edge
  not_ready = 25,            ///< mesh: the operator's precondition does not hold here
  isolated_vertex = 26,      ///< base mesh: a vertex that no face uses
  degenerate_data = 27,      ///< outliers: most rows lie in a subspace; the answer given is within it
  camera_lost = 28,          ///< a camera was unplugged, or delivers no more frames
  stale_frame = 29,          ///< a frame no newer than the one before: it came twice, or late
};

/// A short English sentence without a final stop, for messages and logs. Never null.
const char* text(Status status);

}  // namespace pliant

/// Checks a condition that only a programming error can break: a precondition, or an invariant. Bad input is
/// no such error; it gets a `Status`. The check is on where NDEBUG is not defined (debug and sanitizer
/// builds): a condition that does not hold stops the program by a trap instruction, without text, heap or C
/// library. Where NDEBUG is defined (release builds) the condition is compiled but not evaluated. A build may
/// define the macro itself before it includes any header.
#ifndef PLIANT_ASSERT
#ifdef NDEBUG
#define PLIANT_ASSERT(condition) static_cast<void>(sizeof((condition) ? 1 : 0))
#else
#define PLIANT_ASSERT(condition) ((condition) ? static_cast<void>(0) : __builtin_trap())
#endif
#endif

#if defined(__FAST_MATH__)
#error "pliant promises the same bits on every target: do not compile it with -ffast-math"
#endif
