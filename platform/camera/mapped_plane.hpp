#pragma once
// A camera buffer's first plane in this process's memory.
#include <libcamera/libcamera.h>

#include "camera/luma_layout.hpp"

namespace pliant {

/// Maps the plane for reading, for as long as it lives.
class MappedPlane {
 public:
  explicit MappedPlane(const libcamera::FrameBuffer::Plane& plane);
  ~MappedPlane();
  MappedPlane(const MappedPlane&) = delete;
  MappedPlane& operator=(const MappedPlane&) = delete;

  /// False if the system refused to map it.
  bool is_valid() const { return start_ != nullptr; }
  /// \param filled  bytes that the camera has written; 0 if it does not say.
  PlaneMemory memory(std::size_t filled) const;
  /// Bracket reading, for devices whose memory is not coherent with the caches. Buffers that need none refuse, which
  /// is fine.
  void begin_reading() const;
  void end_reading() const;

 private:
  libcamera::SharedFD fd_;
  std::size_t offset_;
  std::size_t mapped_bytes_ = 0;
  const std::uint8_t* start_ = nullptr;
};

}  // namespace pliant
