/**
 * \file pliant_types.h
 * The types of the C interface (pliant.h, which has units and axes).
 */
#ifndef PLIANT_TYPES_H
#define PLIANT_TYPES_H

#include <stddef.h>
#include <stdint.h>

/** The values of pliant::Status. The tracker gives 0 to 14 and 29; a start also 19 to 24 and 26, for a damaged base
 *  mesh. pliant_status_text has a text for all. */
typedef int32_t pliant_status;
enum {
  PLIANT_OK = 0,
  PLIANT_OUT_OF_MEMORY = 1,         /**< the block is smaller than pliant_required_bytes */
  PLIANT_BAD_ARGUMENT = 2,          /**< null, not finite, or out of range */
  PLIANT_CAPACITY = 3,              /**< more points than the limits have room for */
  PLIANT_TRUNCATED = 4,             /**< model table: ends before its stated size */
  PLIANT_BAD_MAGIC = 5,             /**< model table: something else */
  PLIANT_BAD_VERSION = 6,           /**< model table: another format version */
  PLIANT_BAD_CHECKSUM = 7,          /**< model table: the CRC-32 is wrong */
  PLIANT_BAD_TABLE = 8,             /**< model table: a count, offset, index or value is out of range */
  PLIANT_MISALIGNED = 9,            /**< model table: its address is not a multiple of four bytes */
  PLIANT_TOO_FEW_POINTS = 10,       /**< fewer than 4 landmarks, or too few surface points with texture */
  PLIANT_UNDERDETERMINED = 11,      /**< landmarks that do not determine the pose; a landmark behind the camera */
  PLIANT_SIZE_MISMATCH = 12,        /**< a frame of another size than the limits */
  PLIANT_NOT_STARTED = 13,          /**< there is no track: no start has succeeded yet, or it was given up */
  PLIANT_NOT_FOUND = 14,            /**< no landmark or parameter of that name or index; no tables for detection */
  PLIANT_END_OF_STREAM = 15,        /**< frame sources: there is no further frame */
  PLIANT_IO_ERROR = 16,             /**< frame sources: a read failed */
  PLIANT_NO_ROOM = 17,              /**< not used; 18 to 26: meshes, as status.hpp says */
  PLIANT_BAD_INDEX = 18,
  PLIANT_DEGENERATE_FACE = 19,
  PLIANT_DUPLICATE_FACE = 20,
  PLIANT_NON_MANIFOLD_EDGE = 21,
  PLIANT_NON_MANIFOLD_VERTEX = 22,
  PLIANT_NON_ORIENTABLE = 23,
  PLIANT_NOT_BASIC_BLOCKS = 24,
  PLIANT_NOT_READY = 25,
  PLIANT_ISOLATED_VERTEX = 26,
  PLIANT_DEGENERATE_DATA = 27,      /**< outlier search: most rows lie in a subspace */
  PLIANT_CAMERA_LOST = 28,          /**< frame sources: the camera gives nothing any more */
  PLIANT_STALE_FRAME = 29           /**< a frame that is no newer than the last one */
};

/** A tracker, in the caller's memory. */
typedef struct pliant_tracker pliant_tracker;

/** Capacities, which fix the memory. Take them from pliant_profile and change what differs. */
typedef struct pliant_limits {
  uint16_t width, height;               /**< of the frames, px; 64 to 16,384; above 8,192 a side there is no detection */
  uint16_t region_width, region_height; /**< part of the frame that is matched, px; at least 64; 0 and 0: all of it */
  uint16_t patches;                     /**< templates of frame 0; at least 8, with key_patches at most 16,384 */
  uint16_t key_patches;                 /**< templates of all later key frames together; at least 4 ('S': 2), or 0 */
  uint16_t vertices;                    /**< of the mesh, at least those of the model's base mesh */
  uint16_t start_points;                /**< landmarks of a start; at least 4, or 0: no start from landmarks */
  uint16_t profile;                     /**< 'S', 'M' or 'L': every other limit is as there */
  uint16_t smallest_face_px;            /**< side of the smallest face that is searched for, px; below 48 counts as 48 */
  uint32_t search_work; /**< of one frame without a track, cells of the search: 24,000 search 320 x 240 at once */
  uint32_t leaves_out;  /**< sum of PLIANT_NO_DETECTION and PLIANT_NO_PERSON; 0: what the profile has */
} pliant_limits;

/** Parts that a tracker may leave out: what finds faces and prints, and looks again while one is tracked; the estimation of the
 *  person's identity. They take no memory then, but their code is linked. */
enum { PLIANT_NO_DETECTION = 1, PLIANT_NO_PERSON = 2 };

/** A luma image of 8 bits per pixel, read during the call only. Row y, column x is
 *  pixels[y * stride_bytes + x * pixel_step_bytes]. */
typedef struct pliant_frame {
  const uint8_t *pixels;    /**< first pixel */
  size_t stride_bytes;      /**< from row to row; at least (width - 1) * pixel_step_bytes + 1 */
  int64_t time_ns;          /**< of exposure, any origin */
  int32_t width, height;    /**< px */
  int32_t pixel_step_bytes; /**< 1 planar, 2 packed YUYV (profile S: 1 only) */
  uint32_t sequence;        /**< number of the frame, modulo 2^32 */
} pliant_frame;

