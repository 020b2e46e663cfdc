#include "camera/luma_layout.hpp"

namespace pliant {

namespace {

// In order of preference: luma alone needs the least bandwidth, then planar luma with little and more chroma, then
// packed.
constexpr LumaLayout kLayouts[] = {
    {fourcc('R', '8', ' ', ' '), 0, 1}, {fourcc('Y', '8', ' ', ' '), 0, 1},
    {fourcc('G', 'R', 'E', 'Y'), 0, 1}, {fourcc('N', 'V', '1', '2'), 0, 1},
    {fourcc('N', 'V', '2', '1'), 0, 1}, {fourcc('Y', 'U', '1', '2'), 0, 1},
    {fourcc('Y', 'V', '1', '2'), 0, 1}, {fourcc('N', 'V', '1', '6'), 0, 1},
    {fourcc('N', 'V', '6', '1'), 0, 1}, {fourcc('Y', 'U', '1', '6'), 0, 1},
    {fourcc('Y', 'V', '1', '6'), 0, 1}, {fourcc('N', 'V', '2', '4'), 0, 1},
    {fourcc('N', 'V', '4', '2'), 0, 1}, {fourcc('Y', 'U', '2', '4'), 0, 1},
    {fourcc('Y', 'V', '2', '4'), 0, 1}, {fourcc('Y', 'U', 'Y', 'V'), 0, 2},
    {fourcc('Y', 'V', 'Y', 'U'), 0, 2}, {fourcc('U', 'Y', 'V', 'Y'), 1, 2},
    {fourcc('V', 'Y', 'U', 'Y'), 1, 2},
};

// How far a size is from the wanted one. A smaller size loses detail and counts double.
long distance(FormatOffer::Size size, int width, int height) {
  const auto one = [](long have, long want) { return have < want ? 2 * (want - have) : have - want; };
  return one(size.width, width) + one(size.height, height);
}

}  // namespace

std::string fourcc_text(std::uint32_t code) {
  std::string text;
  for (int k = 0; k < 4; ++k) {
    const auto c = static_cast<unsigned char>(code >> 8 * k);
    text += c >= ' ' && c < 127 ? static_cast<char>(c) : '?';
  }
  return text.substr(0, text.find_last_not_of(' ') + 1);
}

const LumaLayout* luma_layout(std::uint32_t format) {
  for (const LumaLayout& layout : kLayouts)
    if (layout.format == format) return &layout;
  return nullptr;
}

Status view_luma(const LumaLayout& layout, PlaneMemory plane, int width, int height, std::size_t stride_bytes,
                 FrameView* view) {
  FrameView v;
  v.width = width;
  v.height = height;
  v.pixel_step_bytes = layout.pixel_step_bytes;
  v.stride_bytes = stride_bytes > 0 || width <= 0
                       ? stride_bytes
                       : static_cast<std::size_t>(width) * static_cast<std::size_t>(layout.pixel_step_bytes);
  v.data = plane.bytes;
  if (const Status status = check(v); status != Status::ok) return status;
  const std::size_t row =
      static_cast<std::size_t>(width - 1) * static_cast<std::size_t>(v.pixel_step_bytes) + 1;
  const std::size_t needed = static_cast<std::size_t>(height - 1) * v.stride_bytes + row +
                             static_cast<std::size_t>(layout.first_byte);
  if (plane.length < needed) return Status::truncated;
  v.data += layout.first_byte;
  v.time_ns = view->time_ns;
  v.sequence = view->sequence;
  *view = v;
  return Status::ok;
}

bool choose_format(const std::vector<FormatOffer>& offers, int width, int height, std::uint32_t* format,
                   FormatOffer::Size* size) {
  bool found = false;
  long best = 0;
  const LumaLayout* best_layout = nullptr;
  for (const FormatOffer& offer : offers) {
    const LumaLayout* layout = luma_layout(offer.format);
    if (layout == nullptr) continue;
    auto sizes = offer.sizes;
    if (sizes.empty()) sizes.push_back({width, height});
    for (const FormatOffer::Size s : sizes) {
      const long d = distance(s, width, height);
      if (found && (d > best || (d == best && layout >= best_layout))) continue;
      found = true;
      best = d;
      best_layout = layout;
      *format = offer.format;
      *size = s;
    }
  }
  return found;
}

}  // namespace pliant
