/**
 * \file pliant.h
 * The C interface (C11): a face followed through frames, from landmarks, a box or a known pose. Memory is the caller's;
 * nothing is allocated, nothing is kept but that memory and the model's table, and there is nothing to free.
 *
 * Units and axes are those of the C++ headers: image positions in pixels, x right and y down, pixel centres at integers;
 * the model in millimetres, x to the subject's left, y up, z out of the face; the camera x right, y down, z forward;
 * p_cam = R(q) diag(1,-1,-1) p_model + t, so that a frontal face has q = (1,0,0,0).
 *
 * One tracker is used by one thread at a time. Functions return a pliant_status; after anything but PLIANT_OK nothing has
 * changed, but for the start functions, which leave a tracker that is not started.
 */
#ifndef PLIANT_H
#define PLIANT_H

#include <stddef.h>
#include <stdint.h>

#include "pliant/version.h"

#ifdef __cplusplus
extern "C" {
#define PLIANT_ASSERT_SIZE(type, bytes) static_assert(sizeof(type) == (bytes), "another layout than the library's")
#else
#define PLIANT_ASSERT_SIZE(type, bytes) _Static_assert(sizeof(type) == (bytes), "another layout than the library's")
#endif

/** What can go wrong here; the numbers are those of pliant::Status, of which pliant_status_text knows all. */
typedef int32_t pliant_status;
enum {
  PLIANT_OK = 0,
  PLIANT_OUT_OF_MEMORY = 1,   /**< the block is too small for the limits */
  PLIANT_BAD_ARGUMENT = 2,    /**< a null or misaligned pointer, NaN, or a value out of its range */
  PLIANT_CAPACITY = 3,        /**< more points than the limits have room for */
  PLIANT_TRUNCATED = 4,       /**< the table ends early; 5 to 9 are other faults of a table */
  PLIANT_MISALIGNED = 9,      /**< a table that does not start at a multiple of four bytes */
  PLIANT_TOO_FEW_POINTS = 10, /**< of the start, or of texture to hold on to */
  PLIANT_UNDERDETERMINED = 11, /**< the points do not determine the pose */
  PLIANT_SIZE_MISMATCH = 12,  /**< a frame of another size than the limits say */
  PLIANT_NOT_STARTED = 13,
  PLIANT_NOT_FOUND = 14,      /**< no such landmark or parameter */
  PLIANT_STALE_FRAME = 29     /**< the frame came twice, or late */
};

/** A tracker, in the caller's memory. */
typedef struct pliant_tracker pliant_tracker;

/** Capacities, which fix the memory. Take them from pliant_profile and change what differs. */
typedef struct pliant_limits {
  uint16_t width, height;               /**< of the frames, px */
  uint16_t region_width, region_height; /**< part of the frame that is looked at; 0: all of it */
  uint16_t patches, key_patches;        /**< captured at the start, and later */
  uint16_t vertices;                    /**< of the mesh */
  uint16_t start_points;                /**< landmarks that a start may have, 4 to 160 */
  uint16_t profile;                     /**< 'S' or 'L': what is not said here is as there */
} pliant_limits;
PLIANT_ASSERT_SIZE(pliant_limits, 18);

/** A luma picture of 8 bits a pixel, read during the call only. Row y, column x is
 *  pixels[y * stride_bytes + x * pixel_step_bytes]. */
typedef struct pliant_frame {
  const uint8_t *pixels;
  size_t stride_bytes;
  int64_t time_ns;          /**< of exposure, any origin */
  int32_t width, height;    /**< px */
  int32_t pixel_step_bytes; /**< 1 planar, 2 packed YUYV (not in profile S) */
  uint32_t sequence;        /**< number of the frame */
} pliant_frame;
PLIANT_ASSERT_SIZE(pliant_frame, 2 * sizeof(void *) + 24);

/** Pinhole camera, px. */
typedef struct pliant_camera {
  float f, cx, cy;
} pliant_camera;
PLIANT_ASSERT_SIZE(pliant_camera, 12);

/** Unit quaternion (w,x,y,z) and translation (mm). */
typedef struct pliant_pose {
  float q[4], t[3];
} pliant_pose;
PLIANT_ASSERT_SIZE(pliant_pose, 28);

/** A landmark of the model (`ibug30`, `nose_tip`, ...) and where it is seen, px. */
typedef struct pliant_point {
  const char *landmark;
  float x, y;
} pliant_point;
PLIANT_ASSERT_SIZE(pliant_point, sizeof(void *) + 8);

enum { PLIANT_TRACKING = 0, PLIANT_DEGRADED = 1, PLIANT_LOST = 2 };

typedef struct pliant_result {
  pliant_pose pose;          /**< meaningful unless lost */
  pliant_camera camera;
  float rms_px;              /**< of the inliers */
  uint16_t tracked, inliers; /**< observations found, and used in the end */
  int32_t state;             /**< PLIANT_TRACKING, PLIANT_DEGRADED or PLIANT_LOST */
} pliant_result;
PLIANT_ASSERT_SIZE(pliant_result, 52);

/** "0.2.0": the version of the library that is linked. */
const char *pliant_version(void);

/** A short English sentence without a final stop. Never null. */
const char *pliant_status_text(pliant_status status);

/** 'S': 320 x 240 on a microcontroller; 'L': 640 x 480. Anything else gives all zero, which no call accepts. */
pliant_limits pliant_profile(char name);

/**
 * Bytes that pliant_create needs for this model and these limits. Asking takes PLIANT_SCRATCH_BYTES, at a multiple of 16
 * bytes' address, which are free again afterwards: the stack of a small device has no room for them, but the block that
 * is going to be the tracker's has. Faults of the table as pliant_create; too little scratch: PLIANT_OUT_OF_MEMORY.
 */
enum { PLIANT_SCRATCH_BYTES = 6144 };
pliant_status pliant_required_bytes(void *scratch, size_t scratch_bytes, const void *table, size_t table_bytes,
                                    const pliant_limits *limits, size_t *bytes);

/** Makes a tracker in `memory`, a multiple of 16 bytes' address, which must stay, as must the table. */
pliant_status pliant_create(void *memory, size_t bytes, const void *table, size_t table_bytes,
                            const pliant_limits *limits, pliant_tracker **tracker);

/** Starts on a frame where the pose is known. `parameters` holds all of them, in the model's order; null: all 0. */
pliant_status pliant_start_pose(pliant_tracker *tracker, const pliant_frame *frame, const pliant_camera *camera,
                                const pliant_pose *pose, const float *parameters);

/** Starts on a frame where at least four landmarks are known: person, pose and, where focal_px is 0, focal length are
 *  fitted to them. PLIANT_NOT_FOUND names a landmark that the model does not have. What of the offsets that the fit leaves
 *  is more than noise is the person's: pliant_get_landmark then tells of the places that were given. */
pliant_status pliant_start_points(pliant_tracker *tracker, const pliant_frame *frame, float focal_px,
                                  const pliant_point *points, size_t count);

/** Starts with the neutral face, frontal, in a detector's box: upper left corner, width and height, px. */
pliant_status pliant_start_box(pliant_tracker *tracker, const pliant_frame *frame, float focal_px, float x, float y,
                               float width, float height);

/** The next frame. */
pliant_status pliant_update(pliant_tracker *tracker, const pliant_frame *frame, pliant_result *result);

/** Of the last frame. PLIANT_NOT_STARTED before a start. */
pliant_status pliant_get_result(pliant_tracker *tracker, pliant_result *result);

/** All parameters as they are now, in the model's order, until the next call; `values` or `count` may be null. */
pliant_status pliant_get_parameters(pliant_tracker *tracker, const float **values, size_t *count);

/** Index of a parameter by its name (`jawOpen`, ...). */
pliant_status pliant_find_parameter(const pliant_tracker *tracker, const char *name, size_t *index);

/** Image position of a landmark at the present state, px: after a start from points where the person has it, as far as
 *  it was among them and there were enough to tell; else where the model has it. */
pliant_status pliant_get_landmark(pliant_tracker *tracker, const char *name, float *x, float *y);

#ifdef __cplusplus
}
#endif

#endif
