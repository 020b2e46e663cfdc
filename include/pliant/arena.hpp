#pragma once
/// \file arena.hpp
/// One caller-owned block of memory, handed out from the front and never freed.
#include <cstddef>
#include <cstdint>
#include <new>
#include <type_traits>

#include "pliant/status.hpp"

namespace pliant {

/// A pointer and a count. Does not own what it points to.
template <class T>
struct Span {
  T* data = nullptr;                                                  ///< first element
  std::size_t count = 0;                                              ///< number of elements
  constexpr T& operator[](std::size_t i) const { return data[i]; }    ///< Element i, unchecked.
  constexpr T* begin() const { return data; }                         ///< First element.
  constexpr T* end() const { return data + count; }                   ///< One behind the last element.
  constexpr bool empty() const { return count == 0; }                 ///< True without elements.
  constexpr operator Span<const T>() const { return {data, count}; }  ///< The same elements, read only.
};

/// What memory is for. An object with many parts sets it with `Arena::count_as` while it lays them out.
enum class Purpose : std::uint8_t {
  other,
  fields,            ///< evaluation of the model
  mesh,              ///< faces and vertices
  adaptation,        ///< queues and positions of refinement
  visibility,        ///< depth buffer, silhouette, projected vertices
  solver,            ///< normal equations and their factor
  points,            ///< surface points, predictions, observations
  sampled_points,    ///< field samples of surface points
  sampled_vertices,  ///< field samples of vertices
  rejection,         ///< of outliers
  state,             ///< parameters: present, past and predicted
  pyramid,           ///< image pyramids
  patches,           ///< templates and the search for them
  corners,           ///< corner detection
  thumbnails,        ///< coarse search
};
constexpr std::size_t kPurposeCount = 15;  ///< number of purposes

/// Makes an object in its default state in sizeof(T) bytes. As a member, and flattened: so GCC clears it as one block.
template <class T>
[[gnu::flatten]] T* make_in(void* room) {
  struct InDefaultState { T object{}; };
  return &(new (room) InDefaultState)->object;
}

/// Bump allocator over one block. An arena without a block only measures: every `take` advances the count and
/// returns null. The same code thus measures an object and lays it out, so the two cannot differ. Objects in
/// an arena are trivially destructible. Not copyable. Cost: O(1) a call.
class Arena {
 public:
  constexpr Arena() = default;  ///< An arena that only measures.
  /// The same; adds the bytes taken to the count of their purpose.
  explicit constexpr Arena(std::size_t (&by_purpose)[kPurposeCount]) : by_purpose_(by_purpose) {}
  /// \param block  aligned to kAlignment (create_in refuses another), of `bytes` bytes; stays in place and outlives what is in it.
  constexpr Arena(void* block, std::size_t bytes) : base_(static_cast<unsigned char*>(block)), size_(bytes) {}
  Arena(const Arena&) = delete;
  Arena& operator=(const Arena&) = delete;

  static constexpr std::size_t kAlignment = 16;  ///< Alignment of the block and of everything taken from it.

  /// Room for `count` values of T, uninitialised. Without room (the address space is one limit) null; the arena is `exhausted`.
  template <class T>
  constexpr T* take(std::size_t count) {
    static_assert(std::is_trivially_destructible_v<T> && alignof(T) <= kAlignment);
    unsigned char* const room = take_bytes(count, sizeof(T));
    return room == nullptr ? nullptr : reinterpret_cast<T*>(room);
  }
  /// One T in its default state.
  template <class T>
  T* make() {
    void* const room = take<T>(1);
    return room == nullptr ? nullptr : make_in<T>(room);
  }
  /// Sets the purpose of what is taken from now on.
  constexpr void count_as(Purpose purpose) { purpose_ = purpose; }
  /// `count` values as a span.
  template <class T>
  constexpr Span<T> take_span(std::size_t count) {
    return {take<T>(count), count};
  }

  /// True without a block: sizes are only counted.
  constexpr bool is_measuring() const { return base_ == nullptr; }
  /// True where the block is aligned to kAlignment.
  bool is_aligned() const { return reinterpret_cast<std::uintptr_t>(base_) % kAlignment == 0; }
  constexpr bool exhausted() const { return exhausted_; }     ///< True once something did not fit.
  constexpr std::size_t used_bytes() const { return used_; }  ///< Bytes taken, padding included.
  constexpr std::size_t size_bytes() const { return size_; }  ///< Bytes of the block.
  constexpr std::size_t high_water_bytes() const { return high_water_; }  ///< The most ever in use at once.
  /// Empties the arena. What was taken from it is no longer valid.
  constexpr void reset() {
    used_ = 0;
    exhausted_ = false;
  }

