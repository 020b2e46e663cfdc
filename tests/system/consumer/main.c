/* The C interface without a table: it compiles, links with the C compiler alone, and answers. */
#include <stdio.h>

#include "pliant/pliant.h"

static _Alignas(16) unsigned char memory[1 << 16];

int main(void) {
  const pliant_limits limits = pliant_profile('S');
  pliant_tracker *tracker = NULL;
  const pliant_status status = pliant_create(memory, sizeof memory, "no table", 8, &limits, &tracker);
  printf("pliant %s: %s\n", pliant_version(), pliant_status_text(status));
  return status != PLIANT_OK && tracker == NULL ? 0 : 1;
}