/** Pinhole camera with radial distortion: focal length and principal point, px; k1 and k2 as OpenCV's; aspect: focal
 *  length along y over that along x, 0.5 to 2, or 0 for 1. {f, cx, cy} alone is a camera without distortion. */
typedef struct pliant_camera {
  float f, cx, cy;      /**< px */
  float k1, k2, aspect; /**< no unit */
} pliant_camera;

/** Unit quaternion (w,x,y,z), and translation, mm; t[2] is above 0. */
typedef struct pliant_pose {
  float q[4]; /**< unit quaternion (w,x,y,z) */
  float t[3]; /**< mm */
} pliant_pose;

/** A landmark by the model's name for it (`ibug30`, `nose_tip`, ...), and its image position, px. */
typedef struct pliant_point {
  const char *landmark; /**< name of a landmark */
  float x, y;           /**< px */
} pliant_point;

/** What is known before a start by detection, from landmarks or from a box; all 0: nothing. */
typedef struct pliant_start_options {
  const pliant_camera *camera; /**< intrinsics and lens, which replace focal_px; null: unknown */
  float focal_px;              /**< 0: unknown; landmarks estimate it, a box assumes 1.4 x the larger side */
  uint32_t drops_landmark_offsets; /**< not 0: landmarks are those of the model, without this person's offsets */
  uint32_t box;                    /**< PLIANT_BOX_LANDMARKS, PLIANT_BOX_OPENCV or PLIANT_BOX_FACE */
} pliant_start_options;

/** What a box encloses: brows to chin, ear to ear; the square that OpenCV's cascades give; pliant's own face box, a square
 *  of 150 mm on the face around the middle between eyes and mouth. */
enum { PLIANT_BOX_LANDMARKS = 0, PLIANT_BOX_OPENCV = 1, PLIANT_BOX_FACE = 2 };

/** A state that a later start goes on from. The arrays are the caller's. */
typedef struct pliant_state {
  float *parameters;                      /**< all parameters, in the model's order */
  float *landmark_offsets;                /**< mm, x, y and z for each landmark, in the model's order */
  size_t parameter_count, landmark_count; /**< those of the model; landmark_count may be 0: no offsets */
  pliant_camera camera;                   /**< intrinsics and lens */
  pliant_pose pose;                       /**< of the model */
} pliant_state;

/** What a frame is worth. Degraded: it was bad and has the last good frame's results, or its own are less exact
 *  (landmark_error above 0.08, a head turned by more than 50 degrees, a part of the face covered or the face overexposed at the
 *  start, a print seen in part). Lost: several bad frames in a row, or no track. */
enum { PLIANT_TRACKING = 0, PLIANT_DEGRADED = 1, PLIANT_LOST = 2 };

/** The result of a frame. */
typedef struct pliant_result {
  pliant_pose pose;          /**< after a bad frame that of the last good one; without a track frontal, 1000 mm away */
  pliant_camera camera;      /**< that of the start; its f is 0 without a track */
  float rms_px;              /**< of the inliers' residuals */
  uint16_t tracked, inliers; /**< observations found; observations used in the end */
  int32_t state;             /**< PLIANT_TRACKING, PLIANT_DEGRADED or PLIANT_LOST */
  float landmark_error;      /**< expected, as a fraction of the distance of the outer eye corners; 0: unknown */
  int32_t is_searching;      /**< 1: there is no track; the next frame is searched for the face or print */
  float gaze[3];             /**< of both eyes relative to the head: unit vector to the subject's left, up, ahead; 0: not seen */
  uint32_t track, person;    /**< count tracks and persons, from 1: others where others begin; 0: of a print that was found */
} pliant_result;

/* The layout that the library was compiled with. */
#ifdef __cplusplus
#define PLIANT_HAS_SIZE(type, bytes) static_assert(sizeof(type) == (bytes), "not the layout of the library")
#elif __STDC_VERSION__ >= 201112L
#define PLIANT_HAS_SIZE(type, bytes) _Static_assert(sizeof(type) == (bytes), "not the layout of the library")
#else
#define PLIANT_HAS_SIZE(type, bytes) extern const char type##_has_its_size[sizeof(type) == (bytes) ? 1 : -1]
#endif
PLIANT_HAS_SIZE(pliant_limits, 28);
PLIANT_HAS_SIZE(pliant_frame, 2 * sizeof(void *) + 24);
PLIANT_HAS_SIZE(pliant_camera, 24);
PLIANT_HAS_SIZE(pliant_pose, 28);
PLIANT_HAS_SIZE(pliant_point, sizeof(void *) + 8);
PLIANT_HAS_SIZE(pliant_start_options, sizeof(void *) + (sizeof(void *) == 8 ? 16 : 12));
PLIANT_HAS_SIZE(pliant_state, 4 * sizeof(void *) + 52 + (sizeof(void *) == 8 ? 4 : 0));
PLIANT_HAS_SIZE(pliant_result, 92);
#undef PLIANT_HAS_SIZE

#endif