  /// Releases at the end of a scope what was taken inside it.
  class Scope {
   public:
    /// Remembers where the arena is.
    explicit Scope(Arena& arena) : arena_(arena), used_(arena.used_), exhausted_(arena.exhausted_) {}
    ~Scope() {
      arena_.used_ = used_;
      arena_.exhausted_ = exhausted_;
    }
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   private:
    Arena& arena_;
    std::size_t used_;
    bool exhausted_;
  };

 private:
  // Not inlined, for the sake of code size: some forty types use it.
  [[gnu::noinline]] constexpr unsigned char* take_bytes(std::size_t count, std::size_t size) {
    constexpr std::size_t kMost = SIZE_MAX / kAlignment * kAlignment;
    const std::size_t start = used_, bytes = (count * size + kAlignment - 1) / kAlignment * kAlignment;
    exhausted_ = exhausted_ || count > kMost / size || bytes > (base_ == nullptr ? kMost : size_) - start;
    used_ = !exhausted_ ? start + bytes : base_ == nullptr ? kMost : start;  // kMost: more than any block has
    if (exhausted_) return nullptr;
    if (by_purpose_ != nullptr) by_purpose_[static_cast<std::size_t>(purpose_)] += bytes;
    if (used_ > high_water_) high_water_ = used_;
    return base_ == nullptr ? nullptr : base_ + start;
  }

  unsigned char* base_ = nullptr;
  std::size_t size_ = 0, used_ = 0, high_water_ = 0;
  bool exhausted_ = false;
  Purpose purpose_ = Purpose::other;
  std::size_t* by_purpose_ = nullptr;
};

/// Lays out a part of an object by `part->lay_out(arena, args...)`. Null, while the arena measures: a
/// temporary stands for the part. Not inlined, so that the stack holds one temporary at a time.
template <class T, class... Args>
[[gnu::noinline]] void lay_out_part(Arena& arena, T* part, const Args&... args) {
  if (part != nullptr) return part->lay_out(arena, args...);
  alignas(T) unsigned char room[sizeof(T)];
  make_in<T>(room)->lay_out(arena, args...);
}

/// Takes a part of an object from the arena and lays it out. \return null if the arena measures or is exhausted.
template <class T, class... Args>
T* create_part(Arena& arena, const Args&... args) {
  T* const part = arena.make<T>();
  lay_out_part(arena, part, args...);
  return part;
}

/// Whether an object can be laid out from this argument. A type with values that no object can be made from
/// overloads it (Model, TrackerLimits).
template <class T>
constexpr bool is_usable(const T&) {
  return true;
}

/// The same of all arguments. Overloaded where they have to fit each other (a tracker's model and limits).
template <class... Args>
constexpr bool are_usable(const Args&... args) {
  return (is_usable(args) && ...);
}

/// Lays `object` out in `arena` by `object.lay_out(arena, args...)`, first without memory to learn whether it
/// fits. Needs no room for a second object.
/// \return ok, or:
///   - bad_argument: the arena only measures, or `args` are not usable; nothing has changed.
///   - misaligned: the arena's block is not aligned to Arena::kAlignment; nothing has changed.
///   - out_of_memory: `object` is as newly constructed, the arena unchanged.
template <class T, class... Args>
Status create_in(Arena& arena, T& object, const Args&... args) {
  if (arena.is_measuring() || !are_usable(args...)) return Status::bad_argument;
  if (!arena.is_aligned()) return Status::misaligned;
  Arena trial;
  object.lay_out(trial, args...);
  if (arena.exhausted() || trial.used_bytes() > arena.size_bytes() - arena.used_bytes()) {
    new (&object) T();
    return Status::out_of_memory;
  }
  object.lay_out(arena, args...);
  PLIANT_ASSERT(!arena.exhausted());
  return Status::ok;
}

/// Bytes that `create_in` takes for the same arguments; 0 if it refuses them.
template <class T, class... Args>
std::size_t measured_bytes(const Args&... args) {
  if (!are_usable(args...)) return 0;
  Arena trial;
  lay_out_part(trial, static_cast<T*>(nullptr), args...);
  return trial.used_bytes();
}

}  // namespace pliant
