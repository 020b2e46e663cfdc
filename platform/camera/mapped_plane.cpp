#include "camera/mapped_plane.hpp"

#include <linux/dma-buf.h>
#include <sys/ioctl.h>
#include <sys/mman.h>

namespace pliant {

namespace {

void sync(int fd, std::uint64_t which) {
  dma_buf_sync argument{};
  argument.flags = which | DMA_BUF_SYNC_READ;
  ioctl(fd, DMA_BUF_IOCTL_SYNC, &argument);
}

}  // namespace

MappedPlane::MappedPlane(const libcamera::FrameBuffer::Plane& plane)
    : fd_(plane.fd),
      offset_(plane.offset == libcamera::FrameBuffer::Plane::kInvalidOffset ? 0 : plane.offset),
      // An offset need not be a multiple of the page size, so that everything in front of it is mapped too.
      mapped_bytes_(offset_ + plane.length) {
  void* const start = mmap(nullptr, mapped_bytes_, PROT_READ, MAP_SHARED, fd_.get(), 0);
  start_ = start == MAP_FAILED ? nullptr : static_cast<const std::uint8_t*>(start);
}

MappedPlane::~MappedPlane() {
  if (start_ != nullptr) munmap(const_cast<std::uint8_t*>(start_), mapped_bytes_);
}

PlaneMemory MappedPlane::memory(std::size_t filled) const {
  PLIANT_ASSERT(is_valid());
  const std::size_t length = mapped_bytes_ - offset_;
  return {start_ + offset_, filled > 0 && filled < length ? filled : length};
}

void MappedPlane::begin_reading() const {
  sync(fd_.get(), DMA_BUF_SYNC_START);
}

void MappedPlane::end_reading() const {
  sync(fd_.get(), DMA_BUF_SYNC_END);
}

}  // namespace pliant
