// The camera of the README's program: the frames of film.y4m, 320 x 240, grey.
#include <cstdio>

#include <pliant/pliant.hpp>

bool next_frame(pliant::FrameView* frame) {
  static std::FILE* const film = std::fopen("film.y4m", "rb");
  static unsigned char pixels[320 * 240];
  static std::uint32_t number = 0;
  if (film == nullptr) return false;
  if (number == 0)
    while (std::getc(film) != '\n') {  // the film's header
    }
  for (int c = std::getc(film); c != '\n'; c = std::getc(film))  // the frame's
    if (c == EOF) return false;
  if (std::fread(pixels, 1, sizeof pixels, film) != sizeof pixels) return false;
  *frame = {pixels, 320, 240, 320, 1, number * 1000000000ll / 30, number};
  ++number;
  return true;
}
