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
  T* data = nullptr;
  std::size_t count = 0;
  constexpr T& operator[](std::size_t i) const { return data[i]; }
  constexpr T* begin() const { return data; }
  constexpr T* end() const { return data + count; }
  constexpr bool empty() const { return count == 0; }
  constexpr operator Span<const T>() const { return {data, count}; }
};

/// What memory is for; an owner of many parts tells with `Arena::count_as` while it lays them out.
enum class Purpose : std::uint8_t {
  other,
  fields,          ///< evaluation of the model
  mesh,            ///< its faces and vertices
  adaptation,      ///< queues and positions of refining it
  visibility,      ///< depth buffer, outline, projected vertices
  solver,          ///< normal equations and their factor
  points,          ///< surface points, predictions, observations
  sampled_points,    ///< samples of the fields kept a surface point
  sampled_vertices,  ///< and a vertex
  rejection,       ///< of false observations
  state,           ///< parameters, as they are, were and are expected
  pyramid,         ///< pictures
  patches,         ///< captured patches, and the search for them
  corners,         ///< finding where to capture
  thumbnails,  ///< finding a fast or a lost head
};
constexpr std::size_t kPurposeCount = 15;

/// Bump allocator over one block. An arena without a block only measures: every `take` advances the count and gives
/// null, so that `required_bytes` runs the very code that later lays the object out, and the two cannot drift apart.
/// What lives in an arena is trivially destructible. Not copyable. Costs: O(1) a call.
class Arena {
 public:
  /// An arena that only measures.
  constexpr Arena() = default;
  /// The same, adding the bytes taken to the count of their purpose.
  explicit constexpr Arena(std::size_t (&by_purpose)[kPurposeCount]) : by_purpose_(by_purpose) {}
  /// \param block  aligned to kAlignment; must outlive everything created in it.
  /// \param bytes  its size.
  constexpr Arena(void* block, std::size_t bytes) : base_(static_cast<unsigned char*>(block)), size_(bytes) {}
  Arena(const Arena&) = delete;
  Arena& operator=(const Arena&) = delete;

  /// Alignment of the block and of everything taken from it.
  static constexpr std::size_t kAlignment = 16;

  /// Room for `count` values of T, uninitialised. On overflow the arena turns `exhausted` and gives null from then on.
  template <class T>
  constexpr T* take(std::size_t count) {
    static_assert(std::is_trivially_destructible_v<T> && alignof(T) <= kAlignment);
    unsigned char* const room = take_bytes(count * sizeof(T));
    return room == nullptr ? nullptr : reinterpret_cast<T*>(room);
  }
  /// What is taken from now on is for this.
  constexpr void count_as(Purpose purpose) { purpose_ = purpose; }
  template <class T>
  constexpr Span<T> take_span(std::size_t count) {
    return {take<T>(count), count};
  }

  constexpr bool is_measuring() const { return base_ == nullptr; }
  /// True once something did not fit.
  constexpr bool exhausted() const { return exhausted_; }
  constexpr std::size_t used_bytes() const { return used_; }
  constexpr std::size_t size_bytes() const { return size_; }
  /// The most that was ever in use at once.
  constexpr std::size_t high_water_bytes() const { return high_water_; }
  /// Gives everything back.
  constexpr void reset() {
    used_ = 0;
    exhausted_ = false;
  }

  /// Gives back, at the end of a scope, what was taken inside it.
  class Scope {
   public:
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
  // Apart and never inlined: one copy for all types, there are some forty.
  [[gnu::noinline]] constexpr unsigned char* take_bytes(std::size_t wanted) {
    const std::size_t start = used_, bytes = (wanted + kAlignment - 1) / kAlignment * kAlignment;
    if (base_ != nullptr && (exhausted_ || bytes > size_ - start)) {
      exhausted_ = true;
      return nullptr;
    }
    used_ = start + bytes;
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

/// Lays `object` out in `arena` by `object.lay_out(arena, args...)`: all of it, or nothing and `out_of_memory`; the object
/// is then as newly constructed. What it was before is gone either way. Needs no room for a second object, which some
/// stacks do not have.
template <class T, class... Args>
Status create_in(Arena& arena, T& object, const Args&... args) {
  if (arena.is_measuring()) return Status::bad_argument;
  Arena trial;
  object.lay_out(trial, args...);
  if (arena.exhausted() || trial.used_bytes() > arena.size_bytes() - arena.used_bytes()) {
    new (&object) T();
    return Status::out_of_memory;
  }
  object.lay_out(arena, args...);
  return Status::ok;
}

/// Bytes that `create_in` will take for the same arguments.
template <class T, class... Args>
std::size_t measured_bytes(const Args&... args) {
  Arena trial;
  T object;
  object.lay_out(trial, args...);
  return trial.used_bytes();
}

}  // namespace pliant
