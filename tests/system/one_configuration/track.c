/* track_c face.plm points.csv frames.y4m PROFILE: tracks a grey film of 320 x 240 with the defaults of a profile, S or M.
 * Prints pose, parameters and landmarks of every frame, as `pliant track --landmarks` writes them. */
#include <stdio.h>
#include <stdlib.h>

#include "pliant/pliant.h"

static _Alignas(16) unsigned char table[1 << 20], memory[4 << 20];
static char names[160][32];
static pliant_point points[160];
static uint8_t pixels[320 * 240];

static void require(pliant_status status, const char* what) {
  if (status == PLIANT_OK) return;
  fprintf(stderr, "%s: %s\n", what, pliant_status_text(status));
  exit(1);
}

static FILE* open(const char* path) {
  FILE* file = fopen(path, "rb");
  if (file != NULL) return file;
  perror(path);
  exit(1);
}

/* Whether there was a line to skip. */
static int skip_line(FILE* file) {
  int c;
  while ((c = fgetc(file)) != '\n' && c != EOF) continue;
  return c == '\n';
}

static void print(pliant_tracker* tracker) {
  pliant_result result;
  require(pliant_get_result(tracker, &result), "result");
  for (int k = 0; k < 4; ++k) printf(",%.9g", result.pose.q[k] + 0.0);
  for (int k = 0; k < 3; ++k) printf(",%.9g", result.pose.t[k] + 0.0);
  size_t parameters, landmarks;
  const char* name;
  float x, y;
  require(pliant_parameter_count(tracker, &parameters), "parameters");
  require(pliant_landmark_count(tracker, &landmarks), "landmarks");
  for (size_t k = 0; k < parameters; ++k) {
    require(pliant_parameter_name(tracker, k, &name), "parameter");
    require(pliant_get_parameter(tracker, name, &x), name);
    printf(",%.9g", x + 0.0);
  }
  for (size_t k = 0; k < landmarks; ++k) {
    require(pliant_landmark_name(tracker, k, &name), "landmark");
    require(pliant_get_landmark(tracker, name, &x, &y), name);
    printf(",%.4f,%.4f", (double)x, (double)y);
  }
  puts("");
}

int main(int word_count, char** words) {
  if (word_count != 5) return 2;
  FILE* file = open(words[1]);
  const size_t table_bytes = fread(table, 1, sizeof table, file);
  fclose(file);
  const pliant_limits limits = pliant_profile(words[4][0]);
  pliant_tracker* tracker;
  require(pliant_create(memory, sizeof memory, table, table_bytes, &limits, &tracker), words[1]);

  file = open(words[2]);
  size_t count = 0;
  skip_line(file);
  for (; count < 160 && fscanf(file, " %31[^,],%f,%f", names[count], &points[count].x, &points[count].y) == 3;
       ++count)
    points[count].landmark = names[count];
  fclose(file);

  file = open(words[3]);
  pliant_frame frame = {pixels, 320, 0, 320, 240, 1, 0};
  skip_line(file); /* the film has a line before it, and so has every frame */
  for (; skip_line(file) && fread(pixels, 1, sizeof pixels, file) == sizeof pixels; ++frame.sequence) {
    pliant_result result;
    frame.time_ns = ((int64_t)frame.sequence * 1000000000 + 15) / 30;
    if (frame.sequence == 0)
      require(pliant_start_from_landmarks(tracker, &frame, points, count, NULL), "start");
    else
      require(pliant_update(tracker, &frame, &result), "update");
    print(tracker);
  }
  fclose(file);
  return 0;
}
