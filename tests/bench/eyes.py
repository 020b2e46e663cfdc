#!/usr/bin/env python3
"""Scores the eyes of a track of the recorded face (docs/evaluation.md, Lids and Gaze): blinks, gaps between lids, gaze up and down.

usage: eyes.py TRACK.csv TRUTH.csv BLINKS.csv FOCAL_PX
TRACK.csv: of `pliant track --landmarks`. TRUTH.csv: frame,landmark,x,y with the annotated points fgnet27 to fgnet36. BLINKS.csv:
first,last,kind of the frames in which the eyes are closed, labelled by eye; those of the kind `ignore` count neither for nor against
a track. FOCAL_PX: as the track's summary says. Prints name=value pairs. Python's standard library is enough.
"""
import csv
import math
import statistics
import sys

import score

AROUND = 3  # frames next to a blink in which lids still move: gaps and gaze are not compared there
APART = 2  # frames by which a blink of the track may miss the label, and up to which two runs of closed frames are one blink

# Annotated: upper and lower lid, corners, pupil. Tracked: upper lid twice, lower lid twice, corners. The first eye is the person's right.
ANNOTATED = (('fgnet28', 'fgnet30', 'fgnet27', 'fgnet29', 'fgnet31'), ('fgnet33', 'fgnet35', 'fgnet32', 'fgnet34', 'fgnet36'))
TRACKED = (('ibug37', 'ibug38', 'ibug41', 'ibug40', 'ibug36', 'ibug39'), ('ibug43', 'ibug44', 'ibug47', 'ibug46', 'ibug45', 'ibug42'))

# The eye in the head (docs/algorithms.md, 7.21), mm: x to the person's left, y up, z forward. Of the left eye.
CORNERS = (32, 30, 60)  # middle of the corners of the model at rest; only its depth counts
BALL = (0.75, 2.6, -4.5)  # middle of the eyeball from there
IRIS = 10.4  # middle of the iris from that of the eyeball


def middle(a, b):
    return tuple((x + y) / 2 for x, y in zip(a, b))


def annotated_gap(points, eye):
    upper, lower, outer, inner, _ = (points[name] for name in ANNOTATED[eye])
    return math.dist(upper, lower) / math.dist(outer, inner)


def tracked_gap(points, eye):
    p = [points[name] for name in TRACKED[eye]]
    return math.dist(middle(p[0], p[1]), middle(p[2], p[3])) / math.dist(p[4], p[5])


def closed_runs(frames, gaps):
    """(first, last) frame of each run with a gap below half of the median."""
    limit, runs = statistics.median(gaps) / 2, []
    for frame, gap in zip(frames, gaps):
        if gap >= limit:
            continue
        if runs and frame - runs[-1][1] <= APART:
            runs[-1][1] = frame
        else:
            runs.append([frame, frame])
    return runs


def overlaps(run, first, last, margin):
    return run[0] <= last + margin and run[1] >= first - margin


def score_blinks(runs, labels):
    runs = [r for r in runs if not any(kind == 'ignore' and overlaps(r, a, b, APART) for a, b, kind in labels)]
    blinks = [(a, b) for a, b, kind in labels if kind == 'closed']
    late = []
    for first, last in blinks:
        match = next((r for r in runs if overlaps(r, first, last, APART)), None)
        if match:
            runs.remove(match)
            late.append(match[0] - first)
    return {'blinks': len(blinks), 'found': len(late), 'false': len(runs), 'late_frames': statistics.median(late) if late else ''}


def rotation(row):
    """Of a row of a track: from the head's axes to the camera's, whose y points down and z away."""
    w, x, y, z = (float(row[name]) for name in ('qw', 'qx', 'qy', 'qz'))
    r = ((1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
         (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
         (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)))
    return tuple((a, -b, -c) for a, b, c in r)


def turned(r, v):
    return tuple(sum(a * b for a, b in zip(row, v)) for row in r)


def annotated_gaze(row, points, focal):
    """Direction in the head's axes of both eyes' mean, from the annotated pupils and corners, seen along parallel rays."""
    r, total = rotation(row), [0, 0, 0]
    back = tuple(zip(*r))
    for eye, side in ((0, -1), (1, 1)):
        _, _, outer, inner, pupil = (points[name] for name in ANNOTATED[eye])
        depth = float(row['tz']) + turned(r, (side * CORNERS[0], *CORNERS[1:]))[2]
        seen = [(a - b) * depth / focal for a, b in zip(pupil, middle(outer, inner))]
        ball = turned(r, (side * BALL[0], *BALL[1:]))
        x, y = seen[0] - ball[0], seen[1] - ball[1]
        rest = IRIS * IRIS - x * x - y * y
        if rest > 0:
            total = [a + b for a, b in zip(total, turned(back, (x, y, -math.sqrt(rest))))]
    return total


def degrees_up(v):
    return math.degrees(math.atan2(v[1], math.hypot(v[0], v[2])))


def read_labels(path, last):
    with open(path, newline='') as file:
        labels = [(int(row['first']), int(row['last']), row['kind']) for row in csv.DictReader(file)]
    return [label for label in labels if label[1] <= last]


def score_eyes(track_path, truth_path, labels_path, focal):
    truth, track = score.read_truth(truth_path), score.read_track(track_path)
    with open(track_path, newline='') as file:
        rows = {int(row['frame']): row for row in csv.DictReader(file)}
    frames = [k for k in sorted(truth) if k in track and 'ibug37' in track[k][1]]
    labels = read_labels(labels_path, frames[-1])
    gaps = [[tracked_gap(track[k][1], eye) for k in frames] for eye in (0, 1)]
    measures = score_blinks(closed_runs(frames, [(a + b) / 2 for a, b in zip(*gaps)]), labels)
    quiet = [i for i, k in enumerate(frames) if not any(a - AROUND <= k <= b + AROUND for a, b, _ in labels)]
    for eye, name in ((0, 'gap_right'), (1, 'gap_left')):
        measures[name] = score.correlation([annotated_gap(truth[frames[i]], eye) for i in quiet], [gaps[eye][i] for i in quiet])
    seen = [frames[i] for i in quiet if rows[frames[i]]['gaze_up']]
    told = [math.degrees(float(rows[k]['gaze_up'])) for k in seen]
    known = [degrees_up(annotated_gaze(rows[k], truth[k], focal)) for k in seen]
    errors = [a - b for a, b in zip(told, known)]
    measures.update(gaze_frames=len(seen), gaze_up_mean=statistics.fmean(errors), gaze_up_sd=statistics.pstdev(errors),
                    gaze_up=score.correlation(known, told))
    return measures


def main(words):
    if len(words) != 4:
        sys.exit('usage: ' + __doc__.split('usage: ')[1])
    print(' '.join('%s=%s' % (name, '%.3f' % value if isinstance(value, float) else value)
                   for name, value in score_eyes(*words[:3], float(words[3])).items()))


if __name__ == '__main__':
    main(sys.argv[1:])
