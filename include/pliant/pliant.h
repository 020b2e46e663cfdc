/**
 * \file pliant.h
 * The C interface (C99 or later) of Tracker (tracker.hpp): the same calls with the same defaults give the same bits. The memory
 * is the caller's. Nothing is allocated, and there is nothing to free.
 *
 * Image positions are in px, x right, y down, pixel centres at integers. The model is in mm, x to the subject's left, y
 * up, z out of the face; the camera in mm, x right, y down, z forward. p_cam = R(q) diag(1,-1,-1) p_model + t, so that
 * a frontal face has q = (1,0,0,0).
 *
 * One thread at a time may use a tracker. After a status other than PLIANT_OK nothing has changed and no output is
 * written; the four starts and pliant_update say what they do beyond that. PLIANT_BAD_ARGUMENT is the status of every
 * function for a null pointer that is not said to be allowed, and for a number that is not finite.
 */
#ifndef PLIANT_H
#define PLIANT_H

#include "pliant/pliant_types.h"
#include "pliant/version.h"

#ifdef __cplusplus
extern "C" {
#endif

/** The version of the linked library, "major.minor.patch". */
const char *pliant_version(void);

/** A short English sentence without a full stop; "unknown status" for a number that is none. Never null. */
const char *pliant_status_text(pliant_status status);

/** The limits of a profile: 'S' 320 x 240 on a microcontroller, 'M' 320 x 240, the defaults of C++, 'L' 640 x 480.
 *  All 0 for another name, which pliant_create refuses. */
pliant_limits pliant_profile(char name);

/** Bytes that pliant_create needs. Cost: below a millisecond, and the check of the table, which reads all of it.
 *  \return PLIANT_BAD_ARGUMENT also for limits out of range; 4 to 9 (table). */
pliant_status pliant_required_bytes(const void *table, size_t table_bytes, const pliant_limits *limits,
                                    size_t *bytes);

/** Makes a tracker. Cost: as pliant_required_bytes.
 *  \param memory  a block at an address that is a multiple of 16. It and the table must outlive the tracker and stay where
 *                 they are. The block is written to whatever the status.
 *  \return as pliant_required_bytes; PLIANT_BAD_ARGUMENT also for a block that is not aligned (in C++ that is
 *          misaligned); PLIANT_OUT_OF_MEMORY (block). */
pliant_status pliant_create(void *memory, size_t bytes, const void *table, size_t table_bytes,
                            const pliant_limits *limits, pliant_tracker **tracker);

/** Ends the track, if there is one, and forgets the person: the next pliant_update searches for the face or print. A
 *  new tracker does so by itself, if its table has learnt tables (pliant learn) or a print. The next frame may have any
 *  time.
 *  \param options  null: nothing is known. \return PLIANT_NOT_FOUND: the table has neither, the frames are too large, or
 *                  the limits leave detection out. */
pliant_status pliant_start_by_detection(pliant_tracker *tracker, const pliant_start_options *options);

/** Starts from a known pose. The frame of a start is frame 0; templates are captured in it. Cost: several updates.
 *  All starts check pointers, frame, counts and names first; if one of these is wrong, nothing has changed. If the
 *  camera, the pose, the fit or the texture of the frame is at fault, a track that was there has ended, and the next
 *  frame may have any time.
 *  Another person who is found later has landmark offsets, here and after pliant_start_from_state.
 *  \param parameters  all, in the model's order, which are clamped to their limits; null: all 0.
 *  \return PLIANT_BAD_ARGUMENT, PLIANT_SIZE_MISMATCH, PLIANT_TOO_FEW_POINTS (texture), PLIANT_CAPACITY (a model that
 *          is larger than the limits), PLIANT_BAD_TABLE (springs), 19 to 24 and 26 (base mesh). */
pliant_status pliant_start_from_pose(pliant_tracker *tracker, const pliant_frame *frame, const pliant_camera *camera,
                                     const pliant_pose *pose, const float *parameters);

/** Starts from 4 to start_points landmarks: person, pose and, if unknown, focal length are fitted to them. Residuals
 *  that noise does not explain become offsets of this person's landmarks. Cost: tens of updates.
 *  \param options  null: nothing is known.
 *  \return as pliant_start_from_pose; PLIANT_CAPACITY, PLIANT_TOO_FEW_POINTS, PLIANT_NOT_FOUND (a name),
 *          PLIANT_UNDERDETERMINED. */
pliant_status pliant_start_from_landmarks(pliant_tracker *tracker, const pliant_frame *frame,
                                          const pliant_point *points, size_t count,
                                          const pliant_start_options *options);

/** Starts with the neutral face, frontal, in a face detector's box: upper left corner and size, px, size above 0.
 *  With a table that has an aligner the face is then aligned in the frame. A box tells no roll: of a head that is turned in the
 *  picture by more than about 40 degrees start from landmarks, a pose or by detection.
 *  \param options  null: nothing is known; `box` says what the box encloses. \return as pliant_start_from_pose. */
pliant_status pliant_start_from_box(pliant_tracker *tracker, const pliant_frame *frame, float x, float y, float width,
                                    float height, const pliant_start_options *options);

/** Starts from a state that pliant_save wrote, of the same model.
 *  \return as pliant_start_from_pose; PLIANT_BAD_ARGUMENT also for counts that are not the model's, and for offsets beyond
 *          10^7 mm. */
pliant_status pliant_start_from_state(pliant_tracker *tracker, const pliant_frame *frame, const pliant_state *state);

/** Writes the state of the last frame; if that is lost, the last one that was not. The caller sets arrays and counts.
 *  \return PLIANT_NOT_STARTED, PLIANT_BAD_ARGUMENT (counts that are not the model's). */
pliant_status pliant_save(const pliant_tracker *tracker, pliant_state *state);

/** Tracks the next frame; while there is no track, searches it for the face or print, which is tracked from this frame
 *  on. Cost: docs/evaluation.md.
 *  \return PLIANT_NOT_STARTED (no track, and no search, as pliant_start_by_detection says), 4 to 9 (the tables of
 *          detector, aligner or print), PLIANT_BAD_ARGUMENT (the frame), PLIANT_SIZE_MISMATCH, PLIANT_STALE_FRAME
 *          (neither time nor sequence is after the last frame's), PLIANT_CAPACITY (what was found has more free parameters
 *          than the limits allow: 40 with profile S; the next frame, or this one again, begins a new search). */
pliant_status pliant_update(pliant_tracker *tracker, const pliant_frame *frame, pliant_result *result);

/** The result of the last frame; after a start, of frame 0. \return PLIANT_NOT_STARTED (neither a track nor a search). */
pliant_status pliant_get_result(const pliant_tracker *tracker, pliant_result *result);

/** How many parameters the model has. Needs no start. */
pliant_status pliant_parameter_count(const pliant_tracker *tracker, size_t *count);
/** Name of a parameter, which lives as long as the table. Needs no start. \return PLIANT_NOT_FOUND (index). */
pliant_status pliant_parameter_name(const pliant_tracker *tracker, size_t index, const char **name);
/** Least and greatest value of a parameter, in the model's unit; 0 is rest, or the mean person. Needs no start.
 *  \return PLIANT_NOT_FOUND (index). */
pliant_status pliant_parameter_range(const pliant_tracker *tracker, size_t index, float *minimum, float *maximum);
/** How many landmarks the model has. Needs no start. */
pliant_status pliant_landmark_count(const pliant_tracker *tracker, size_t *count);
/** Name of a landmark, which lives as long as the table. Needs no start. \return PLIANT_NOT_FOUND (index). */
pliant_status pliant_landmark_name(const pliant_tracker *tracker, size_t index, const char **name);

/** Value of a parameter (`jawOpen`, ...) in the last frame, in the model's unit (0 to 0.45 rad). ARKit's coefficient
 *  is the value over the maximum (pliant_parameter_range). \return PLIANT_NOT_STARTED, PLIANT_NOT_FOUND. */
pliant_status pliant_get_parameter(const pliant_tracker *tracker, const char *name, float *value);
/** All parameters in the last frame, in the model's order, valid until the next call. \return PLIANT_NOT_STARTED. */
pliant_status pliant_get_parameters(const pliant_tracker *tracker, const float **values);

/** Image position of a landmark in the last frame, px; after a start from landmarks or by detection, where this person has it.
 *  \return PLIANT_NOT_STARTED, PLIANT_NOT_FOUND, PLIANT_UNDERDETERMINED (behind the camera). */
pliant_status pliant_get_landmark(pliant_tracker *tracker, const char *name, float *x, float *y);
/** The same for a landmark by its index. Statuses as pliant_get_landmark. */
pliant_status pliant_get_landmark_at(pliant_tracker *tracker, size_t index, float *x, float *y);

/** Gives landmarks the offsets that put them at these image positions in the last frame. Others keep theirs.
 *  Until a later start of the caller or of another person they stay.
 *  \return PLIANT_NOT_STARTED, PLIANT_NOT_FOUND. */
pliant_status pliant_place_landmarks(pliant_tracker *tracker, const pliant_point *points, size_t count);

#ifdef __cplusplus
}
#endif

#endif
