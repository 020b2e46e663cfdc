#!/usr/bin/env python3
"""Starts by detection on single frames of rendered heads that look up, down and to the sides: errors of pitch, yaw and landmarks.

usage: start_pose.py PLIANT FACE.plm PEOPLE [--first N] [--folder FOLDER] [TRACK OPTIONS...]
Each person, of random identity, is rendered once in each of 15 rotations, 320 x 240, with a little of an expression. The people
are those numbered from --first (0). Pitch grows downwards. Films stay in the folder (start_pose) and are not rendered again.
"""
import csv
import math
import os
import random
import subprocess
import sys

import turned_heads as heads

PITCHES, YAWS, FOCAL = (-15, -7.5, 0, 7.5, 15), (-20, 0, 20), 448
SHOWN = [(pitch, yaw) for pitch in PITCHES for yaw in YAWS]


def pose(draw, pitch, yaw):
    q = heads.rotation(yaw + draw.gauss(0, 2), pitch + draw.gauss(0, 1), draw.gauss(0, 4))
    t = (draw.gauss(0, 15), -28 + draw.gauss(0, 8), 560 + draw.gauss(0, 30))
    smile, brow = max(0, draw.gauss(0, 0.2)), max(0, draw.gauss(0, 0.2))
    return [*q, *t, max(0, draw.gauss(0, 0.08)), smile, smile, brow, brow, 0, 0]


def angles(row):
    """Pitch and yaw, degrees."""
    w, x, y, z = heads.quaternion(row)
    return [math.degrees(a) for a in (math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)),
                                      math.asin(max(-1, min(1, 2 * (w * y - z * x)))))]


def started(pliant, face, stem, frame, more):
    """The tracker's row of a film of this frame alone; None where it does not start."""
    with open(stem + '.y4m', 'rb') as film:
        header = film.readline()
        size = (os.path.getsize(stem + '.y4m') - len(header)) // len(SHOWN)
        film.seek(frame * size, 1)
        picture = film.read(size)
    with open(stem + '.one.y4m', 'wb') as one:
        one.write(header + picture)
    subprocess.run([pliant, 'track', face, '--frames', stem + '.one.y4m', '--landmarks', '--focal', str(FOCAL), '--out',
                    stem + '.track.csv'] + more, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    row = next(csv.DictReader(open(stem + '.track.csv')))
    return None if row['state'] == 'lost' else row


def mean(values):
    return sum(values) / len(values) if values else float('nan')


def root_mean_square(values):
    return math.sqrt(mean([v * v for v in values]))


def main(argv):
    options = {'--first': '0', '--folder': 'start_pose'}
    pliant, face, count, *more = heads.arguments(argv, options, __doc__)
    first = int(options['--first'])
    errors = {shown: [] for shown in SHOWN}
    for person in range(first, first + int(count)):
        draw = random.Random(1000 + person)
        rows = [pose(draw, *shown) for shown in SHOWN]
        stem = heads.render(pliant, face, person, '320x240', options['--folder'], rows)
        for frame, (shown, truth) in enumerate(zip(SHOWN, csv.DictReader(open(stem + '.truth.csv')))):
            row = started(pliant, face, stem, frame, more)
            if row is None:
                continue
            turn = heads.angle(heads.quaternion(truth), heads.quaternion(row))
            pitch, yaw = (a - b for a, b in zip(angles(row), angles(truth)))
            errors[shown].append((pitch, yaw, turn, heads.landmark_error(truth, row, heads.eye_distance(truth))))
    print('| pitch, degrees | starts | mean error of pitch | of yaw at -20 | at 20 | rotation, rms | landmarks, % |')
    print('|---:|---:|---:|---:|---:|---:|---:|')
    for pitch in PITCHES + ('all',):
        of = [e for s in SHOWN if pitch in (s[0], 'all') for e in errors[s]]
        sides = [mean([e[1] for s in SHOWN if pitch in (s[0], 'all') and s[1] == yaw for e in errors[s]]) for yaw in (-20, 20)]
        print('| %s | %d | %.2f | %.2f | %.2f | %.2f | %.2f |' % (pitch, len(of), mean([e[0] for e in of]), *sides, root_mean_square(
            [e[2] for e in of]), mean([e[3] for e in of])))


main(sys.argv[1:])
