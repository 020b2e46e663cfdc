/*
 * The example in C. The start fits the model to 68 landmarks of the first frame, as a detector gives them, on the
 * device. Then every frame is tracked. The fit and the tracking use the same static block, one after the other.
 */
#include <string.h>

#include "board.h"
#include "pliant/pliant.h"
#include "points.h" /* the landmarks of the first frame */

extern const unsigned char face[];
extern const size_t face_bytes;

enum { kWidth = 320, kHeight = 240, kMemoryBytes = 249 * 1024 };

static _Alignas(16) unsigned char memory[kMemoryBytes];
__attribute__((section(".frames"))) static uint8_t pixels[kWidth * kHeight];

static void write_hex(uint32_t bits) {
  char text[10] = " ";
  for (int k = 0; k < 8; ++k) text[1 + k] = "0123456789abcdef"[(bits >> (28 - 4 * k)) & 15u];
  text[9] = 0;
  board_write(text);
}

static void write_float(float x) {
  uint32_t bits;
  memcpy(&bits, &x, sizeof bits);
  write_hex(bits);
}

/* Ends the program with the status's text when it is not PLIANT_OK. */
static void require(pliant_status status, const char *what) {
  if (status == PLIANT_OK) return;
  board_write(what);
  board_write(": ");
  board_write(pliant_status_text(status));
  board_write("\n");
  board_exit(1);
}

/* A Y4M header ends with its line. */
static int skip_line(int file) {
  char c = 0;
  for (int k = 0; k < 200 && c != '\n'; ++k)
    if (board_read(file, &c, 1) != 1) return 0;
  return c == '\n';
}

static void print(int frame, pliant_tracker *tracker, const pliant_result *r) {
  char text[] = "frame 00";
  text[6] = (char)('0' + frame / 10);
  text[7] = (char)('0' + frame % 10);
  board_write(text);
  for (int k = 0; k < 4; ++k) write_float(r->pose.q[k]);
  for (int k = 0; k < 3; ++k) write_float(r->pose.t[k]);
  float x, y;
  require(pliant_get_landmark(tracker, "nose_tip", &x, &y), "nose_tip");
  write_float(x);
  write_float(y);
  float jaw;
  require(pliant_get_parameter(tracker, "jawOpen", &jaw), "jawOpen");
  write_float(jaw);
  board_write("\n");
}

int main(void) {
  board_write(pliant_version());
  board_write("\n");
  const pliant_limits limits = pliant_profile('S');
  pliant_tracker *tracker;
  require(pliant_create(memory, sizeof memory, face, face_bytes, &limits, &tracker), "create");
  const int file = board_open("frames.y4m");
  if (file < 0 || !skip_line(file)) {
    board_write("no frames.y4m here\n");
    return 1;
  }
  pliant_frame frame = {pixels, kWidth, 0, kWidth, kHeight, 1, 0};
  int tracked = 0;
  while (skip_line(file) && board_read(file, pixels, sizeof pixels) == sizeof pixels) {
    pliant_result result;
    if (frame.sequence == 0) {
      require(pliant_start_from_landmarks(tracker, &frame, points, sizeof points / sizeof *points, NULL), "start");
      require(pliant_get_result(tracker, &result), "result");
    } else {
      require(pliant_update(tracker, &frame, &result), "update");
    }
    tracked += result.state == PLIANT_TRACKING;
    print((int)frame.sequence, tracker, &result);
    ++frame.sequence;
    frame.time_ns += 33333333;
  }
  if (board_worst_stack_bytes() > board_stack_bytes()) return 1;
  return tracked > 1 && tracked == (int)frame.sequence ? 0 : 1;
}
